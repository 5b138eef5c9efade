// Scenes and rays from files.
#include <algorithm>
#include <cstring>

#include "claray/io.hpp"
#include "host/base/file.hpp"
#include "host/measure/pcg.hpp"
#include "host/measure/rays.hpp"

namespace claray::measure {

std::vector<std::uint32_t> read_words(const std::filesystem::path& path) {
    const std::string bytes = read_file(path, "check the path");
    std::vector<std::uint32_t> words(bytes.size() / 4 + 1);
    std::memcpy(words.data(), bytes.data(), bytes.size());
    return words;
}

namespace {

/// Where `count` things of `size` words each end that begin at word `begin`. Throws where that is beyond the file.
std::size_t end_of(const std::filesystem::path& path, const std::vector<std::uint32_t>& words, std::size_t begin,
                   std::size_t count, std::size_t size) {
    const std::size_t end = begin + count * size;
    if (end > words.size()) throw Error(ErrorKind::user, "'" + path.string() + "' is cut off", "record it again");
    return end;
}

constexpr std::size_t header = 4, ray_words = sizeof(Ray) / 4;

}  // namespace

void check_scene_is_there(const std::string& name) {
    for (const char* const extension : {".obj", ".gltf", ".glb", ".scn"})
        if (name.ends_with(extension)) check_file_readable(name, "check the path");
}

std::vector<Mesh> load_meshes(const std::string& name) {
    if (!name.ends_with(".scn")) {
        Warnings warnings;
        return world_meshes(load_scene(name, warnings));
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

}  // namespace claray::measure
