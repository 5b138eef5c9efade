// Exact answers about float32 input, by sums of float64 without rounding (Shewchuk 1997, "Adaptive precision
// floating-point arithmetic and fast robust geometric predicates"). Slow; used only where float64 is in doubt.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "claray/shared/types.h"

namespace claray::verify {

/// The sign of the exact sum of the values.
[[nodiscard]] int sign_of_sum(std::span<const double> values);

/// The sign of det(direction, a - origin, b - origin): on which side of the ray's line the directed edge from a to b
/// passes.
[[nodiscard]] int side_of(const Ray& ray, const glm::vec3& a, const glm::vec3& b);

/// The sign of det(a - point, b - point, c - point): on which side of the triangle's plane the point is.
[[nodiscard]] int side_of_plane(const glm::vec3& point, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

enum class Place { outside, border, inside };
/// Where the ray's line passes a triangle. One in the triangle's plane is outside.
[[nodiscard]] Place place_of(const Ray& ray, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c);

}  // namespace claray::verify
