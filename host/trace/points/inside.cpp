#include "claray/query/points.hpp"
#include "host/trace/lists/lists.hpp"
#include "host/trace/points/points.hpp"
#include "host/trace/query_kernel.hpp"
#include "host/trace/schedule.hpp"

namespace claray {
namespace {

/// The number of triangles above each point.
Buffer<std::uint32_t> crossings_of(const Bvh& bvh, const Buffer<float>& points, std::uint32_t count) {
    const Device& device = bvh.device();
    const Schedule schedule(device);
    Kernel kernel = load_kernel(device, "trace/points/crossings.cl", "crossings", schedule.with(solid_defines(bvh)));
    Buffer<std::uint32_t> crossings(device, count);
    count_results<std::uint32_t>(
        bvh, count, crossings,
        [&](const Buffer<std::uint32_t>& offsets, const Buffer<std::uint32_t>& ids, Buffer<std::uint32_t>& counts) {
            kernel.run(schedule.range(count), SolidBvh{bvh}, points, count, arg("offsets", offsets),
                       arg("primitives", ids), arg("counts", counts));
        });
    return crossings;
}

void check(std::uint32_t points, std::size_t answers) {
    if (answers < points)
        throw Error(ErrorKind::usage,
                    "a query of " + std::to_string(points) + " points needs the same number of answers");
}

}  // namespace

void inside(const Bvh& bvh, const Buffer<float>& points, Buffer<std::uint8_t>& answers) {
    const std::uint32_t count = points_in(points);
    check(count, answers.size());
    if (count == 0) return;
    load_kernel(bvh.device(), "trace/points/crossings.cl", "parities")
        .run({count, 64}, crossings_of(bvh, points, count), count, answers);
}

void signed_distance(const Bvh& bvh, const Buffer<float>& points, Buffer<float>& distances,
                     const PointOptions& options) {
    const std::uint32_t count = points_in(points);
    check(count, distances.size());
    if (count == 0) return;
    Buffer<NearestPoint> nearest(bvh.device(), count);
    nearest_point(bvh, points, nearest, options);
    load_kernel(bvh.device(), "trace/points/crossings.cl", "sign_distances")
        .run({count, 64}, nearest, crossings_of(bvh, points, count), count, distances);
}

std::vector<std::uint8_t> inside(const Bvh& bvh, std::span<const glm::vec3> points) {
    Buffer<std::uint8_t> answers(bvh.device(), points.size());
    inside(bvh, upload_points(bvh.device(), points), answers);
    return answers.read();
}

std::vector<float> signed_distance(const Bvh& bvh, std::span<const glm::vec3> points, const PointOptions& options) {
    Buffer<float> distances(bvh.device(), points.size());
    signed_distance(bvh, upload_points(bvh.device(), points), distances, options);
    return distances.read();
}

}  // namespace claray
