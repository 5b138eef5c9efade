#include "host/trace/points/points.hpp"
#include "host/bvh/bvh_state.hpp"

namespace claray {

std::uint32_t points_in(const Buffer<float>& points) {
    if (points.size() % 3 != 0)
        throw Error(ErrorKind::usage, std::to_string(points.size()) + " floats are no whole number of points",
                    "give 3 floats for each point");
    if (points.size() / 3 > 4'000'000'000)
        throw Error(ErrorKind::usage, std::to_string(points.size() / 3) + " points are too many for one query",
                    "ask for at most 4e9 points at a time");
    return std::uint32_t(points.size() / 3);
}

Buffer<float> upload_points(const Device& device, std::span<const glm::vec3> points) {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    return {device, std::span(points.empty() ? nullptr : &points[0].x, 3 * points.size())};
}

Buffer<std::uint32_t> point_order(const Bvh& bvh, const Buffer<float>& points, std::uint32_t count) {
    constexpr std::uint32_t fewest = 4096;
    if (count < fewest) return {};
    const Device& device = bvh.device();
    Buffer<std::uint32_t> keys(device, count), order(device, count);
    load_kernel(device, "trace/points/nearest_point.cl", "point_keys")
        .run({count, 64}, state_of(bvh).header, points, count, arg("keys", keys));
    auto config = RadixSort<std::uint32_t>::config_for(device);
    config.key_bits = 30;
    RadixSort<std::uint32_t>(device, count, config).sort(keys, order, count);
    return order;
}

}  // namespace claray
