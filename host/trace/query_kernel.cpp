#include "host/trace/query_kernel.hpp"

#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/tuning.hpp"

namespace claray {

const cl::Buffer& ray_queue(const Device& device) {
    std::shared_ptr<cl::Buffer>& queue = state_of(device).ray_queue;
    if (!queue) {
        queue = detail::allocate(device, 3 * sizeof(std::uint32_t));
        detail::fill_bytes(device, *queue, 0, 3 * sizeof(std::uint32_t));
    }
    return *queue;
}

Kernel load_order_sample(const Device& device) {
    return load_kernel(device, "trace/queue/ray_order.cl", "sample_order");
}

bool in_any_order(Kernel& sample, const Device& device, const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count) {
    const cl::Buffer& queue = ray_queue(device);
    sample.run({1, 1}, state_of(bvh).header, rays, arg("count", count), arg("queue", queue));
    std::uint32_t answer = 0;
    detail::read(device, queue, 2 * sizeof answer, &answer, sizeof answer);
    return answer != 0;
}

QueryKernel::QueryKernel(const Device& device, const Bvh& bvh, Kind kind, const QueryOptions& options,
                         const std::string& name, const std::string& file)
    : device_(device), bvh_(bvh), options_(options) {
    const std::string query = kind == Kind::closest ? "closest_hit" : "any_hit";
    const std::string stem = options.brute_force ? "trace/brute_force" : "trace/" + query;
    const std::string function = options.brute_force ? "brute_force_" + query : query;
    Defines common = query_defines(triangle_defines(bvh), options);
    const auto load = [&](const Defines& more) {
        Defines defines = common;
        defines.insert(defines.end(), more.begin(), more.end());
        const Kernel kernel = file.empty() ? load_kernel(device, stem + ".cl", function, defines)
                                           : load_kernel(device, file, function, with_tuning(device, stem, defines));
        kernels_.push_back(name.empty() ? kernel : Kernel(device, kernel.handle(), name));
    };
    if (options.brute_force) {
        load({});
        return;
    }
    rays_per_item_ = std::max(1u, device.tuning(stem, "RAYS_PER_ITEM"));
    group_ = device.tuning(stem, "GROUP_SIZE");
    if (bvh.layout() == Layout::wide && !options.visits.allocated()) most_in_batch_ = device.tuning(stem, "BATCH");
    if (most_in_batch_ != 0) {
        // A batch is on the stack of the thread that traces it: larger batches, or two at once, could overflow the
        // stack.
        most_in_batch_ = std::min(most_in_batch_, 8192u), group_ = 1;
        if (state_of(bvh).has_cutouts()) {
            std::erase_if(common, [](const auto& define) { return define.first == "CLARAY_CUTOUTS"; });
            Defines defines = query_defines(triangle_defines(bvh), options);
            defines.emplace_back("GROUP_SIZE", "1");
            defines.emplace_back("RAYS_PER_ITEM", std::to_string(rays_per_item_));
            retrace_ = load_kernel(device, "trace/cutouts.cl",
                                   kind == Kind::closest ? "retrace_closest" : "retrace_any", defines);
            if (!name.empty()) retrace_ = Kernel(device, retrace_.handle(), name);
        }
        load({{"RAY_QUEUE", "0"}, {"BATCH", std::to_string(most_in_batch_)}, {"GROUP_SIZE", "1"}});
        sort_from_ = device.tuning(stem, "SORT_FROM");
        if (sort_from_ != 0) sample_ = load_order_sample(device);
        return;
    }
    if (device.tuning(stem, "RAY_QUEUE") == 0 || bvh.layout() != Layout::binary) {
        load({{"RAY_QUEUE", "0"}});
        return;
    }
    most_items_ = std::max(1u, device.info().compute_units * device.tuning(stem, "GROUPS_PER_UNIT")) * group_;
    if (options.visits.allocated() || options.coherence == Coherence::coherent) {
        load({{"COHERENT", "1"}});
    } else if (kind == Kind::any || options.coherence == Coherence::incoherent) {
        load({{"COHERENT", "0"}});
    } else {
        load({{"COHERENT", "1"}, {"CHOOSE", "1"}});
        load({{"COHERENT", "0"}, {"CHOOSE", "1"}});
    }
}

Buffer<std::uint32_t> QueryKernel::order_of(const Buffer<Ray>& rays, std::uint32_t capacity,
                                            const Buffer<std::uint32_t>& count) {
    if (sort_from_ == 0 || capacity < sort_from_ || count.allocated()) return {};
    const Device& device = *device_;
    if (options_.coherence == Coherence::coherent || !in_any_order(sample_, device, bvh_, rays, capacity)) return {};
    if (!ray_order_ || ray_order_->capacity() < capacity) ray_order_ = std::make_shared<RayOrder>(device, capacity);
    return ray_order_->sort(bvh_, rays, capacity);
}

std::uint32_t QueryKernel::batch_size(std::uint32_t capacity) const {
    constexpr std::uint32_t packet = 64;
    if (most_in_batch_ < packet) return most_in_batch_;
    const std::uint32_t share = capacity / (8 * std::max(1u, device_->info().compute_units));
    return std::clamp(share / packet * packet, packet, most_in_batch_);
}

}  // namespace claray
