#include "claray/query/overlaps.hpp"

#include "host/trace/lists/lists.hpp"
#include "host/trace/query_kernel.hpp"
#include "host/trace/query_launch.hpp"

namespace claray {
namespace {

using Ids = std::uint32_t;

/// A kind of shape: its kernel, and how many floats describe one.
struct Shapes {
    const char* file;
    const char* kernel;
    const char* name;
    unsigned floats;
};
constexpr Shapes boxes_of_floats{"trace/overlaps/overlap_boxes.cl", "overlap_boxes", "boxes", 6};
constexpr Shapes spheres_of_floats{"trace/overlaps/overlap_spheres.cl", "overlap_spheres", "spheres", 4};

std::uint32_t shapes_in(const Buffer<float>& shapes, const Shapes& kind) {
    if (shapes.size() % kind.floats == 0) return std::uint32_t(shapes.size() / kind.floats);
    throw Error(ErrorKind::usage, std::to_string(shapes.size()) + " floats are no whole number of " + kind.name,
                "give " + std::to_string(kind.floats) + " floats for each");
}

FindLists<Ids> finder(const Bvh& bvh, const Buffer<float>& shapes, const Shapes& kind) {
    const QueryLaunch launch(bvh.device());
    Kernel kernel = load_kernel(bvh.device(), kind.file, kind.kernel, launch.with(solid_defines(bvh)));
    return [=, count = shapes_in(shapes, kind)](const Buffer<std::uint32_t>& offsets, const Buffer<Ids>& ids,
                                                Buffer<std::uint32_t>& counts) mutable {
        kernel.run(launch.range(count), SolidBvh{bvh}, shapes, count, arg("offsets", offsets), arg("primitives", ids),
                   arg("counts", counts));
    };
}

void count(const Bvh& bvh, const Buffer<float>& shapes, Buffer<std::uint32_t>& counts, const Shapes& kind) {
    const std::uint32_t queries = shapes_in(shapes, kind);
    if (counts.size() < queries)
        throw Error(ErrorKind::usage, std::to_string(queries) + " " + kind.name + " need the same number of counts");
    count_results<Ids>(bvh, queries, counts, finder(bvh, shapes, kind));
}

Lists<Ids> list(const Bvh& bvh, const Buffer<float>& shapes, const Shapes& kind) {
    return make_lists<Ids>(bvh, shapes_in(shapes, kind), finder(bvh, shapes, kind)).lists;
}

template <class Shape>
Buffer<float> upload(const Bvh& bvh, std::span<const Shape> shapes) {
    return {bvh.device(),
            std::span(reinterpret_cast<const float*>(shapes.data()), shapes.size_bytes() / sizeof(float))};
}

}  // namespace

void count_box_overlaps(const Bvh& bvh, const Buffer<float>& boxes, Buffer<std::uint32_t>& counts) {
    count(bvh, boxes, counts, boxes_of_floats);
}
void count_sphere_overlaps(const Bvh& bvh, const Buffer<float>& spheres, Buffer<std::uint32_t>& counts) {
    count(bvh, spheres, counts, spheres_of_floats);
}

Lists<std::uint32_t> box_overlaps(const Bvh& bvh, const Buffer<float>& boxes) {
    return list(bvh, boxes, boxes_of_floats);
}
Lists<std::uint32_t> sphere_overlaps(const Bvh& bvh, const Buffer<float>& spheres) {
    return list(bvh, spheres, spheres_of_floats);
}

HostLists<std::uint32_t> box_overlaps(const Bvh& bvh, std::span<const Bounds> boxes) {
    static_assert(sizeof(Bounds) == 6 * sizeof(float));
    return download(box_overlaps(bvh, upload(bvh, boxes)));
}
HostLists<std::uint32_t> sphere_overlaps(const Bvh& bvh, std::span<const Sphere> spheres) {
    static_assert(sizeof(Sphere) == 4 * sizeof(float));
    return download(sphere_overlaps(bvh, upload(bvh, spheres)));
}

}  // namespace claray
