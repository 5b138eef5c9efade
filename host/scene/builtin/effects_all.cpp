// One scene that uses every effect at once, except the sky, which an environment replaces, and primitives, without
// which it starts quickly.
#include <algorithm>

#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/effects_stage.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

/// Adds a mesh with a material of its own.
Material& add_part(Scene& scene, const Material& material, Mesh mesh) {
    mesh.materials.assign(mesh.triangles.size(), std::uint32_t(scene.materials.size()));
    scene.meshes.push_back(std::move(mesh));
    scene.materials.push_back(material);
    return scene.materials.back();
}

/// A ball on the floor, which rests at x, z.
Material& add_ball(Scene& scene, const Material& material, float x, float z, float radius = 0.36f) {
    Mesh ball = textured_ball({x, radius, z}, radius, 4, 0);
    ball.name = material.name;
    return add_part(scene, material, std::move(ball));
}

Material principled(const char* name, const glm::vec3& color, float roughness) {
    Material material = lambert(name, color);
    material.kind = MaterialKind::principled, material.roughness = roughness;
    return material;
}

void add_balls(Scene& scene) {
    add_ball(scene, mirror("mirror", glm::vec3(0.9f)), -1.5f, -0.9f, 0.5f);
    add_ball(scene, metal("metal", {1.f, 0.71f, 0.29f}, 0.35f), -0.35f, -1.1f, 0.45f);
    Material& absorbing = add_ball(scene, glass("absorbing glass", glm::vec3(0.98f), 1.5f), 0.55f, 0.75f);
    absorbing.attenuation = {0.15f, 0.7f, 0.5f}, absorbing.attenuation_distance = 0.4f;
    add_part(scene, lambert("enclosed", {0.7f, 0.6f, 0.2f}), textured_ball({0.55f, 0.36f, 0.75f}, 0.15f, 3, 0));
    Material& phong = add_ball(scene, lambert("Blinn-Phong", {0.5f, 0.1f, 0.08f}), -1.25f, 0.45f);
    phong.kind = MaterialKind::blinn_phong, phong.specular = glm::vec3(0.3f), phong.shininess = 60.f;
    Material& coated = add_ball(scene, principled("coated", {0.1f, 0.25f, 0.6f}, 0.6f), -0.4f, 0.25f);
    coated.metallic = coated.clearcoat = 1.f;
    add_ball(scene, principled("transmitting", {0.95f, 0.8f, 0.5f}, 0.15f), 1.35f, 0.55f).transmission = 0.9f;
    add_ball(scene, glass("thin-walled", {0.6f, 0.9f, 0.8f}, 1.5f), 1.9f, 0.1f, 0.25f).thin_walled = true;
    add_ball(scene, lambert("rippled", glm::vec3(0.6f)), 0.6f, -0.9f, 0.4f).normal_map =
        add_texture(scene, ripples_as_normals());
    paint(scene.meshes.back());
    Material& cloth = add_ball(scene, principled("cloth", {0.2f, 0.02f, 0.05f}, 1.f), 0.05f, 0.95f, 0.2f);
    cloth.sheen = {1.f, 0.6f, 0.7f}, cloth.sheen_roughness = 0.4f, cloth.specular_weight = 0.3f;
    Material& brushed = add_ball(scene, principled("brushed", {1.f, 0.71f, 0.29f}, 0.3f), 1.1f, 1.1f, 0.2f);
    brushed.metallic = 1.f, brushed.anisotropy = 0.9f;
    Material& film = add_ball(scene, principled("film", glm::vec3(0.02f), 0.1f), -0.75f, 0.95f, 0.2f);
    film.iridescence = film.clearcoat = 1.f, film.iridescence_ior = 2.f, film.film_thickness.y = 380.f;
    Material& shown = add_ball(scene, lambert("unlit", {0.1f, 0.45f, 0.6f}), 1.75f, 0.95f, 0.15f);
    shown.kind = MaterialKind::unlit;
    add_part(scene, lambert("bowl", {0.3f, 0.55f, 0.3f}), open_bowl({1.5f, 0.4f, -0.8f}, 0.4f, 0)).cull_back = true;
}

/// A row of small balls at the front, one for each kind without another ball.
void add_other_kinds(Scene& scene) {
    float x = -1.9f;
    for (const MaterialKindRow& row : material_kinds) {
        const auto is_of_kind = [&](const Material& m) { return m.kind == row.kind; };
        if (std::any_of(scene.materials.begin(), scene.materials.end(), is_of_kind)) continue;
        Material material = principled(row.name, {0.7f, 0.25f, 0.12f}, 0.35f);
        material.kind = row.kind;
        add_ball(scene, material, x, 1.4f, 0.15f);
        x += 0.4f;
    }
}

void add_rectangles(Scene& scene) {
    Material& wall = add_part(scene, lambert("rough wall", {0.6f, 0.55f, 0.5f}),
                              textured_rectangle({0.f, 1.1f, -2.2f}, {2.6f, 0.f, 0.f}, {0.f, 1.1f, 0.f}, 0));
    wall.height_map = add_texture(scene, noise_as_height());
    wall.height_scale = 0.4f;
    add_part(scene, lambert("baked", glm::vec3(0.6f)),
             textured_rectangle({2.2f, 0.9f, -0.4f}, {0.35f, 0.f, -0.6f}, {0.f, 0.5f, 0.f}, 0))
        .light_map = add_texture(scene, pool_of_light());
    Material& ring = add_part(scene, lambert("ring", {0.6f, 0.45f, 0.1f}),
                              textured_rectangle({-2.1f, 0.6f, 0.1f}, {0.4f, 0.f, 0.45f}, {0.f, 0.6f, 0.f}, 0));
    ring.opacity_map = add_texture(scene, disc_opacity());
    ring.alpha_mode = AlphaMode::mask;
}

void add_lights(Scene& scene) {
    add_part(scene, lamp("lamp", {14.f, 12.f, 9.f}), make_lamp({-2.4f, 2.8f, 1.f}, {0.f, 0.3f, 0.f}, 0.3f, 0));
    add_part(scene, lamp("screen", {2.f, 3.f, 5.f}),
             textured_rectangle({-0.9f, 1.5f, -2.1f}, {0.3f, 0.f, 0.f}, {0.f, 0.2f, 0.f}, 0))
        .emission_map = add_texture(scene, checks(), Filter::nearest_level);
    Light light = point_light({2.4f, 1.9f, 1.4f}, {3.f, 2.f, 1.4f});
    scene.lights.push_back(light);
    for (int i = 0; i < 20; ++i) {  // a chain of small lights along the wall, each with a short range
        Light small = point_light({0.25f * float(i) - 2.4f, 0.08f, -1.9f}, {0.02f, 0.012f, 0.006f});
        small.range = 2.f, small.linear_range = i == 19;
        scene.lights.push_back(small);
    }
    scene.lights.push_back(point_light({1.9f, 0.03f, 1.7f}, {0.3f, 0.4f, 0.5f}));  // on the floor
    light.kind = LightKind::spot, light.position = {0.f, 3.5f, 1.f}, light.direction = {0.f, -1.f, -0.45f};
    light.intensity = {8.f, 9.f, 12.f}, light.inner_angle = 0.2f, light.outer_angle = 0.4f;
    scene.lights.push_back(light);
    light.kind = LightKind::directional, light.direction = {-0.4f, -1.f, -0.7f};
    light.intensity = {0.5f, 0.45f, 0.4f};
    scene.lights.push_back(light);
    for (const LightTraits& traits : light_kinds) {  // a faint light of each kind, wide enough to be hit
        if (!traits.seen) continue;
        light.kind = traits.kind, light.intensity = glm::vec3(0.05f), light.inner_angle = 0.f, light.outer_angle = 0.3f;
        scene.lights.push_back(light);
    }
    scene.environment.images = {evening_environment()};
    scene.environment.strength = 0.5f;
}

/// An instance for each mesh; the last ball of `add_balls` without a role for others moves.
void add_instances(Scene& scene) {
    for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
        MeshInstance instance;
        instance.mesh = i;
        if (scene.meshes[i].name == "metal") {
            instance.transform_end = glm::mat4(1.f);
            (*instance.transform_end)[3] = {0.f, 0.25f, 0.f, 1.f};
        }
        scene.instances.push_back(instance);
    }
}

}  // namespace

Scene effects() {
    Scene scene = empty_stage();
    scene.meshes.resize(1);  // the floor
    TextureUse& floor = scene.materials[floor_material].albedo_map;
    floor = add_texture(scene, checks(), Filter::trilinear);
    floor.scale = glm::vec2(3.f);
    add_balls(scene);
    add_other_kinds(scene);
    add_rectangles(scene);
    add_lights(scene);
    add_instances(scene);
    Camera camera{{0.3f, 2.f, 4.8f}, {0.f, 0.55f, -0.2f}, {0.f, 1.f, 0.f}, 40.f};
    camera.aperture_radius = 0.03f;
    camera.position_end = camera.position + glm::vec3(0.01f, 0.f, 0.f);
    scene.camera = camera;
    return scene;
}

}  // namespace claray::scenes
