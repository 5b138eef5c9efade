// From a scene file of Mitsuba 3 to a scene.
#include "host/io/mitsuba/mitsuba_scene.hpp"
#include "host/io/scene_readers.hpp"

namespace claray {

Scene load_mitsuba_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions&) {
    const MitsubaNode scene = read_mitsuba(path);
    World world(path, warnings);
    MitsubaScene(scene, world).read();
    return world.take();
}

}  // namespace claray
