// Scenes and rays from files.
#include <cstring>
#include <fstream>

#include "claray/io.hpp"
#include "host/bench/pcg.hpp"
#include "host/bench/rays.hpp"

namespace claray::bench {

std::vector<std::uint32_t> read_words(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw Error(ErrorKind::user, "cannot read " + path.string());
    std::vector<std::uint32_t> words(std::size_t(file.tellg()) / 4 + 1);
    file.seekg(0).read(reinterpret_cast<char*>(words.data()), std::streamsize(words.size() * 4));
    return words;
}

std::vector<Mesh> load_meshes(const std::string& name) {
    if (!name.ends_with(".scn")) {
        Warnings warnings;
        return world_meshes(load_scene(name, warnings));
    }
    const std::vector<std::uint32_t> words = read_words(name);
    Mesh mesh;
    mesh.positions.resize(words.at(1));
    mesh.triangles.resize(words.at(2));
    if (4 + 3 * (mesh.positions.size() + mesh.triangles.size()) > words.size())
        throw Error(ErrorKind::user, name + " is shorter than it says");
    std::memcpy(mesh.positions.data(), &words.at(4), mesh.positions.size() * sizeof(glm::vec3));
    std::memcpy(mesh.triangles.data(), &words.at(4 + 3 * mesh.positions.size()),
                mesh.triangles.size() * sizeof(glm::uvec3));
    return {std::move(mesh)};
}

RaySets read_rays(const std::filesystem::path& path) {
    const std::vector<std::uint32_t> words = read_words(path);
    RaySets sets;
    std::size_t at = 4, i = 1;
    for (std::vector<Ray>* rays : {&sets.primary, &sets.shadow, &sets.bounce}) {
        rays->resize(words.at(i++));
        const std::size_t size = rays->size() * sizeof(Ray) / 4;
        if (at + size > words.size()) throw Error(ErrorKind::user, path.string() + " is shorter than it says");
        std::memcpy(rays->data(), words.data() + at, size * 4);
        at += size;
    }
    Pcg random;
    sets.mixed = shuffled(sets.primary, sets.bounce, random);
    return sets;
}

}  // namespace claray::bench
