#include "host/measure/device_rays.hpp"

#include <filesystem>

#include "host/measure/rays.hpp"

namespace claray::measure {

DeviceRays::DeviceRays(const Device& device, std::string kind, bool any, const std::vector<Ray>& of)
    : name(std::move(kind)),
      any_hit(any),
      rays(device, of),
      hits(device, any ? 0 : of.size()),
      occluded(device, any ? of.size() : 0) {}

void DeviceRays::trace(const Bvh& bvh) {
    any_hit ? claray::any_hit(bvh, rays, occluded) : closest_hit(bvh, rays, hits);
}

std::string DeviceRays::results() const {
    const auto bytes = [](const auto& values) {
        return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
    };
    return any_hit ? bytes(occluded.read()) : bytes(hits.read());
}

std::vector<DeviceRays> upload_rays(const Device& device, const std::string& name, const std::vector<Mesh>& meshes,
                                    unsigned width, unsigned height) {
    Scene scene;
    scene.meshes = meshes;
    const std::filesystem::path recorded = std::filesystem::path(name).replace_extension(".ray");
    const RaySets sets = name.ends_with(".scn") && std::filesystem::exists(recorded)
                             ? read_rays(recorded)
                             : make_rays(device, scene, three_views(name, scene), width, height);
    std::vector<DeviceRays> all;
    all.emplace_back(device, "primary", false, sets.primary);
    all.emplace_back(device, "shadow", true, sets.shadow);
    all.emplace_back(device, "bounce", false, sets.bounce);
    all.emplace_back(device, "random", false, sets.mixed);
    return all;
}

}  // namespace claray::measure
