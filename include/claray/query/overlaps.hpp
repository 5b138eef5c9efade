// Queries for the triangles that overlap boxes and spheres.
#pragma once

#include <span>

#include "claray/bvh.hpp"
#include "claray/query/lists.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// A solid sphere.
struct Sphere {
    glm::vec3 center{0.f};
    float radius = 1.f;
};

/// Count the triangles that overlap each box or sphere. Boxes are 6 floats each: the lower corner, then the upper one.
/// Spheres are 4 floats each: centre and radius. Shapes and triangles that touch overlap. The decisions are made in
/// float64. They may be wrong only where a gap or an overlap is less than 2^-49 of the largest distance between the
/// shape's centre and a vertex. A box with lo > hi, a negative radius and shapes that are not finite overlap nothing.
/// `counts` must hold an element per shape. Asynchronous, except for structures with split triangles
/// (Bvh::Config::split_budget).
void count_box_overlaps(const Bvh& bvh, const Buffer<float>& boxes, Buffer<std::uint32_t>& counts);
void count_sphere_overlaps(const Bvh& bvh, const Buffer<float>& spheres, Buffer<std::uint32_t>& counts);

/// The same with the indices of the triangles, in ascending order. Block to learn how many there are. Throw
/// ErrorKind::usage if there are more than 4e9.
[[nodiscard]] Lists<std::uint32_t> box_overlaps(const Bvh& bvh, const Buffer<float>& boxes);
[[nodiscard]] Lists<std::uint32_t> sphere_overlaps(const Bvh& bvh, const Buffer<float>& spheres);

/// As above, for shapes in host memory.
[[nodiscard]] HostLists<std::uint32_t> box_overlaps(const Bvh& bvh, std::span<const Bounds> boxes);
[[nodiscard]] HostLists<std::uint32_t> sphere_overlaps(const Bvh& bvh, std::span<const Sphere> spheres);

}  // namespace claray
#pragma GCC visibility pop
