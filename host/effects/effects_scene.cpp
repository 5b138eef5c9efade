// The simplest scene that needs a set of effects.
#include <algorithm>

#include "claray/effects.hpp"
#include "host/effects/effects.hpp"
#include "host/lights/lights.hpp"

namespace claray {
namespace {

Mesh unit_square(std::uint32_t material) {
    Mesh mesh;
    const float height = 0.1f * float(material);
    mesh.positions = {{-1, height, 1}, {1, height, 1}, {1, height, -1}, {-1, height, -1}};
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.materials = {material, material};
    return mesh;
}

Texture grey_texture(Filter filter) {
    Texture texture;
    texture.name = "grey";
    texture.width = texture.height = 2;
    texture.bytes.assign(16, 128);
    texture.filter = filter;
    return texture;
}

const TextureUse grey = {.texture = 0};

void add_layers(Material& m, EffectSet effects) {
    if (effects.has(Effect::specular)) m.specular_weight = 0.5f;
    if (effects.has(Effect::sheen)) m.sheen = glm::vec3(0.5f);
    if (effects.has(Effect::anisotropy)) m.anisotropy = 0.5f;
    if (effects.has(Effect::iridescence)) m.iridescence = 0.5f;
    if (effects.has(Effect::layered_coat)) m.clearcoat = 0.5f, m.normal_map = grey;
}

std::vector<Material> materials_for(EffectSet effects) {
    std::vector<Material> materials(1);
    const auto add = [&](EffectSet causes, MaterialKind kind) {
        if ((effects & causes).empty()) return;
        materials.emplace_back();
        materials.back().kind = kind;
        materials.back().roughness = effects.has(Effect::rough_glass) || kind == MaterialKind::oren_nayar ? 0.5f : 0.f;
        if (kind == MaterialKind::blinn_phong) materials.back().specular = glm::vec3(0.5f);  // else it is a Lambertian
    };
    const bool transmits = effects.has(Effect::transmission);
    const EffectSet in_glass = {Effect::rough_glass, Effect::absorption};
    add(transmits ? EffectSet{Effect::glass} : EffectSet{Effect::glass} | in_glass, MaterialKind::glass);
    if (effects.has(Effect::absorption))
        materials.back().attenuation = glm::vec3(0.5f), materials.back().attenuation_distance = 1.f;
    add({Effect::thin_walls}, MaterialKind::glass);
    if (effects.has(Effect::thin_walls)) materials.back().thin_walled = true;
    for (const MaterialKindRow& row : material_kinds) {
        // Lambert exists already; glass and principled are also needed by other effects and are added above and below.
        const auto others = {MaterialKind::lambert, MaterialKind::glass, MaterialKind::principled};
        if (std::find(others.begin(), others.end(), row.kind) == others.end()) add({effect_of(row.kind)}, row.kind);
    }
    add({Effect::coated_metal}, MaterialKind::principled);
    if (effects.has(Effect::coated_metal)) materials.back().clearcoat = materials.back().metallic = 0.5f;
    const EffectSet layers = {Effect::layered_coat, Effect::specular, Effect::sheen, Effect::anisotropy,
                              Effect::iridescence};
    add(layers, MaterialKind::principled);
    if (!(effects & layers).empty()) add_layers(materials.back(), effects);
    add({Effect::principled, Effect::transmission, Effect::clearcoat}, MaterialKind::principled);
    Material& last = materials.back();  // the principled one if there is one
    if (transmits) last.transmission = 0.5f;
    if (effects.has(Effect::clearcoat)) last.clearcoat = 0.5f;
    if (effects.has(Effect::absorption)) last.attenuation = glm::vec3(0.5f), last.attenuation_distance = 1.f;
    if (effects.has(Effect::culling)) last.cull_back = true;
    if (effects.has(Effect::cut_outs)) last.alpha_mode = AlphaMode::blend, last.opacity = 0.5f;
    if (effects.has(Effect::emissive_triangles)) last.emission = glm::vec3(1.f);
    if (!(effects & EffectSet{Effect::textures, Effect::mip_maps, Effect::nearest_levels}).empty())
        last.albedo_map = grey;
    if (effects.has(Effect::normal_maps)) last.normal_map = grey;
    if (effects.has(Effect::height_maps)) last.height_map = grey;
    if (effects.has(Effect::light_maps)) last.light_map = grey;
    if (effects.has(Effect::emission_maps)) {  // on a lamp of its own: those with holes are not sampled
        materials.emplace_back();
        materials.back().emission = glm::vec3(1.f), materials.back().emission_map = grey;
    }
    return materials;
}

/// A cube of glass around all squares.
void add_nested_media(Scene& scene) {
    Mesh cube;
    for (int corner = 0; corner < 8; ++corner)
        cube.positions.emplace_back(corner & 1 ? 2 : -2, corner & 2 ? 2 : -2, corner & 4 ? 2 : -2);
    cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    cube.materials.assign(cube.triangles.size(), std::uint32_t(scene.materials.size()));
    scene.materials.emplace_back().kind = MaterialKind::glass;
    scene.meshes.insert(scene.meshes.begin(), std::move(cube));
}

void add_light(Scene& scene, LightKind kind) {
    scene.lights.push_back({.name = {}, .kind = kind, .position = {0.f, 2.f, 0.f}});
}

/// Adds triangles of the last material, or else near lights, until a light tree is used; without lists only if there
/// are more lights than lists take.
void multiply_lights(Scene& scene, EffectSet effects) {
    Mesh& mesh = scene.meshes.back();
    if (effects.has(Effect::emissive_triangles)) {
        mesh.triangles.resize(LightSelection{}.for_a_tree, mesh.triangles[0]);
        mesh.materials.resize(LightSelection{}.for_a_tree, mesh.materials[0]);
        return;
    }
    Light light;
    for (const Light& other : scene.lights)
        if (!traits_of(other.kind)->far) light = other;
    const LightSelection selection;
    scene.lights.insert(
        scene.lights.end(),
        effects.has(Effect::light_lists) ? selection.for_a_tree : std::size_t(selection.most_per_cell) + 1, light);
}

}  // namespace

Scene scene_calling_for(EffectSet effects) {
    Scene scene;
    scene.materials = materials_for(effects);
    for (std::uint32_t i = 0; i < scene.materials.size(); ++i) scene.meshes.push_back(unit_square(i));
    if (effects.has(Effect::nested_media)) add_nested_media(scene);
    if (effects.has(Effect::smooth_normals))
        for (Mesh& mesh : scene.meshes) mesh.normals.assign(mesh.positions.size(), {0.f, 1.f, 0.f});
    if (effects.has(Effect::vertex_colors))
        for (Mesh& mesh : scene.meshes) mesh.colors.assign(mesh.positions.size(), glm::vec4(glm::vec3(0.5f), 1.f));
    const EffectSet textured = {Effect::textures,    Effect::mip_maps,      Effect::nearest_levels,
                                Effect::normal_maps, Effect::height_maps,   Effect::light_maps,
                                Effect::cut_outs,    Effect::emission_maps, Effect::layered_coat};
    if (!(effects & textured).empty())
        scene.textures = {grey_texture(effects.has(Effect::nearest_levels) ? Filter::nearest_level
                                       : effects.has(Effect::mip_maps)     ? Filter::trilinear
                                                                           : Filter::bilinear)};
#define CLARAY_ROW(name, NAME, text, far, cone) \
    if (effects.has(Effect::name##_lights)) add_light(scene, LightKind::name);
    CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
    if (effects.has(Effect::hot_spots)) {
        add_light(scene, LightKind::point);
        scene.lights.back().position.y = 0.01f;
    }
    if (!(effects & EffectSet{Effect::light_falloff, Effect::linear_ranges}).empty()) {
        if (std::all_of(scene.lights.begin(), scene.lights.end(),
                        [](const Light& light) { return traits_of(light.kind)->far; }))
            add_light(scene, LightKind::point);
        for (Light& light : scene.lights) light.range = 10.f, light.linear_range = effects.has(Effect::linear_ranges);
    }
    if (effects.has(Effect::light_lists))
        for (int i = 0; i < 2; ++i) add_light(scene, LightKind::point);
    if (effects.has(Effect::many_lights)) multiply_lights(scene, effects);
    if (effects.has(Effect::sky)) scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    if (effects.has(Effect::environment)) scene.environment.images = {grey_texture(Filter::bilinear)};
    Camera camera{{0.f, 3.f, 3.f}, {0.f, 0.f, 0.f}, {0.f, 1.f, 0.f}, 60.f};
    if (effects.has(Effect::depth_of_field)) camera.aperture_radius = 0.01f;
    if (effects.has(Effect::camera_motion)) camera.position_end = glm::vec3(0.f, 3.f, 3.1f);
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch) \
    if (effects.has(Effect::name)) camera.projection = Projection::name;
    CLARAY_OTHER_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
    scene.camera = camera;
    if (!(effects & EffectSet{Effect::instances, Effect::instance_motion}).empty())
        for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
            // Twice, or it would be baked into the world.
            scene.instances.push_back({.mesh = i});
            MeshInstance& second = scene.instances.emplace_back(MeshInstance{.mesh = i});
            second.transform[3].x = 3.f;
            if (effects.has(Effect::instance_motion)) second.transform_end = glm::mat4(1.f);
        }
    if (effects.has(Effect::primitives)) {
        PrimitiveSet& ball = scene.primitives.emplace_back();
        ball.points = {{0.f, 0.5f, 0.f, 0.25f}}, ball.materials = {std::uint32_t(scene.materials.size())};
        scene.materials.emplace_back();  // without maps
    }
    return scene;
}

}  // namespace claray
