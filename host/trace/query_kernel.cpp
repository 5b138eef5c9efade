#include "host/trace/query_kernel.hpp"

#include <algorithm>

#include "host/compute/device_state.hpp"
#include "host/trace/query_options.hpp"

namespace claray {

const cl::Buffer& ray_queue(const Device& device) {
    cl::Buffer& queue = device.state().ray_queue;
    if (!queue()) {
        queue = detail::allocate(device, 2 * sizeof(std::uint32_t));
        detail::fill_bytes(device, queue, 0, 2 * sizeof(std::uint32_t));
    }
    return queue;
}

QueryKernel::QueryKernel(const Bvh& bvh, Kind kind, const QueryOptions& options, const std::string& name)
    : bvh_(bvh), options_(options) {
    const std::string query = kind == Kind::closest ? "closest_hit" : "any_hit";
    const std::string stem = options.brute_force ? "trace/brute_force" : "trace/" + query;
    const std::string function = options.brute_force ? "brute_force_" + query : query;
    kernel_ = load_kernel(bvh.device(), stem + ".cl", function, query_defines(bvh.defines(), options));
    if (!name.empty()) kernel_ = Kernel(bvh.device(), kernel_.handle(), name);
    if (options.brute_force) return;
    rays_per_item_ = std::max(1u, bvh.device().tuning(stem, "RAYS_PER_ITEM"));
    group_ = bvh.device().tuning(stem, "GROUP_SIZE");
    if (bvh.device().tuning(stem, "RAY_QUEUE") != 0 && bvh.layout() == Layout::binary)
        most_items_ = std::max(1u, bvh.device().info().compute_units * bvh.device().tuning(stem, "GROUPS_PER_UNIT")) * group_;
}

}  // namespace claray
