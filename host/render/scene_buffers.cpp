#include "host/render/scene_buffers.hpp"

#include <algorithm>

#include "host/render/lights.hpp"

namespace claray {
namespace {

MaterialData data_of(const Material& m) {
    return {m.albedo.x,   m.albedo.y,  m.albedo.z, std::uint32_t(m.kind), m.emission.x, m.emission.y,
            m.emission.z, m.roughness, m.ior,      sampled_emission(m)};
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

SceneBuffers::SceneBuffers(const Device& device, const Scene& scene, const Structure& with)
    : structure(with), effects(effects_of(scene)) {
    const std::vector<float> vertex_normals = all_normals(scene);
    if (!vertex_normals.empty()) normals = Buffer<float>(device, vertex_normals);
    const std::vector<std::uint32_t> of_triangles = all_triangle_materials(scene);
    triangle_materials = Buffer<std::uint32_t>(device, of_triangles);

    std::vector<MaterialData> data;
    for (const Material& material : scene.materials) data.push_back(data_of(material));
    materials = Buffer<MaterialData>(device, data);

    textures = Textures(device, scene);

    const Lights found = collect_lights(scene);
    triangle_lights = Buffer<TriangleLight>(device, found.triangles);
    punctual_lights = Buffer<PunctualLight>(device, found.punctual);
    light_tree = Buffer<LightNode>(device, found.tree);
    light_trails = Buffer<LightTrail>(device, found.trails);
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
    kernel.set(index, triangle_lights);
    kernel.set(index, punctual_lights);
    kernel.set(index, light_tree);
    kernel.set(index, light_trails);
    kernel.set(index, environment_texels);
    kernel.set(index, environment_cdf);
    kernel.set(index, textures.store);
    structure.bind(kernel, index);
}

std::uint64_t SceneBuffers::bytes() const {
    return structure.triangles().positions.bytes() + structure.triangles().indices.bytes() + normals.bytes() +
           triangle_materials.bytes() + materials.bytes() + triangle_lights.bytes() + punctual_lights.bytes() +
           light_tree.bytes() + light_trails.bytes() + environment_texels.bytes() + environment_cdf.bytes() +
           textures.store.bytes();
}

}  // namespace claray
