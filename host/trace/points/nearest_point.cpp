#include "claray/query/points.hpp"
#include "host/trace/points/points.hpp"
#include "host/trace/query_kernel.hpp"
#include "host/trace/query_launch.hpp"

namespace claray {
namespace {

void check(const Bvh& bvh, std::uint32_t count, std::size_t answers, const PointOptions& options) {
    const bool short_masks = options.masks.allocated() && options.masks.size() < count;
    const bool short_visits = options.visits.allocated() && options.visits.size() < count;
    if (answers < count || short_masks || short_visits)
        throw Error(ErrorKind::usage, "a query of " + std::to_string(count) + " points needs the same number of " +
                                          (answers < count ? "answers"
                                           : short_masks   ? "masks"
                                                           : "visits"));
    if (options.brute_force && bvh.layout() != Layout::binary)
        throw Error(ErrorKind::usage, "a search by brute force needs the binary layout", "build with Layout::binary");
}

}  // namespace

void nearest_point(const Bvh& bvh, const Buffer<float>& points, Buffer<NearestPoint>& nearest,
                   const PointOptions& options) {
    const std::uint32_t count = points_in(points);
    check(bvh, count, nearest.size(), options);
    if (count == 0) return;
    const QueryLaunch launch(bvh.device());
    Defines defines = launch.with(solid_defines(bvh));
    if (options.masks.allocated()) defines.emplace_back("CLARAY_RAY_MASKS", "1");
    if (options.visits.allocated()) defines.emplace_back("CLARAY_COUNT_VISITS", "1");
    if (options.brute_force) defines.emplace_back("BRUTE_FORCE", "1");
    const Buffer<std::uint32_t> order = options.sort ? point_order(bvh, points, count) : Buffer<std::uint32_t>{};
    load_kernel(bvh.device(), "trace/points/nearest_point.cl", "nearest_point", defines)
        .run(launch.range(count), SolidBvh{bvh}, points, nearest, count, options.reach, arg("order", order),
             arg("masks", options.masks), options.visits);
}

std::vector<NearestPoint> nearest_point(const Bvh& bvh, std::span<const glm::vec3> points,
                                        const PointOptions& options) {
    const Buffer<float> on_device = upload_points(bvh.device(), points);
    Buffer<NearestPoint> nearest(bvh.device(), points.size());
    nearest_point(bvh, on_device, nearest, options);
    return nearest.read();
}

}  // namespace claray
