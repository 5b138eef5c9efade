// Scans of sensors: every device must find the same bits.
#include "claray/sensors.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/committed.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Fixed meshes, one of them placed by a turn, and two that move.
Scene moving_scene() {
    Scene scene;
    scene.materials.resize(2);
    scene.materials[0].albedo = glm::vec3(0.3f), scene.materials[1].albedo = glm::vec3(0.9f);
    scene.meshes = {soup(3000, 0.3f, 61), sphere(3), scaled(grid(20), 9)};
    scene.meshes[1].materials.assign(scene.meshes[1].triangles.size(), 1);
    const glm::mat4 none(1);
    const auto turned = [&](float angle, const glm::vec3& at) {
        return glm::rotate(glm::translate(none, at), angle, glm::vec3(0.6f, 0, 0.8f));
    };
    scene.instances = {{.mesh = 0}, {.mesh = 2, .transform = turned(0.4f, {0, 0, -2})}, {.mesh = 1}, {.mesh = 1}};
    scene.instances[2].transform = turned(0, {3, 0, 0}), scene.instances[2].transform_end = turned(0.3f, {2.5f, 1, 0});
    scene.instances[3].transform = turned(1, {-2, 2, 1}), scene.instances[3].transform_end = turned(1, {-2, 2, 0});
    return scene;
}

SensorConfig config_of(std::uint32_t rays, ReturnOrder order) {
    SensorConfig config;
    std::vector<double> elevations;
    for (int i = 0; i < 24; ++i) elevations.push_back(0.7 - 0.06 * i);
    config.pattern = spinning_beams(elevations, 500, 1, -6.25);
    config.rays = rays, config.returns = std::min(rays, 3u), config.order = order;
    config.divergence = {0.02, 0.01}, config.farthest = 12;
    config.range_noise = 0.01f, config.velocity_noise = 0.1f, config.intensity_noise = 0.05f, config.dropout = 0.02f;
    config.extinction = 0.01f, config.seed = 9;
    return config;
}

void scan_hashes(Run& run) {
    Committed committed(run);
    const SensorWorld world = SensorWorld::build(run.device(), moving_scene());
    const glm::dmat4 at = glm::translate(glm::dmat4(1), glm::dvec3(0.2, -1.4, 0.3));
    const glm::dmat4 end = glm::rotate(glm::translate(at, glm::dvec3(0.3, 0.1, 0)), 0.2, glm::dvec3(0, 0.28, 0.96));
    const std::vector<SensorPose> poses{sensor_pose(at, end), sensor_pose(end, end)};
    for (const auto& [rays, order, name] : {std::tuple(1u, ReturnOrder::strongest, "one ray a beam"),
                                            std::tuple(5u, ReturnOrder::strongest, "five rays a beam"),
                                            std::tuple(8u, ReturnOrder::last, "eight rays a beam, last returns")}) {
        SensorConfig config = config_of(rays, order);
        config.in_world = order == ReturnOrder::last;
        const std::vector<SensorReturn> returns = Sensor(run.device(), config).scan(world, poses, 5);
        run.fact(std::string("scan of ") + name, hash_of(returns));
        committed.compare(std::string("scan of ") + name, returns);
    }
    committed.check("scans");
}

}  // namespace

Cases sensor_cases() {
    return {{{"scan-hashes", "sameness", "All devices measure the same returns of a lidar"}, scan_hashes}};
}

}  // namespace claray::verify
