// claray.h: sensors.
#include "claray/sensors.hpp"

#include "host/capi/members.hpp"
#include "host/capi/scene.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_beams {
    BeamPattern pattern;
};
struct claray_sensor_world {
    SensorWorld world;
};
struct claray_sensor {
    Sensor sensor;
};

namespace {

static_assert(sizeof(claray_beam) == sizeof(SensorBeam) && sizeof(claray_sensor_pose) == sizeof(SensorPose));
static_assert(sizeof(claray_sensor_return) == sizeof(SensorReturn));

template <class Make>
claray_status hand_out_beams(claray_beams** beams, const Make& make) {
    return guarded([&] { hand_out(beams, "beams", [&] { return new claray_beams{make()}; }); });
}

SensorConfig sensor_config_of(const claray_sensor_config& given) {
    SensorConfig config;
    visit_pairs(given, config, Take{"config"});
    config.pattern.rows = given.rows, config.pattern.columns = given.columns;
    config.pattern.beams = copied<SensorBeam>(given.beams, std::size_t(given.rows) * given.columns, "config.beams");
    return config;
}

std::vector<glm::mat4> matrices_of(const float* rows, std::size_t count, const char* name) {
    std::vector<glm::mat4> matrices;
    const std::span given = array(rows, 12 * count, name);
    for (std::size_t i = 0; i < count; ++i) matrices.push_back(matrix_of(&given[12 * i]));
    return matrices;
}

}  // namespace

claray_status claray_spinning_beams_create(const double* elevations, size_t count, uint32_t columns, double begin,
                                           double turn, claray_beams** beams) {
    return hand_out_beams(beams,
                          [&] { return spinning_beams(array(elevations, count, "elevations"), columns, begin, turn); });
}
claray_status claray_raster_beams_create(uint32_t rows, uint32_t columns, double horizontal_fov, double vertical_fov,
                                         claray_beams** beams) {
    return hand_out_beams(beams, [&] { return raster_beams(rows, columns, horizontal_fov, vertical_fov); });
}
claray_status claray_rosette_beams_create(uint32_t count, double fov, double first, double second, double phase,
                                          claray_beams** beams) {
    return hand_out_beams(beams, [&] { return rosette_beams(count, fov, first, second, phase); });
}
claray_status claray_camera_beams_create(uint32_t width, uint32_t height, const claray_lens* lens, double shutter,
                                         claray_beams** beams) {
    return hand_out_beams(beams, [&] {
        Lens known;
        visit_pairs(versioned(&required(lens, "lens"), "lens"), known, Take{"lens"});
        return camera_beams(width, height, known, shutter);
    });
}

claray_status claray_beams_get(const claray_beams* beams, uint32_t* rows, uint32_t* columns, const claray_beam** all) {
    return guarded([&] {
        const BeamPattern& of = required(beams, "beams").pattern;
        required(rows, "rows") = of.rows, required(columns, "columns") = of.columns;
        required(all, "all") = reinterpret_cast<const claray_beam*>(of.beams.data());
    });
}
void claray_beams_release(claray_beams* beams) { delete beams; }

claray_status claray_sensor_world_build(claray_device* device, const claray_scene* scene,
                                        const claray_sensor_world_config* config, claray_sensor_world** world) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const Scene& from = required(scene, "scene").scene;
        const claray_sensor_world_config known = versioned(config, "config");
        const std::span movers = array(known.movers, known.mover_count, "config.movers");
        const std::span reflectances = array(known.reflectances, known.reflectance_count, "config.reflectances");
        const Builder builder = enumerator(known.builder, "config.builder");
        hand_out(world, "world",
                 [&] { return new claray_sensor_world{SensorWorld::build(on, from, movers, reflectances, builder)}; });
    });
}
const uint32_t* claray_sensor_world_movers(const claray_sensor_world* world, size_t* count) {
    if (count) *count = world ? world->world.movers().size() : 0;
    return world ? world->world.movers().data() : nullptr;
}
claray_status claray_sensor_world_move(claray_sensor_world* world, const float* begins, const float* ends,
                                       size_t count) {
    return guarded([&] {
        required(world, "world").world.move(matrices_of(begins, count, "begins"), matrices_of(ends, count, "ends"));
    });
}
size_t claray_sensor_world_triangle_count(const claray_sensor_world* world) {
    return world ? world->world.triangle_count() : 0;
}
void claray_sensor_world_release(claray_sensor_world* world) { delete world; }

claray_status claray_sensor_config_init(claray_sensor_config* config) {
    return guarded([&] { give(config, put_into<claray_sensor_config>(SensorConfig()), "config"); });
}

claray_status claray_sensor_pose_set(claray_sensor_pose* pose, const double begin[12], const double end[12]) {
    return guarded([&] {
        claray_sensor_pose& place = required(pose, "pose");
        const SensorPose known =
            sensor_pose(matrix_of<glm::dmat4>(&required(begin, "begin")), matrix_of<glm::dmat4>(&required(end, "end")));
        std::memcpy(&place, &known, sizeof place);
    });
}

claray_status claray_sensor_create(claray_device* device, const claray_sensor_config* config, claray_sensor** sensor) {
    return guarded([&] {
        const Device& on = required(device, "device").device;
        const SensorConfig known = sensor_config_of(versioned(&required(config, "config"), "config"));
        hand_out(sensor, "sensor", [&] { return new claray_sensor{Sensor(on, known)}; });
    });
}
size_t claray_sensor_size(const claray_sensor* sensor, size_t pose_count) {
    return sensor ? sensor->sensor.size(pose_count) : 0;
}
claray_status claray_sensor_scan(claray_sensor* sensor, const claray_sensor_world* world,
                                 const claray_sensor_pose* poses, size_t pose_count, uint32_t number,
                                 claray_sensor_return* returns, size_t count) {
    return guarded([&] {
        Sensor& used = required(sensor, "sensor").sensor;
        const SensorWorld& seen = required(world, "world").world;
        const std::span from = array(reinterpret_cast<const SensorPose*>(poses), pose_count, "poses");
        const std::span place = room(returns, count, used.size(pose_count), "returns");
        const std::vector<SensorReturn> found = used.scan(seen, from, number);
        std::memcpy(place.data(), found.data(), place.size_bytes());
    });
}
void claray_sensor_release(claray_sensor* sensor) { delete sensor; }
