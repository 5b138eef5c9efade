// From a PLY to a scene.
#include <algorithm>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/image/image_file.hpp"
#include "host/io/mesh/ply_mesh.hpp"
#include "host/io/mesh/positions.hpp"
#include "host/io/obj/mtl.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/scene_textures.hpp"
#include "host/io/strokes.hpp"

namespace claray {
namespace {

struct Part {
    std::string_view element;
    void (PlyMesh::*read)(const PlyElement&);
};
/// In the order in which they need each other.
constexpr Part parts[] = {{"vertex", &PlyMesh::read_vertices},
                          {"face", &PlyMesh::read_faces},
                          {"tristrips", &PlyMesh::read_strips},
                          {"edge", &PlyMesh::read_edges}};
using Parts = std::span<const Part>;

std::size_t rank_of(const PlyElement& element) {
    return std::size_t(std::find_if(std::begin(parts), std::end(parts),
                                    [&](const Part& part) { return part.element == element.name; }) -
                       std::begin(parts));
}

/// All that is in `wanted`.
void read_parts(PlyMesh& maker, const PlyReader& reader, Parts wanted) {
    for (const PlyElement& element : reader.elements()) {
        const auto part = std::find_if(wanted.begin(), wanted.end(),
                                       [&](const Part& known) { return known.element == element.name; });
        part == wanted.end() ? maker.skip(element) : (maker.*part->read)(element);
    }
}

/// Most files have their elements in the order in which they are needed. Others are read once for each part.
void read_all(PlyMesh& maker, PlyReader& reader, std::string_view bytes, const std::filesystem::path& path) {
    std::vector<std::size_t> ranks;
    for (const PlyElement& element : reader.elements())
        if (const std::size_t rank = rank_of(element); rank < std::size(parts)) ranks.push_back(rank);
    if (std::is_sorted(ranks.begin(), ranks.end())) return read_parts(maker, reader, parts);
    for (const Part& part : parts) {
        PlyReader again(bytes, path);
        maker.read_by(again);
        read_parts(maker, again, Parts(&part, 1));
    }
    maker.read_by(reader);
}

Material material_of(const std::string& image, SceneTextures& textures, const std::filesystem::path& path,
                     Warnings& warnings) {
    Material material = grey_lambert(image);
    material.albedo = glm::vec3(1.f);
    const auto decode = [&](TexelFormat format, std::size_t room) -> std::optional<Texture> {
        const std::optional<ImageFile> file = read_image_of_scene(path, path.parent_path(), image, warnings);
        if (!file) return {};
        Texture texture = decode_texture(file->bytes, file->name, format, room);
        texture.name = image;
        return texture;
    };
    if (const auto texture = textures.add(image, {}, decode)) material.albedo_map.texture = *texture;
    show_missing(material);
    return material;
}

void add_materials(Scene& scene, const PlyReader& reader, bool has_uvs, const std::filesystem::path& path,
                   Warnings& warnings) {
    if (!reader.images().empty() && !has_uvs)
        warnings.push_back("'" + path.string() + "' names images, but has no texture coordinates: they are ignored");
    SceneTextures textures(scene);
    if (has_uvs)
        for (const std::string& image : reader.images())
            scene.materials.push_back(material_of(image, textures, path, warnings));
    if (!scene.materials.empty()) return;
    scene.materials.push_back(grey_lambert(scene.name));
    for (Mesh& mesh : scene.meshes) mesh.materials.clear();
}

void warn_of_rows(const PlyReader& reader, const PlyMesh& maker, const std::filesystem::path& path,
                  Warnings& warnings) {
    if (maker.left_out() != 0)
        warnings.push_back(std::to_string(maker.left_out()) + " faces with fewer than 3 vertices were left out");
    const PlyReader::LongLines& lines = reader.long_lines();
    if (lines.count != 0)
        warnings.push_back("'" + path.string() + "' line " + std::to_string(lines.line) +
                           (lines.count > 1 ? " (and " + std::to_string(lines.count - 1) + " more)" : "") +
                           ": more values than the header states: they are ignored");
}

}  // namespace

Scene load_ply_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options) {
    const std::string bytes = read_file(path, "check the path");
    if (bytes.empty()) throw Error(ErrorKind::user, "'" + path.string() + "' is empty", "export the mesh again");
    PlyReader reader(bytes, path);
    Scene scene;
    scene.name = path.stem().string();
    PlyMesh maker(reader, scene.name);
    read_all(maker, reader, bytes, path);
    Mesh mesh = maker.take();
    if (mesh.triangles.empty())
        throw Error(ErrorKind::user, "'" + path.string() + "' contains neither faces nor points",
                    "export the mesh again");
    warn_of_rows(reader, maker, path, warnings);
    warn_of_positions(mesh, path, warnings);
    const bool has_uvs = !mesh.uvs.empty(), is_mesh = maker.has_faces();
    if (is_mesh) scene.meshes.push_back(std::move(mesh));
    add_materials(scene, reader, is_mesh && has_uvs, path, warnings);
    if (is_mesh) return scene;
    mesh.normals.clear(), mesh.uvs.clear(), mesh.materials.assign(mesh.triangles.size(), 0);
    add_strokes(scene, {std::move(mesh)}, options.stroke_radius, warnings);
    return scene;
}

}  // namespace claray
