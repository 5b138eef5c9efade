// Sensors: sensors/send_beams.cl and sensors/find_returns.cl against what can be computed by hand, and against queries.
#include "claray/sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "claray/instances.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

Mesh square_at(float x, float half) {
    return {.positions = {{x, -half, -half}, {x, half, -half}, {x, half, half}, {x, -half, half}},
            .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

Scene scene_of(std::vector<Mesh> meshes) {
    Scene scene;
    scene.meshes = std::move(meshes);
    scene.materials.resize(1);
    scene.materials[0].albedo = glm::vec3(0.5f, 0.1f, 0.2f);
    return scene;
}

BeamPattern along_x() { return {1, 1, {{1, 0, 0, 0}}}; }

SensorPose at_origin() { return sensor_pose(glm::dmat4(1), glm::dmat4(1)); }

std::vector<SensorReturn> scan_once(const SensorWorld& world, const SensorConfig& config,
                                    const SensorPose& pose = at_origin()) {
    return Sensor(device(), config).scan(world, std::span(&pose, 1));
}

TEST(Sensors, AWallHasItsRangeAndIntensity) {
    const SensorWorld world = SensorWorld::build(device(), scene_of({square_at(8, 100)}));
    SensorConfig config;
    config.pattern = raster_beams(5, 7, 1.2, 0.8);
    const std::vector<SensorReturn> returns = scan_once(world, config);
    ASSERT_EQ(returns.size(), 35u);
    for (std::size_t i = 0; i < returns.size(); ++i) {
        const SensorBeam& beam = config.pattern.beams[i];
        const double range = 8.0 / beam.x;
        EXPECT_NEAR(returns[i].range, range, 2e-6 * range);
        EXPECT_NEAR(returns[i].x, 8, 2e-5);
        EXPECT_NEAR(returns[i].y, range * beam.y, 2e-5);
        EXPECT_NEAR(returns[i].intensity, 0.5 * beam.x / (range * range), 1e-8);
        EXPECT_EQ(returns[i].nx, -1.f);
        EXPECT_EQ(returns[i].ring, i / 7);
        EXPECT_EQ(returns[i].column, i % 7);
        EXPECT_EQ(returns[i].share, 1.f);
        EXPECT_EQ(returns[i].instance, 0u);
        EXPECT_LT(returns[i].primitive, 2u);
    }
}

TEST(Sensors, WhatIsTooNearHidesAndWhatIsTooFarIsNotSeen) {
    const SensorWorld world = SensorWorld::build(device(), scene_of({square_at(2, 1), square_at(8, 1)}));
    SensorConfig config;
    config.pattern = along_x();
    EXPECT_FLOAT_EQ(scan_once(world, config)[0].range, 2);
    config.nearest = 3;
    EXPECT_TRUE(std::isnan(scan_once(world, config)[0].range));
    config.nearest = 0, config.farthest = 1.5f;
    const SensorReturn none = scan_once(world, config)[0];
    EXPECT_TRUE(std::isnan(none.x) && std::isnan(none.velocity));
    EXPECT_EQ(none.instance, CLARAY_MISS);
    EXPECT_EQ(none.intensity, 0);
}

/// The edge of a square covers a half of the beam; the wall behind gets the other half.
TEST(Sensors, AnEdgeDividesABeam) {
    Mesh half = square_at(10, 1);
    for (glm::vec3& p : half.positions) p.y += 1;
    const SensorWorld world = SensorWorld::build(device(), scene_of({half, square_at(20, 50)}));
    SensorConfig config;
    config.pattern = along_x();
    config.rays = 63, config.returns = 3, config.order = ReturnOrder::first;
    config.divergence = {0.01, 0.01};
    std::vector<SensorReturn> returns = scan_once(world, config);
    EXPECT_NEAR(returns[0].range, 10, 1e-3);
    EXPECT_NEAR(returns[1].range, 20, 1e-3);
    EXPECT_NEAR(returns[0].share, 0.5, 0.06);
    EXPECT_NEAR(returns[0].share + returns[1].share, 1, 1e-6);
    EXPECT_NEAR(returns[0].intensity, returns[0].share * 0.5 / 100, 1e-6);
    EXPECT_EQ(returns[2].instance, CLARAY_MISS);
    const float near = returns[0].intensity, far = returns[1].intensity;
    EXPECT_GT(near, far);
    config.order = ReturnOrder::last;
    returns = scan_once(world, config);
    EXPECT_NEAR(returns[0].range, 20, 1e-3);
    EXPECT_EQ(returns[1].intensity, near);
    config.returns = 1;
    EXPECT_NEAR(scan_once(world, config)[0].range, 20, 1e-3);
    config.order = ReturnOrder::strongest;
    EXPECT_EQ(scan_once(world, config)[0].intensity, near);
    config.range_resolution = 15, config.returns = 2;  // both become one
    returns = scan_once(world, config);
    EXPECT_NEAR(returns[0].share, 1, 1e-6);
    EXPECT_NEAR(returns[0].range, 10 + 10 * (1 - near * 100 / 0.5), 1e-2);
    EXPECT_EQ(returns[1].instance, CLARAY_MISS);
}

/// The wall behind an edge reflects more: its return is the strongest, and tells what a return of both met.
TEST(Sensors, TheStrongestSurfaceCounts) {
    Mesh half = square_at(10, 1), wall = square_at(20, 50);
    for (glm::vec3& p : half.positions) p.y += 1;
    wall.materials = {1, 1};
    Scene scene = scene_of({half, wall});
    scene.materials.resize(2);
    const std::vector<float> reflectances{0.2f, 8};
    const SensorWorld world = SensorWorld::build(device(), scene, {}, reflectances);
    SensorConfig config;
    config.pattern = along_x();
    config.rays = 63, config.returns = 3, config.divergence = {0.01, 0.01};
    const std::vector<SensorReturn> apart = scan_once(world, config);
    EXPECT_NEAR(apart[0].range, 20, 1e-3);
    EXPECT_NEAR(apart[1].range, 10, 1e-3);
    EXPECT_EQ(apart[0].material, 1u);
    config.range_resolution = 15;
    const SensorReturn both = scan_once(world, config)[0];
    EXPECT_EQ(both.material, 1u);
    EXPECT_EQ(both.instance, 1u);
    EXPECT_NEAR(both.range, 10 * apart[1].share + 20 * apart[0].share, 1e-4);
    EXPECT_FLOAT_EQ(both.intensity, apart[0].intensity + apart[1].intensity);
    config.range_resolution = 0.1f, config.least_intensity = 0.5f * (apart[0].intensity + apart[1].intensity);
    EXPECT_EQ(scan_once(world, config)[1].instance, CLARAY_MISS);
}

TEST(Sensors, MoversAndTheSensorGiveVelocities) {
    Scene scene = scene_of({square_at(0, 1)});
    scene.instances = {{.mesh = 0, .transform = glm::translate(glm::mat4(1), {10, 0, 0})}};
    const std::vector<std::uint32_t> movers{0};
    SensorWorld world = SensorWorld::build(device(), scene, movers);
    const std::vector<glm::mat4> begin{glm::translate(glm::mat4(1), {10, 0, 0})},
        end{glm::translate(glm::mat4(1), {11, 3, 0})};
    SensorConfig config;
    config.pattern = {1, 3, {{1, 0, 0, 0}, {1, 0, 0, 0.25f}, {0.8f, 0.6f, 0, 0.5f}}};
    config.duration = 0.1f;
    std::vector<SensorReturn> returns = scan_once(world, config);
    EXPECT_FLOAT_EQ(returns[0].range, 10);
    EXPECT_FLOAT_EQ(returns[0].velocity, 0);
    world.move(begin, end);
    returns = scan_once(world, config);
    EXPECT_NEAR(returns[0].velocity, 10, 1e-5);
    EXPECT_NEAR(returns[1].range, 10.25, 1e-5);
    EXPECT_NEAR(returns[1].velocity, 10, 1e-5);
    EXPECT_NEAR(returns[1].time, 0.025, 1e-8);
    EXPECT_EQ(returns[2].instance, CLARAY_MISS);  // it left to the side
    const SensorPose behind = sensor_pose(glm::dmat4(1), glm::translate(glm::dmat4(1), {2, 0, 0}));
    returns = scan_once(world, config, behind);
    EXPECT_NEAR(returns[0].velocity, 10 - 20, 1e-5);
    EXPECT_NEAR(returns[1].range, 10.25 - 0.5, 1e-5);
    config.in_world = true;
    EXPECT_NEAR(scan_once(world, config, behind)[1].x, 10.25, 1e-5);
}

/// A turning square: its normal, and the velocity of its points.
TEST(Sensors, TurnedMoversHaveTurnedNormals) {
    Scene scene = scene_of({square_at(0, 4)});
    const glm::mat4 far = glm::translate(glm::mat4(1), {10, 0, 0});
    const auto turned = [&](float angle) { return glm::scale(glm::rotate(far, angle, {0, 0, 1}), {-2, 1, 1}); };
    scene.instances = {{.mesh = 0, .transform = turned(0.3f)}};
    scene.instances[0].transform_end = turned(0.4f);
    const SensorWorld world = SensorWorld::build(device(), scene);
    EXPECT_EQ(world.movers().size(), 1u);
    SensorConfig config;
    config.pattern = {1, 2, {{1, 0, 0, 0}, {float(std::cos(0.1)), float(std::sin(0.1)), 0, 0}}};
    const std::vector<SensorReturn> returns = scan_once(world, config);
    EXPECT_NEAR(returns[0].nx, -std::cos(0.3), 1e-6);
    EXPECT_NEAR(returns[0].ny, -std::sin(0.3), 1e-6);
    EXPECT_NEAR(returns[0].range, 10, 1e-5);
    EXPECT_NEAR(returns[0].velocity, 0, 1e-4);
    // A point that is l from the axis moves by the difference of both matrices times l.
    const double range = returns[1].range, x = range * std::cos(0.1) - 10, y = range * std::sin(0.1);
    const double l = std::copysign(std::hypot(x, y), y);
    const double dx = (std::sin(0.3) - std::sin(0.4)) * l, dy = (std::cos(0.4) - std::cos(0.3)) * l;
    EXPECT_NEAR(returns[1].velocity, 10 * (dx * std::cos(0.1) + dy * std::sin(0.1)), 1e-3);
    EXPECT_GT(std::abs(returns[1].velocity), 0.5);
}

TEST(Sensors, ATurningSensorTurnsItsBeams) {
    const SensorWorld world = SensorWorld::build(device(), scene_of({square_at(5, 50)}));
    SensorConfig config;
    config.pattern = {1, 3, {{1, 0, 0, 0}, {1, 0, 0, 0.5f}, {1, 0, 0, 1}}};
    const glm::dmat4 end = glm::rotate(glm::dmat4(1), 0.8, glm::dvec3(0, 0, 1));
    const std::vector<SensorReturn> returns = scan_once(world, config, sensor_pose(glm::dmat4(1), end));
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(returns[i].range, 5 / std::cos(0.4 * i), 1e-5);
        EXPECT_NEAR(returns[i].y, 0, 0);
        EXPECT_NEAR(returns[i].nx, -std::cos(0.4 * i), 1e-6);
        EXPECT_NEAR(returns[i].ny, std::sin(0.4 * i), 1e-6);
    }
}

/// Fixed triangles and movers together give the hits of a query over all instances, bit for bit.
TEST(Sensors, RangesEqualThoseOfAQuery) {
    Scene scene = scene_of({sphere(2), soup(300, 0.4f, 5), square_at(9, 20)});
    const auto at = [](float x, float y, float z) { return glm::translate(glm::mat4(1), {x, y, z}); };
    scene.instances = {{.mesh = 1, .transform = glm::mat4(1)},
                       {.mesh = 0, .transform = at(4, 1, 0)},
                       {.mesh = 2},
                       {.mesh = 0, .transform = at(-3, 0, 1)}};
    scene.instances[1].transform_end = glm::rotate(at(3, -2, 0), 0.7f, {1, 2, 3});
    SensorConfig config;
    std::vector<double> elevations;
    for (int i = 0; i < 16; ++i) elevations.push_back(0.6 - 0.08 * i);
    config.pattern = spinning_beams(elevations, 400, 3.0, -6.283185307179586);
    config.farthest = 30;
    const glm::dmat4 pose = glm::translate(glm::dmat4(1), {0.3, -0.2, 0.1});
    const std::vector<std::uint32_t> movers{3};
    const std::vector<SensorReturn> returns =
        scan_once(SensorWorld::build(device(), scene, movers), config, sensor_pose(pose, pose));
    std::vector<Bvh> bottoms;
    std::vector<Instance> begins, ends;
    for (const Mesh& mesh : scene.meshes) bottoms.push_back(Bvh::build(device(), std::span(&mesh, 1)));
    for (const MeshInstance& i : scene.instances) {
        begins.push_back(make_instance(i.transform, i.mesh));
        ends.push_back(make_instance(i.transform_end.value_or(i.transform), i.mesh));
    }
    const InstancedBvh all = InstancedBvh::build(bottoms, begins, ends, {});
    std::vector<Ray> rays;
    std::vector<float> times;
    for (const SensorBeam& b : config.pattern.beams) {
        rays.push_back({0.3f, -0.2f, 0.1f, 0, b.x, b.y, b.z, 30});
        times.push_back(b.time);
    }
    QueryOptions options;
    options.ray_times = Buffer<float>(device(), times);
    options.brute_force = true;
    const std::vector<InstanceHit> hits = closest_hit(all, rays, options);
    std::size_t met = 0, moving = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        ASSERT_EQ(returns[i].instance, hits[i].instance) << i;
        ASSERT_EQ(returns[i].primitive, hits[i].primitive) << i;
        if (hits[i].primitive == CLARAY_MISS) continue;
        ASSERT_EQ(returns[i].range, hits[i].t) << i;
        ++met, moving += hits[i].instance == 1;
    }
    EXPECT_GT(met, hits.size() / 4);
    EXPECT_GT(moving, 50u);
}

TEST(Sensors, NoiseHasItsDeviationAndDropoutsTheirRate) {
    const SensorWorld world = SensorWorld::build(device(), scene_of({square_at(10, 1)}));
    SensorConfig config;
    config.pattern = {1, 20'000, std::vector<SensorBeam>(20'000, {1, 0, 0, 0})};
    config.range_noise = 0.02f, config.intensity_noise = 0.1f, config.velocity_noise = 0.3f, config.dropout = 0.2f;
    config.seed = 7;
    const Sensor sensor(device(), config);
    const SensorPose pose = at_origin();
    const std::vector<SensorReturn> returns = Sensor(sensor).scan(world, std::span(&pose, 1), 3);
    double count = 0, sum = 0, squares = 0, fourth = 0, velocities = 0, intensities = 0, mixed = 0;
    for (const SensorReturn& r : returns) {
        if (r.instance == CLARAY_MISS) continue;
        const double e = (r.range - 10.) / 0.02, intensity = (r.intensity / 0.005 - 1) / 0.1;
        ++count, sum += e, squares += e * e, fourth += e * e * e * e, mixed += e * intensity;
        velocities += double(r.velocity) * r.velocity / 0.09, intensities += intensity * intensity;
    }
    EXPECT_NEAR(count, 16'000, 4 * std::sqrt(20'000 * 0.2 * 0.8));
    EXPECT_NEAR(sum / count, 0, 4 / std::sqrt(count));
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 / count));
    EXPECT_NEAR(fourth / count, 3, 4 * std::sqrt(96 / count));
    EXPECT_NEAR(intensities / count, 1, 4 * std::sqrt(2 / count));
    EXPECT_NEAR(velocities / count, 1, 4 * std::sqrt(2 / count));
    EXPECT_NEAR(mixed / count, 0, 4 / std::sqrt(count));
    const auto same = [&](std::uint32_t number, std::uint32_t seed) {
        SensorConfig other = config;
        other.seed = seed;
        const std::vector<SensorReturn> again = Sensor(device(), other).scan(world, std::span(&pose, 1), number);
        return std::memcmp(again.data(), returns.data(), returns.size() * sizeof(SensorReturn)) == 0;
    };
    EXPECT_TRUE(same(3, 7));
    EXPECT_FALSE(same(4, 7));
    EXPECT_FALSE(same(3, 8));
}

TEST(Sensors, SensorsInOneScanAreThoseAlone) {
    const SensorWorld world = SensorWorld::build(device(), scene_of({square_at(10, 30), sphere(2)}));
    SensorConfig config;
    config.pattern = raster_beams(9, 33, 1, 0.5);
    config.rays = 5, config.returns = 2, config.divergence = {0.02, 0.01};
    std::vector<SensorPose> poses;
    for (int i = 0; i < 4; ++i)
        poses.push_back(sensor_pose(glm::translate(glm::dmat4(1), {-3., i * 0.5, 0.}), glm::dmat4(1)));
    Sensor sensor(device(), config);
    const std::vector<SensorReturn> all = sensor.scan(world, poses);
    ASSERT_EQ(all.size(), 4 * sensor.size(1));
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::vector<SensorReturn> one = sensor.scan(world, std::span(&poses[i], 1));
        EXPECT_EQ(std::memcmp(one.data(), &all[i * one.size()], one.size() * sizeof(SensorReturn)), 0) << i;
    }
}

TEST(Sensors, LensesAreInverted) {
    const Lens brown{LensKind::pinhole, 300, 310, 159, 121, {-0.28, 0.07, 1e-3, -2e-3, 0.01}};
    const BeamPattern pixels = camera_beams(320, 240, brown, 1);
    for (std::size_t i = 0; i < pixels.beams.size(); i += 37) {
        const SensorBeam& b = pixels.beams[i];
        const double x = double(b.x) / b.z, y = double(b.y) / b.z, r2 = x * x + y * y;
        const double radial = 1 - 0.28 * r2 + 0.07 * r2 * r2 + 0.01 * r2 * r2 * r2;
        const double u = x * radial + 2e-3 * x * y - 2e-3 * (r2 + 2 * x * x);
        const double v = y * radial + 1e-3 * (r2 + 2 * y * y) - 4e-3 * x * y;
        EXPECT_NEAR(u * 300 + 159, double(i % 320), 1e-3);
        EXPECT_NEAR(v * 310 + 121, double(i / 320), 1e-3);
        EXPECT_FLOAT_EQ(b.time, float(i / 320) / 240);
    }
    const Lens fish{LensKind::equidistant, 60, 60, 99.5, 99.5, {0.02, -0.003, 0, 0}};
    const BeamPattern circle = camera_beams(200, 200, fish, 0);
    std::size_t outside = 0;
    for (std::size_t i = 0; i < circle.beams.size(); i += 7) {
        const SensorBeam& b = circle.beams[i];
        const double radius = std::hypot(double(i % 200) - 99.5, double(i / 200) - 99.5) / 60;
        if (b.x == 0 && b.y == 0 && b.z == 0) {
            ++outside;
            continue;
        }
        const double a = std::atan2(std::hypot(double(b.x), double(b.y)), double(b.z));
        EXPECT_NEAR(a * (1 + 0.02 * a * a - 0.003 * a * a * a * a), radius, 1e-5);
    }
    EXPECT_LT(outside, circle.beams.size() / 70);
}

TEST(Sensors, BadInputNamesItsMember) {
    SensorConfig config;
    config.pattern = along_x();
    const auto refused = [&](const std::string& words, const auto& change) {
        SensorConfig bad = config;
        change(bad);
        return throws_error(ErrorKind::usage, words, [&] { (void)Sensor(device(), bad); });
    };
    EXPECT_TRUE(refused("rays: is 65", [](SensorConfig& c) { c.rays = 65; }));
    EXPECT_TRUE(refused("returns: is 2", [](SensorConfig& c) { c.returns = 2; }));
    EXPECT_TRUE(refused("dropout: is 1.5", [](SensorConfig& c) { c.dropout = 1.5f; }));
    EXPECT_TRUE(refused("farthest: is nan", [](SensorConfig& c) { c.farthest = NAN; }));
    EXPECT_TRUE(refused("beam 0 has the length 2", [](SensorConfig& c) { c.pattern.beams[0].x = 2; }));
    EXPECT_TRUE(refused("time -1", [](SensorConfig& c) { c.pattern.beams[0].time = -1; }));
    EXPECT_TRUE(refused("pattern: has 1 beams in 2 rows", [](SensorConfig& c) { c.pattern.rows = 2; }));
    const Scene scene = scene_of({square_at(1, 1)});
    const std::vector<std::uint32_t> movers{1};
    const std::vector<float> whites{1, 2};
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "movers: holds 1", [&] { (void)SensorWorld::build(device(), scene, movers); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "reflectances: has 2 numbers",
                             [&] { (void)SensorWorld::build(device(), scene, {}, whites); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "scene: has no triangles",
                             [&] { (void)SensorWorld::build(device(), Scene{}); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "pose: is not a rotation", [] {
        (void)sensor_pose(glm::scale(glm::dmat4(1), {2., 1., 1.}), glm::dmat4(1));
    }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "pose_end: half a turn", [] {
        (void)sensor_pose(glm::dmat4(1), glm::rotate(glm::dmat4(1), std::numbers::pi, glm::dvec3(0, 1, 0)));
    }));
}

}  // namespace
}  // namespace claray::test
