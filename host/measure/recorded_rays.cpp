// Scenes and rays from files, and rays on the device.
#include <algorithm>
#include <cstring>

#include "claray/io.hpp"
#include "host/base/file.hpp"
#include "host/measure/rays.hpp"

namespace claray::measure {

namespace {

/// The end of `count` items of `size` words each that begin at word `begin`. Throws if it is beyond the file.
std::size_t end_of(const std::filesystem::path& path, const std::vector<std::uint32_t>& words, std::size_t begin,
                   std::size_t count, std::size_t size) {
    const std::size_t end = begin + count * size;
    if (end > words.size()) throw Error(ErrorKind::user, "'" + path.string() + "' is cut off", "record it again");
    return end;
}

constexpr std::size_t header = 4, ray_words = sizeof(Ray) / 4;

}  // namespace

std::vector<std::uint32_t> read_words(const std::filesystem::path& path) {
    const std::string bytes = read_file(path, "check the path");
    std::vector<std::uint32_t> words(bytes.size() / 4 + 1);
    std::memcpy(words.data(), bytes.data(), bytes.size());
    return words;
}

void check_scene_is_there(const std::string& name) {
    for (const char* const extension : {".obj", ".gltf", ".glb", ".scn"})
        if (name.ends_with(extension)) check_file_readable(name, "check the path");
}

std::vector<Mesh> load_meshes(const std::string& name) {
    if (!name.ends_with(".scn")) {
        Warnings warnings;
        const Scene scene = load_scene(name, warnings);
        if (triangle_count(scene) == 0 && !scene.primitives.empty())
            throw Error(ErrorKind::user, "'" + name + "' has primitives only, and no triangle to measure",
                        "use a scene of triangles; bench_primitives measures primitives");
        return world_meshes(scene);
    }
    const std::vector<std::uint32_t> words = read_words(name);
    const std::size_t points_begin = end_of(name, words, 0, header, 1);
    const std::size_t points_end = end_of(name, words, points_begin, words[1], 3);
    static_cast<void>(end_of(name, words, points_end, words[2], 3));
    Mesh mesh;
    mesh.positions.resize(words[1]);
    mesh.triangles.resize(words[2]);
    std::memcpy(mesh.positions.data(), words.data() + points_begin, mesh.positions.size() * sizeof(glm::vec3));
    std::memcpy(mesh.triangles.data(), words.data() + points_end, mesh.triangles.size() * sizeof(glm::uvec3));
    for (const glm::uvec3& t : mesh.triangles)
        if (std::max({t.x, t.y, t.z}) >= mesh.positions.size())
            throw Error(ErrorKind::user,
                        "'" + name + "' has a triangle with an index beyond its " +
                            std::to_string(mesh.positions.size()) + " points",
                        "record it again");
    return {std::move(mesh)};
}

RaySets read_rays(const std::filesystem::path& path) {
    const std::vector<std::uint32_t> words = read_words(path);
    RaySets sets;
    std::size_t at = end_of(path, words, 0, header, 1), i = 1;
    for (std::vector<Ray>* rays : {&sets.primary, &sets.shadow, &sets.bounce}) {
        const std::size_t count = words[i++], end = end_of(path, words, at, count, ray_words);
        rays->resize(count);
        std::memcpy(rays->data(), words.data() + at, count * sizeof(Ray));
        at = end;
    }
    Pcg random;
    sets.mixed = shuffled(sets.primary, sets.bounce, random);
    return sets;
}

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
