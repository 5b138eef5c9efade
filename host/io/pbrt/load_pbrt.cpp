// From a scene file of pbrt-v4 (pbrt.org/fileformat-v4) to a scene.
#include "host/io/pbrt/pbrt_scene.hpp"
#include "host/io/scene_readers.hpp"

namespace claray {

Scene load_pbrt_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions&) {
    World world(path, warnings);
    PbrtScene(path, world).read();
    return world.take();
}

}  // namespace claray
