#include "host/trace/ray_order.hpp"
#include "host/bvh/bvh_state.hpp"

namespace claray {
namespace {

constexpr unsigned key_bits = 31;
constexpr std::size_t rays_per_item = 1024;  // both as in kernels/trace/queue/ray_order.cl

RadixSort<std::uint32_t>::Config sort_config(const Device& device) {
    auto config = RadixSort<std::uint32_t>::config_for(device);
    config.key_bits = key_bits;
    return config;
}

}  // namespace

RayOrder::RayOrder(const Device& device, std::uint32_t capacity)
    : keys_(device, capacity),
      order_(device, capacity),
      answer_(device, 1),
      sort_(device, capacity, sort_config(device)),
      make_keys_(load_kernel(device, "trace/queue/ray_order.cl", "ray_keys")),
      sample_(load_kernel(device, "trace/queue/ray_order.cl", "sample_order")) {}

bool RayOrder::pays(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count) {
    sample_.run({1, 1}, state_of(bvh).header, rays, count, arg("answer", answer_));
    return answer_.read()[0] != 0;
}

const Buffer<std::uint32_t>& RayOrder::sort(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count) {
    make_keys_.run({(count + rays_per_item - 1) / rays_per_item, 1}, state_of(bvh).header, rays, count, keys_);
    sort_.sort(keys_, order_, count);
    return order_;
}

}  // namespace claray
