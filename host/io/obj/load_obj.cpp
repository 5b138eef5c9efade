// From an OBJ's arrays and polygons to a scene.
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "claray/error.hpp"
#include "host/io/obj/mtl.hpp"
#include "host/io/obj/obj_file.hpp"
#include "host/io/obj/triangulate.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/strokes.hpp"

namespace claray {
namespace {

struct CornerHash {
    std::size_t operator()(const ObjCorner& c) const {
        std::uint64_t h = (std::uint64_t(std::uint32_t(c.position)) << 32 | std::uint32_t(c.uv)) * 0x9e3779b97f4a7c15u;
        h = (h ^ (h >> 29) ^ std::uint32_t(c.normal)) * 0xbf58476d1ce4e5b9u;
        return std::size_t(h ^ (h >> 32));
    }
};

/// MTL counts v from the bottom of an image, claray from the top.
glm::vec2 from_the_top(const glm::vec2& uv) {
    return std::isfinite(uv.x) && std::isfinite(uv.y) ? glm::vec2(uv.x, 1.f - uv.y) : glm::vec2(0.f);
}

/// A normal of no direction is as good as none.
bool usable_normal(const glm::vec3& n) {
    const float length = glm::length(n);
    return std::isfinite(length) && length > 1e-12f;
}

/// One mesh in the making. Corners that agree in position, texture coordinate and normal share a vertex.
class MeshBuilder {
public:
    MeshBuilder(const ObjFile& file, std::string name) : file_(file) { mesh_.name = std::move(name); }

    /// Meshes have normals, texture coordinates and colours for all vertices or for none.
    void plan(std::span<const ObjCorner> corners) {
        for (const ObjCorner& c : corners) {
            has_normals_ |= c.normal >= 0 && usable_normal(file_.normals[std::size_t(c.normal)]);
            has_uvs_ |= c.uv >= 0;
            has_colors_ |= !file_.colors.empty() && file_.colors[std::size_t(c.position)] != glm::vec3(1.f);
        }
    }

    void add(std::span<const ObjCorner> polygon, std::uint32_t material) {
        points_.clear();
        for (const ObjCorner& c : polygon) points_.push_back(file_.positions[std::size_t(c.position)]);
        pieces_.clear();
        triangulate(points_, pieces_);
        for (const glm::uvec3& piece : pieces_) {
            const glm::vec3 normal = has_normals_ ? flat_normal(piece) : glm::vec3(0.f);
            glm::uvec3 triangle;
            for (int k = 0; k < 3; ++k) triangle[k] = vertex(polygon[piece[k]], normal);
            mesh_.triangles.push_back(triangle);
            mesh_.materials.push_back(material);
        }
    }

    [[nodiscard]] Mesh take() { return std::move(mesh_); }

private:
    [[nodiscard]] glm::vec3 flat_normal(const glm::uvec3& t) const {
        const glm::vec3 n = glm::cross(points_[t.y] - points_[t.x], points_[t.z] - points_[t.x]);
        return usable_normal(n) ? glm::normalize(n) : glm::vec3(0.f, 1.f, 0.f);
    }

    std::uint32_t vertex(ObjCorner corner, const glm::vec3& flat) {
        // Among normals of other faces, a corner without one takes its triangle's and is not shared.
        const bool own = corner.normal >= 0 && usable_normal(file_.normals[std::size_t(corner.normal)]);
        if (!own) corner.normal = has_normals_ ? -2 - int(mesh_.triangles.size()) : -1;
        const auto [found, is_new] = vertices_.try_emplace(corner, std::uint32_t(mesh_.positions.size()));
        if (!is_new) return found->second;
        mesh_.positions.push_back(file_.positions[std::size_t(corner.position)]);
        if (has_normals_)
            mesh_.normals.push_back(own ? glm::normalize(file_.normals[std::size_t(corner.normal)]) : flat);
        if (has_uvs_)
            mesh_.uvs.push_back(corner.uv >= 0 ? from_the_top(file_.uvs[std::size_t(corner.uv)]) : glm::vec2(0.f));
        if (has_colors_) mesh_.colors.emplace_back(file_.colors[std::size_t(corner.position)], 1.f);
        return found->second;
    }

    const ObjFile& file_;
    Mesh mesh_;
    bool has_normals_ = false, has_uvs_ = false, has_colors_ = false;
    std::unordered_map<ObjCorner, std::uint32_t, CornerHash> vertices_;
    std::vector<glm::vec3> points_;
    std::vector<glm::uvec3> pieces_;
};

std::span<const ObjCorner> corners_of(const ObjFile& file, const ObjPolygon& polygon) {
    return std::span(file.corners).subspan(polygon.first_corner, polygon.corners);
}

/// One group at a time, so that only one mesh's table of vertices is in memory.
std::vector<Mesh> make_meshes(const ObjFile& file, const std::string& fallback_name) {
    std::vector<std::vector<std::uint32_t>> members(file.groups.size());
    for (std::uint32_t i = 0; i < file.polygons.size(); ++i) members[file.polygons[i].group].push_back(i);
    std::vector<Mesh> meshes;
    for (std::size_t group = 0; group < members.size(); ++group) {
        if (members[group].empty()) continue;
        MeshBuilder builder(file, file.groups[group].empty() ? fallback_name : file.groups[group]);
        for (const std::uint32_t i : members[group]) builder.plan(corners_of(file, file.polygons[i]));
        for (const std::uint32_t i : members[group])
            builder.add(corners_of(file, file.polygons[i]), file.polygons[i].material);
        meshes.push_back(builder.take());
    }
    return meshes;
}

/// Those that are finite, with the vertices that they use.
Strokes strokes_of(const ObjFile& file, const std::string& name) {
    Strokes strokes;
    strokes.name = name;
    std::unordered_map<int, std::uint32_t> numbers;
    const auto number = [&](int position) {
        const auto [found, is_new] = numbers.try_emplace(position, std::uint32_t(strokes.positions.size()));
        if (!is_new) return found->second;
        strokes.positions.push_back(file.positions[std::size_t(position)]);
        if (!file.colors.empty()) strokes.colors.emplace_back(file.colors[std::size_t(position)], 1.f);
        return found->second;
    };
    const auto finite = [&](int position) {
        const glm::vec3& p = file.positions[std::size_t(position)];
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    for (const ObjStroke& stroke : file.strokes) {
        if (!finite(stroke.a) || !finite(stroke.b)) continue;
        const std::uint32_t a = number(stroke.a), b = number(stroke.b);
        strokes.triangles.emplace_back(a, b, b);
        strokes.materials.push_back(stroke.material);
    }
    return strokes;
}

/// The materials that faces use, by name, and their images; their indices in the file become indices in the scene.
void make_materials(const ObjFile& file, const std::filesystem::path& path, Scene& scene, Warnings& warnings) {
    std::unordered_map<std::string, std::size_t> defined;
    for (std::size_t i = 0; i < file.mtl_materials.size(); ++i)
        if (!file.mtl_materials[i].name.empty()) defined.try_emplace(file.mtl_materials[i].name, i);

    constexpr std::uint32_t unused = 0xffffffffu;
    std::vector<std::uint32_t> index(file.material_names.size(), unused);
    MtlMaps maps(path, scene, warnings);
    const auto make = [&](const std::string& name) {
        const auto found = defined.find(name);
        if (found == defined.end()) {
            if (!name.empty() && !(file.lacks_mtl && file.mtl_materials.empty()))
                warnings.push_back("material '" + name + "' is not defined: it is shown in grey");
            return grey_lambert(name);
        }
        const tinyobj::material_t& mtl = file.mtl_materials[found->second];
        Material material = material_from_mtl(mtl, warnings);
        maps.add(material, mtl, file.mtl_folders[found->second]);
        return material;
    };
    for (Mesh& mesh : scene.meshes) {
        for (std::uint32_t& material : mesh.materials) {
            std::uint32_t& mapped = index[material];
            if (mapped == unused) {
                mapped = std::uint32_t(scene.materials.size());
                scene.materials.push_back(make(file.material_names[material]));
            }
            material = mapped;
        }
    }
    maps.scale_heights();
}

}  // namespace

Scene load_obj_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options) {
    Scene scene;
    scene.name = path.stem().string();
    const ObjFile file = read_obj(path, warnings);
    scene.meshes = make_meshes(file, scene.name);
    const bool has_strokes = !file.strokes.empty();
    if (has_strokes) scene.meshes.push_back(strokes_of(file, scene.name));  // to get its materials
    make_materials(file, path, scene, warnings);
    if (has_strokes) {
        const Strokes strokes = std::move(scene.meshes.back());
        scene.meshes.pop_back();
        if (!strokes.triangles.empty()) add_strokes(scene, {strokes}, options.stroke_radius, warnings);
    }
    if (file.degenerate_faces)
        warnings.push_back(std::to_string(file.degenerate_faces) + " faces with fewer than 3 vertices were left out");
    return scene;
}

}  // namespace claray
