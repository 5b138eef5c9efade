#include "host/render/scene_buffers.hpp"

#include <algorithm>
#include <cstring>

#include "host/bsdf/material_data.hpp"
#include "host/lights/lights.hpp"
#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

/// The materials that some triangle uses.
std::vector<Material> materials_in_use(const Scene& scene) {
    const std::vector<bool> used = used_materials(scene);
    std::vector<Material> found;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) found.push_back(scene.materials[i]);
    return found;
}

std::vector<glm::vec3> all_normals(const Scene& scene) {
    const bool any = std::any_of(scene.meshes.begin(), scene.meshes.end(), [](auto& m) { return !m.normals.empty(); });
    return any ? of_all_meshes(scene, &Mesh::normals) : std::vector<glm::vec3>();
}

std::vector<std::uint32_t> all_triangle_materials(const Scene& scene) {
    std::vector<std::uint32_t> materials;
    for (const Mesh& mesh : scene.meshes) {
        materials.insert(materials.end(), mesh.materials.begin(), mesh.materials.end());
        if (mesh.materials.empty()) materials.resize(materials.size() + mesh.triangles.size(), 0);
    }
    return materials;
}

/// Collects tables one after the other, each aligned for vectors.
class TableWriter {
public:
    /// Returns its offset.
    template <class T>
    std::uint32_t add(const std::vector<T>& table) {
        static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
        if (table.empty()) return CLARAY_NO_TABLE;
        const std::size_t begin = (words_.size() + alignment - 1) / alignment * alignment;
        if (begin >= CLARAY_NO_TABLE) throw Error(ErrorKind::user, "the scene's tables are larger than 16 GB");
        words_.resize(begin + table.size() * sizeof(T) / sizeof(std::uint32_t));
        std::memcpy(&words_[begin], table.data(), table.size() * sizeof(T));
        return std::uint32_t(begin);
    }
    [[nodiscard]] const std::vector<std::uint32_t>& words() const { return words_; }

private:
    static constexpr std::size_t alignment = 32;
    std::vector<std::uint32_t> words_;
};

}  // namespace

SceneBuffers::SceneBuffers(const Device& device, const Scene& scene, const Structure& with, EffectSet added)
    : structure(with), effects(effects_of(scene)) {
    const std::vector<std::uint32_t> of_triangles = all_triangle_materials(scene);
    const EnergyTables energy(materials_in_use(scene));
    std::vector<MaterialData> materials;
    for (const Material& material : scene.materials) materials.push_back(material_data(material, energy));

    textures = Textures(device, scene, !(added & EffectSet{Effect::cut_outs, Effect::culling}).empty());
    structure.set_cutouts(textures.cutouts());

    const Lights found = collect_lights(scene);
    lights = found.data;
    TableWriter writer;
    where = {.normals = writer.add(all_normals(scene)),
             .triangle_materials = writer.add(of_triangles),
             .materials = writer.add(materials),
             .energy = writer.add(energy.data()),
             .triangle_lights = writer.add(found.triangles),
             .punctual_lights = writer.add(found.punctual),
             .light_tree = writer.add(found.tree),
             .light_leaves = writer.add(found.leaves),
             .light_trails = writer.add(found.trails),
             .hot_spots = writer.add(found.hot_spots),
             .lamps = writer.add(found.lamps),
             .environment_texels = writer.add(found.environment_texels),
             .environment_cdf = writer.add(found.environment_cdf)};
    tables = Buffer<std::uint32_t>(device, writer.words());
}

void SceneBuffers::bind(Kernel& kernel, unsigned& index) const {
    kernel.set(index, arg("positions", structure.triangles().positions));
    kernel.set(index, arg("indices", structure.triangles().indices));
    kernel.set(index, arg("tables", tables));
    kernel.set(index, arg("textures", textures.maps()));
    structure.bind(kernel, index);
}

std::uint64_t SceneBuffers::bytes() const {
    return structure.triangles().positions.bytes() + structure.triangles().indices.bytes() + tables.bytes() +
           textures.store.bytes();
}

}  // namespace claray
