#include "host/render/scene_buffers.hpp"

#include <algorithm>

#include "host/bsdf/material_data.hpp"
#include "host/lights/lights.hpp"

namespace claray {
namespace {

/// Those that some triangle has.
std::vector<Material> used_materials(const Scene& scene, const std::vector<std::uint32_t>& of_triangles) {
    std::vector<bool> used(scene.materials.size());
    for (const std::uint32_t material : of_triangles) used[material] = true;
    std::vector<Material> found;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) found.push_back(scene.materials[i]);
    return found;
}

std::vector<float> all_normals(const Scene& scene) {
    std::vector<float> normals;
    const bool any = std::any_of(scene.meshes.begin(), scene.meshes.end(), [](auto& m) { return !m.normals.empty(); });
    if (!any) return normals;
    for (const Mesh& mesh : scene.meshes) {
        for (const glm::vec3& n : mesh.normals) normals.insert(normals.end(), {n.x, n.y, n.z});
        if (mesh.normals.empty()) normals.resize(normals.size() + 3 * mesh.positions.size(), 0.f);
    }
    return normals;
}

std::vector<std::uint32_t> all_triangle_materials(const Scene& scene) {
    std::vector<std::uint32_t> materials;
    for (const Mesh& mesh : scene.meshes) {
        materials.insert(materials.end(), mesh.materials.begin(), mesh.materials.end());
        if (mesh.materials.empty()) materials.resize(materials.size() + mesh.triangles.size(), 0);
    }
    return materials;
}

}  // namespace

SceneBuffers::SceneBuffers(const Device& device, const Scene& scene, const Structure& with, EffectSet added)
    : structure(with), effects(effects_of(scene)) {
    const std::vector<float> vertex_normals = all_normals(scene);
    if (!vertex_normals.empty()) normals = Buffer<float>(device, vertex_normals);
    const std::vector<std::uint32_t> of_triangles = all_triangle_materials(scene);
    triangle_materials = Buffer<std::uint32_t>(device, of_triangles);

    std::vector<MaterialData> data;
    const EnergyTables tables(used_materials(scene, of_triangles));
    for (const Material& material : scene.materials) data.push_back(material_data(material, tables));
    materials = Buffer<MaterialData>(device, data);
    if (!tables.data().empty()) energy_tables = Buffer<float>(device, tables.data());

    textures = Textures(device, scene, !(added & EffectSet{Effect::cut_outs, Effect::culling}).empty());
    structure.set_cutouts(textures.cutouts());

    const Lights found = collect_lights(scene);
    triangle_lights = Buffer<TriangleLight>(device, found.triangles);
    punctual_lights = Buffer<PunctualLight>(device, found.punctual);
    light_tree = Buffer<LightNode>(device, found.tree);
    light_leaves = Buffer<LightLeaf>(device, found.leaves);
    light_trails = Buffer<LightTrail>(device, found.trails);
    if (!found.hot_spots.empty()) hot_spots = Buffer<HotSpot>(device, found.hot_spots);
    if (!found.lamps.empty()) lamps = Buffer<std::uint32_t>(device, found.lamps);
    environment_texels = Buffer<float>(device, found.environment_texels);
    environment_cdf = Buffer<float>(device, found.environment_cdf);
    lights = found.data;
}

void SceneBuffers::bind(Kernel& kernel, unsigned& index) const {
    kernel.set(index, structure.triangles().positions);
    kernel.set(index, structure.triangles().indices);
    kernel.set(index, normals);
    kernel.set(index, triangle_materials);
    kernel.set(index, materials);
    kernel.set(index, energy_tables);
    kernel.set(index, triangle_lights);
    kernel.set(index, punctual_lights);
    kernel.set(index, light_tree);
    kernel.set(index, light_leaves);
    kernel.set(index, light_trails);
    kernel.set(index, hot_spots);
    kernel.set(index, lamps);
    kernel.set(index, environment_texels);
    kernel.set(index, environment_cdf);
    kernel.set(index, textures.maps());
    structure.bind(kernel, index);
}

std::uint64_t SceneBuffers::bytes() const {
    return structure.triangles().positions.bytes() + structure.triangles().indices.bytes() + normals.bytes() +
           triangle_materials.bytes() + materials.bytes() + energy_tables.bytes() + triangle_lights.bytes() +
           punctual_lights.bytes() + light_tree.bytes() + light_leaves.bytes() + light_trails.bytes() +
           hot_spots.bytes() + lamps.bytes() + environment_texels.bytes() + environment_cdf.bytes() +
           textures.store.bytes();
}

}  // namespace claray
