#include <cmath>
#include <numbers>

#include "claray/query/all_hits.hpp"
#include "claray/query/points.hpp"
#include "host/trace/lists/lists.hpp"
#include "host/trace/points/points.hpp"
#include "host/trace/query_kernel.hpp"
#include "host/trace/query_launch.hpp"

namespace claray {
namespace {

/// The number of triangles above each point.
Buffer<std::uint32_t> crossings_of(const Bvh& bvh, const Buffer<float>& points, std::uint32_t count) {
    const Device& device = bvh.device();
    const QueryLaunch launch(device);
    Kernel kernel = load_kernel(device, "trace/points/crossings.cl", "crossings", launch.with(solid_defines(bvh)));
    Buffer<std::uint32_t> crossings(device, count);
    count_results<std::uint32_t>(
        bvh, count, crossings,
        [&](const Buffer<std::uint32_t>& offsets, const Buffer<std::uint32_t>& ids, Buffer<std::uint32_t>& counts) {
            kernel.run(launch.range(count), SolidBvh{bvh}, points, count, arg("offsets", offsets),
                       arg("primitives", ids), arg("counts", counts));
        });
    return crossings;
}

/// Directions in opposite pairs, on a spiral (Vogel 1979): a plane divides them evenly, so that no side of it is
/// inside.
std::vector<glm::vec3> directions_of_voters() {
    constexpr int pairs = 8;
    std::vector<glm::vec3> directions;
    for (int i = 0; i < pairs; ++i) {
        const double z = (i + 0.5) / pairs, across = std::sqrt(1 - z * z),
                     golden = std::numbers::pi * (3 - std::sqrt(5));
        const glm::vec3 direction(across * std::cos(golden * i), across * std::sin(golden * i), z);
        directions.push_back(direction), directions.push_back(-direction);
    }
    return directions;
}

/// 1 for each point that most rays find inside, else 0.
Buffer<std::uint32_t> votes_of(const Bvh& bvh, const Buffer<float>& points, std::uint32_t count) {
    const Device& device = bvh.device();
    const auto load = [&](const char* name) { return load_kernel(device, "trace/points/crossings.cl", name); };
    Kernel aim = load("rays_from_points"), add = load("add_votes");
    Buffer<Ray> rays(device, count);
    Buffer<std::uint32_t> crossings(device, count), votes(device, count);
    votes.fill(0);
    const std::vector<glm::vec3> directions = directions_of_voters();
    for (const glm::vec3& direction : directions) {
        aim.run({count, 64}, points, count, direction.x, direction.y, direction.z, rays);
        count_hits(bvh, rays, crossings);
        add.run({count, 64}, arg("counts", crossings), count, arg("votes", votes));
    }
    load("decide_votes").run({count, 64}, votes, count, std::uint32_t(directions.size()));
    return votes;
}

/// An odd number for each point that is inside.
Buffer<std::uint32_t> sides_of(const Bvh& bvh, const Buffer<float>& points, std::uint32_t count, bool vote) {
    return vote && !is_closed(bvh) ? votes_of(bvh, points, count) : crossings_of(bvh, points, count);
}

void check(std::uint32_t points, std::size_t answers) {
    if (answers < points)
        throw Error(ErrorKind::usage,
                    "a query of " + std::to_string(points) + " points needs the same number of answers");
}

}  // namespace

void inside(const Bvh& bvh, const Buffer<float>& points, Buffer<std::uint8_t>& answers, const PointOptions& options) {
    const std::uint32_t count = points_in(points);
    check(count, answers.size());
    if (count == 0) return;
    load_kernel(bvh.device(), "trace/points/crossings.cl", "parities")
        .run({count, 64}, sides_of(bvh, points, count, options.vote), count, answers);
}

void signed_distance(const Bvh& bvh, const Buffer<float>& points, Buffer<float>& distances,
                     const PointOptions& options) {
    const std::uint32_t count = points_in(points);
    check(count, distances.size());
    if (count == 0) return;
    Buffer<NearestPoint> nearest(bvh.device(), count);
    nearest_point(bvh, points, nearest, options);
    load_kernel(bvh.device(), "trace/points/crossings.cl", "sign_distances")
        .run({count, 64}, nearest, sides_of(bvh, points, count, options.vote), count, distances);
}

std::vector<std::uint8_t> inside(const Bvh& bvh, std::span<const glm::vec3> points, const PointOptions& options) {
    Buffer<std::uint8_t> answers(bvh.device(), points.size());
    inside(bvh, upload_points(bvh.device(), points), answers, options);
    return answers.read();
}

std::vector<float> signed_distance(const Bvh& bvh, std::span<const glm::vec3> points, const PointOptions& options) {
    Buffer<float> distances(bvh.device(), points.size());
    signed_distance(bvh, upload_points(bvh.device(), points), distances, options);
    return distances.read();
}

}  // namespace claray
