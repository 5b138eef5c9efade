#include "host/trace/query_kernel.hpp"

#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/tuning.hpp"

namespace claray {

const cl::Buffer& ray_queue(const Device& device) {
    std::shared_ptr<cl::Buffer>& queue = state_of(device).ray_queue;
    if (!queue) {
        queue = detail::allocate(device, 2 * sizeof(std::uint32_t));
        detail::fill_bytes(device, *queue, 0, 2 * sizeof(std::uint32_t));
    }
    return *queue;
}

namespace {

std::string stem_of(QueryKind kind, const QueryOptions& options) {
    if (options.brute_force) return "trace/brute_force";
    return kind == QueryKind::closest ? "trace/closest_hit" : "trace/any_hit";
}

}  // namespace

QueryKernels::QueryKernels(const Device& device, const TreeFormat& tree, QueryKind kind, const QueryOptions& options,
                           const std::string& file) {
    const bool closest = kind == QueryKind::closest;
    const std::string stem = stem_of(kind, options), name = closest ? "closest_hit" : "any_hit";
    // A batch is on the stack of the thread that traces it: larger batches, or two at once, could overflow the stack.
    if (tree.wide && !options.brute_force && !options.visits.allocated())
        batch = std::min(device.tuning(stem, "BATCH"), 8192u);
    in_queue = !options.brute_force && !tree.wide && device.tuning(stem, "RAY_QUEUE") != 0;
    TreeFormat traced = tree;
    if (batch != 0) traced.cutouts = false;
    const auto add = [&](const Defines& more) {
        Defines defines = query_defines(traced.defines(), options);
        defines.insert(defines.end(), more.begin(), more.end());
        trace.push_back({file.empty() ? stem + ".cl" : file, options.brute_force ? "brute_force_" + name : name,
                         file.empty() ? defines : with_tuning(device, stem, defines)});
    };
    if (batch != 0) {
        if (tree.cutouts) {
            Defines defines = query_defines(tree.defines(), options);
            defines.emplace_back("GROUP_SIZE", "1");
            defines.emplace_back("RAYS_PER_ITEM", std::to_string(std::max(1u, device.tuning(stem, "RAYS_PER_ITEM"))));
            retrace = {"trace/cutouts.cl", closest ? "retrace_closest" : "retrace_any", defines};
        }
        add({{"RAY_QUEUE", "0"}, {"BATCH", std::to_string(batch)}, {"GROUP_SIZE", "1"}});
    } else if (!in_queue) {
        add(options.brute_force ? Defines{} : Defines{{"RAY_QUEUE", "0"}});
    } else if (options.visits.allocated() || options.coherence == Coherence::coherent) {
        add({{"COHERENT", "1"}});
    } else if (!closest || options.coherence == Coherence::incoherent) {
        add({{"COHERENT", "0"}});
    } else {
        add({{"COHERENT", "1"}, {"CHOOSE", "1"}});
        add({{"COHERENT", "0"}, {"CHOOSE", "1"}});
    }
}

KernelSet QueryKernels::programs(const Device& device) const {
    KernelSet set;
    for (const KernelRequest& one : trace) set.add(device, one);
    if (retrace) set.add(device, *retrace);
    return set;
}

QueryKernel::QueryKernel(const Device& device, const Bvh& bvh, Kind kind, const QueryOptions& options,
                         const std::string& name, const std::string& file)
    : device_(device), bvh_(bvh), options_(options) {
    require_triangles(bvh, "a query of triangles");
    const QueryKernels kernels(device, format_of(bvh), kind, options, file);
    const auto named = [&](const KernelRequest& request) {
        const Kernel kernel = load_kernel(device, request);
        return name.empty() ? kernel : Kernel(device, kernel.handle(), name);
    };
    for (const KernelRequest& request : kernels.trace) kernels_.push_back(named(request));
    if (kernels.retrace) retrace_ = named(*kernels.retrace);
    if (options.brute_force) return;
    const std::string stem = stem_of(kind, options);
    rays_per_item_ = std::max(1u, device.tuning(stem, "RAYS_PER_ITEM"));
    group_ = kernels.batch != 0 ? 1 : device.tuning(stem, "GROUP_SIZE");
    most_in_batch_ = kernels.batch;
    if (most_in_batch_ != 0) {
        sort_from_ = device.tuning(stem, "SORT_FROM");
        sort_from_nanoseconds_ = device.tuning(stem, "SORT_FROM_NANOSECONDS");
    }
    if (kernels.in_queue)
        most_items_ = std::max(1u, device.info().compute_units * device.tuning(stem, "GROUPS_PER_UNIT")) * group_;
}

bool QueryKernel::may_sort(std::uint32_t capacity, const Buffer<std::uint32_t>& count) {
    constexpr std::uint32_t most_of_sample = 16;  // or the sample costs more than it tells
    if (sort_from_ == 0 || count.allocated() || options_.coherence == Coherence::coherent) return false;
    if (capacity < sort_from_ || capacity / most_of_sample < sample_size()) return false;
    if (!ray_order_) ray_order_ = std::make_shared<RayOrder>(*device_);
    return true;
}

double QueryKernel::least_seconds_to_sort() const {
    return 1e-9 * sort_from_nanoseconds_ * sampled_by_unit;  // as all units trace at the same time
}

std::uint32_t QueryKernel::batch_size(std::uint32_t capacity) const {
    constexpr std::uint32_t packet = 64;
    if (most_in_batch_ < packet) return most_in_batch_;
    const std::uint32_t share = capacity / (8 * std::max(1u, device_->info().compute_units));
    return std::clamp(share / packet * packet, packet, most_in_batch_);
}

std::size_t QueryKernel::items_for(std::uint32_t capacity) const {
    const std::size_t rays_per_item = std::max<std::size_t>(batch_size(capacity), rays_per_item_);
    return std::min((std::size_t(capacity) + rays_per_item - 1) / rays_per_item, most_items_);
}

}  // namespace claray
