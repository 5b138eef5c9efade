#include "host/trace/ray_order.hpp"
#include "claray/shared/ray_samples.h"
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

RayOrder::RayOrder(const Device& device)
    : device_(device), answer_(device, 1), compare_(load_kernel(device, "trace/queue/ray_order.cl", "sample_order")) {}

bool RayOrder::has_none(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count) {
    compare_.run({1, 1}, state_of(bvh).header, rays, count, arg("answer", answer_));
    return answer_.read()[0] != 0;
}

const Buffer<std::uint32_t>& RayOrder::sample(std::uint32_t count, std::uint32_t size) {
    std::vector<std::uint32_t> indices(size);
    for (std::uint32_t i = 0; i < size; ++i) indices[i] = place_of_sample(i, count);
    sample_.reserve(device_, size);
    sample_.write(std::span<const std::uint32_t>(indices));
    return sample_;
}

const Buffer<std::uint32_t>& RayOrder::sort(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t count) {
    if (!sort_ || keys_.size() < count) {
        keys_ = Buffer<std::uint32_t>(device_, count), order_ = Buffer<std::uint32_t>(device_, count);
        sort_.emplace(device_, count, sort_config(device_));
        make_keys_ = load_kernel(device_, "trace/queue/ray_order.cl", "ray_keys");
    }
    make_keys_.run({(count + rays_per_item - 1) / rays_per_item, 1}, state_of(bvh).header, rays, count, keys_);
    sort_->sort(keys_, order_, count);
    return order_;
}

}  // namespace claray
