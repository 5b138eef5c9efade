// Arrays of points that a query answers.
#pragma once

#include "claray/bvh.hpp"
#include "host/sort/radix_sort.hpp"

namespace claray {

/// The number of points in a buffer of 3 floats each. Throws ErrorKind::usage if that is no whole number, or too large.
[[nodiscard]] std::uint32_t points_in(const Buffer<float>& points);

[[nodiscard]] Buffer<float> upload_points(const Device& device, std::span<const glm::vec3> points);

/// The indices of `count` points by Morton code, so that neighbours in this order are near each other; asynchronous. No
/// buffer if sorting does not pay.
[[nodiscard]] Buffer<std::uint32_t> point_order(const Bvh& bvh, const Buffer<float>& points, std::uint32_t count);

}  // namespace claray
