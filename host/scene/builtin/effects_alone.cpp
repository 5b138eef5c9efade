// One scene per effect. It uses the effect, Lambert, one kind of light, and what the effect itself needs.
#include <algorithm>
#include <array>
#include <string_view>

#include "claray/error.hpp"
#include "host/scene/builtin/builtin.hpp"
#include "host/scene/builtin/effects_stage.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

Material& ball(Scene& scene) { return scene.materials[ball_material]; }

void set_kind(Scene& scene, MaterialKind kind, const glm::vec3& albedo, float roughness) {
    ball(scene).kind = kind, ball(scene).albedo = albedo, ball(scene).roughness = roughness;
}

void make_principled(Scene& scene) { set_kind(scene, MaterialKind::principled, {0.7f, 0.25f, 0.12f}, 0.35f); }

void make_glass(Scene& scene) { set_kind(scene, MaterialKind::glass, glm::vec3(0.98f), 0.f); }

Light& replace_sky_by(Scene& scene, LightKind kind) {
    scene.sky = {};
    Light light = point_light({-1.8f, 3.f, 2.2f}, glm::vec3(24.f, 22.f, 19.f));
    light.kind = kind;
    scene.lights = {light};
    return scene.lights[0];
}

/// A light of the kind over the ball.
template <LightKind kind>
void make_light(Scene& scene) {
    Light& light = replace_sky_by(scene, kind);
    constexpr LightTraits traits = *traits_of(kind);
    if (traits.far) {
        light.direction = {0.6f, -1.f, -0.5f}, light.intensity = glm::vec3(3.f, 2.8f, 2.4f);
    } else if (traits.cone) {
        light.direction = glm::vec3(0.1f, 0.4f, 0.1f) - light.position;
        light.intensity *= 2.f;
    }
    if (traits.cone) light.inner_angle = 0.15f, light.outer_angle = 0.33f;
}

/// With a sun that coats reflect.
void replace_sky_by_evening(Scene& scene) { scene.sky = {}, scene.environment.images = {evening_environment()}; }

void move(Mesh& mesh, const glm::vec3& offset) {
    for (glm::vec3& p : mesh.positions) p += offset;
}

/// Rows of small balls, all the same mesh.
void make_instances(Scene& scene) {
    scene.meshes = {scene.meshes[0], textured_ball({0, 0, 0}, 1.f, 3, ball_material)};
    scene.meshes[1].normals.clear();
    scene.instances = {MeshInstance{}};
    for (int i = 0; i < 25; ++i) {
        MeshInstance instance;
        instance.mesh = 1;
        const float size = 0.16f + 0.012f * float(i % 7);
        instance.transform = glm::mat4(size);
        instance.transform[3] = {0.6f * float(i % 5) - 1.1f, size, 0.6f * float(i / 5) - 1.3f, 1.f};
        scene.instances.push_back(instance);
    }
}

void make_instance_move(Scene& scene) {
    scene.instances.resize(scene.meshes.size());
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) scene.instances[i].mesh = i;
    glm::mat4 end(1.f);
    end[3] = {-0.45f, 0.35f, 0.f, 1.f};
    scene.instances[ball_material].transform_end = end;
}

/// A nest of curves with eggs, in the ball's place, on a disc.
void make_primitives(Scene& scene) {
    scene.meshes.erase(scene.meshes.begin() + ball_material);
    scene.camera->target.y -= 0.2f;
    add_nest(scene, {-0.35f, 0.f, 0.f}, 0.8f, ball_material, block_material);
}

/// `side` rows of as many small lights of many colours above the floor, none of them close to the ball or the block.
template <int side>
void make_rows_of_lights(Scene& scene) {
    Bounds block;
    for (const glm::vec3& p : scene.meshes[block_material].positions) block.grow(p - 0.25f), block.grow(p + 0.25f);
    const auto within = [](const glm::vec3& at, const Bounds& box) {
        return glm::all(glm::lessThan(box.lo, at)) && glm::all(glm::lessThan(at, box.hi));
    };
    scene.sky = {};
    for (int i = 0; i < side * side; ++i) {
        const glm::vec3 color(float(1 + i % 3), float(1 + i % 4), float(1 + i % 5));
        const glm::vec2 share = glm::vec2(i % side, i / side) / float(side - 1);
        const glm::vec3 at(4.5f * share.x - 2.2f, 0.25f, 4.5f * share.y - 2.6f);
        if (glm::length(at - glm::vec3(-0.35f, 0.8f, 0.f)) > 1.1f && !within(at, block))
            scene.lights.push_back(point_light(at, 2.4f / (side * side) * color));
    }
}

void make_light_map(Scene& scene) { scene.materials[floor_material].light_map = add_texture(scene, pool_of_light()); }

struct Alone {
    std::string_view name;
    void (*change)(Scene&);
};
constexpr std::array alone = {
    Alone{"smooth-normals",
          [](Scene& s) {
              // So coarse that its outline is visibly not round.
              s.meshes[ball_material] = textured_ball({-0.35f, 0.8f, 0.f}, 0.8f, 2, ball_material);
          }},
    Alone{"lambert", [](Scene&) {}},
    Alone{"mirror", [](Scene& s) { set_kind(s, MaterialKind::mirror, glm::vec3(0.9f), 0.f); }},
    Alone{"glass", make_glass},
    Alone{"metal",
          [](Scene& s) {
              set_kind(s, MaterialKind::metal, {1.f, 0.71f, 0.29f}, 0.3f);
          }},
    Alone{"blinn-phong",
          [](Scene& s) {
              replace_sky_by(s, LightKind::point);
              set_kind(s, MaterialKind::blinn_phong, {0.5f, 0.08f, 0.06f}, 0.f);
              ball(s).specular = glm::vec3(0.3f), ball(s).shininess = 60.f;
          }},
    Alone{"principled", make_principled},
    Alone{"transmission", [](Scene& s) { make_principled(s), ball(s).transmission = 0.9f, ball(s).roughness = 0.f; }},
    Alone{"thin-walls",
          [](Scene& s) {
              make_glass(s), ball(s).thin_walled = true, ball(s).albedo = {0.5f, 0.8f, 0.9f};
          }},
    Alone{"rough-glass", [](Scene& s) { make_glass(s), ball(s).roughness = 0.4f; }},
    Alone{"coated-metal",
          [](Scene& s) {
              set_kind(s, MaterialKind::principled, {0.9f, 0.25f, 0.12f}, 0.5f);
              ball(s).metallic = ball(s).clearcoat = 1.f;
              replace_sky_by_evening(s);
          }},
    Alone{"clearcoat",
          [](Scene& s) {
              make_principled(s), ball(s).clearcoat = 1.f, ball(s).roughness = 0.7f;
              replace_sky_by_evening(s);
          }},
    Alone{"layered-coat",
          [](Scene& s) {
              make_principled(s), ball(s).clearcoat = 1.f, ball(s).roughness = 0.7f;
              ball(s).normal_map = add_texture(s, ripples_as_normals());
              replace_sky_by_evening(s);
          }},
    Alone{"specular",
          [](Scene& s) {
              make_principled(s), ball(s).albedo = glm::vec3(0.02f);
              ball(s).specular_tint = {20.f, 12.f, 4.f};
          }},
    Alone{"iridescence",
          [](Scene& s) {
              make_principled(s), ball(s).albedo = glm::vec3(0.02f), ball(s).roughness = 0.1f;
              ball(s).iridescence = 1.f, ball(s).iridescence_ior = 2.f, ball(s).film_thickness.y = 380.f;
          }},
    Alone{"anisotropy",
          [](Scene& s) {
              set_kind(s, MaterialKind::principled, {1.f, 0.71f, 0.29f}, 0.3f);
              ball(s).metallic = 1.f, ball(s).anisotropy = 0.9f;
              replace_sky_by(s, LightKind::point);
          }},
    Alone{"sheen",
          [](Scene& s) {
              make_principled(s), ball(s).albedo = {0.2f, 0.02f, 0.05f}, ball(s).roughness = 1.f;
              ball(s).sheen = {1.f, 0.6f, 0.7f}, ball(s).sheen_roughness = 0.4f;
          }},
    Alone{"unlit",
          [](Scene& s) {
              set_kind(s, MaterialKind::unlit, {0.1f, 0.45f, 0.6f}, 0.f);
          }},
    Alone{"absorption",
          [](Scene& s) {
              make_glass(s);
              ball(s).attenuation = {0.2f, 0.7f, 0.5f}, ball(s).attenuation_distance = 0.6f;
          }},
    Alone{"nested-media",
          [](Scene& s) {
              make_glass(s);
              s.meshes.push_back(textured_ball({-0.35f, 0.8f, 0.f}, 0.4f, 3, block_material));
          }},
    Alone{
        "culling",
        [](Scene& s) {
            s.meshes[ball_material] = open_bowl({-0.35f, 0.8f, 0.f}, 0.8f, ball_material);
            s.meshes[ball_material].normals.clear();
            s.meshes.push_back(textured_ball({-0.35f, 0.5f, 0.1f}, 0.35f, 3, block_material));  // seen through its wall
            s.meshes.back().normals.clear();
            ball(s).cull_back = true;
        }},
    Alone{"emissive-triangles",
          [](Scene& s) {
              s.sky = {};
              s.materials.push_back(lamp("lamp", {15.f, 13.f, 10.f}));
              s.meshes.push_back(make_lamp({-1.8f, 3.f, 2.2f}, {0.f, 0.5f, 0.f}, 0.6f, stage_materials));
          }},
#define CLARAY_ROW(name, NAME, text, far, cone) Alone{text "-lights", make_light<LightKind::name>},
    CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
        Alone{"light-falloff",
              [](Scene& s) {
                  Light& light = replace_sky_by(s, LightKind::point);
                  light.attenuation = {1.f, 0.2f, 0.f}, light.intensity = glm::vec3(6.f), light.range = 4.5f;
              }},
    Alone{"linear-ranges",
          [](Scene& s) {
              Light& light = replace_sky_by(s, LightKind::point);
              light.attenuation = {1.f, 0.f, 0.f}, light.intensity = glm::vec3(6.f), light.range = 4.5f;
              light.linear_range = true;
          }},
    Alone{"light-lists", make_rows_of_lights<4>},
    Alone{"many-lights", make_rows_of_lights<15>},
    Alone{"hot-spots",
          [](Scene& s) {
              s.sky = {};
              s.lights = {point_light({0.75f, 0.04f, 1.f}, {3.f, 2.5f, 2.f})};
          }},
    Alone{"sky", [](Scene&) {}},
    Alone{"environment", replace_sky_by_evening},
    Alone{"vertex-colors",
          [](Scene& s) {
              ball(s).albedo = glm::vec3(0.8f);
              paint(s.meshes[ball_material]);
          }},
    Alone{"textures", [](Scene& s) { s.materials[floor_material].albedo_map = add_texture(s, checks()); }},
    Alone{"mip-maps",
          [](Scene& s) {
              TextureUse& use = s.materials[floor_material].albedo_map;
              use = add_texture(s, checks(), Filter::trilinear);
              use.scale = glm::vec2(12.f);
          }},
    Alone{"nearest-levels",
          [](Scene& s) {
              TextureUse& use = s.materials[floor_material].albedo_map;
              use = add_texture(s, checks(), Filter::nearest_level);
              use.scale = glm::vec2(12.f);
          }},
    Alone{"normal-maps", [](Scene& s) { ball(s).normal_map = add_texture(s, ripples_as_normals()); }},
    Alone{"height-maps",
          [](Scene& s) {
              s.materials[floor_material].height_map = add_texture(s, noise_as_height());
              s.materials[floor_material].height_scale = 0.4f;
          }},
    Alone{"light-maps", make_light_map},
    Alone{"emission-maps",
          [](Scene& s) {
              s.sky = {};
              s.meshes.push_back(
                  textured_rectangle({-0.2f, 1.3f, -2.f}, {1.4f, 0.f, 0.f}, {0.f, 0.8f, 0.f}, stage_materials));
              s.materials.push_back(lamp("screen", {9.f, 8.f, 7.f}));
              s.materials.back().emission_map = add_texture(s, checks());
          }},
    Alone{"cut-outs",
          [](Scene& s) {
              s.materials[block_material].opacity_map = add_texture(s, disc_opacity());
              s.materials[block_material].alpha_mode = AlphaMode::mask;
              s.meshes[block_material] =
                  textured_rectangle({1.05f, 0.7f, 0.5f}, {0.6f, 0.f, 0.15f}, {0.f, 0.7f, 0.f}, block_material);
          }},
    Alone{"depth-of-field",
          [](Scene& s) {
              move(s.meshes[ball_material], {-0.2f, 0.f, -2.f});
              move(s.meshes[block_material], {-0.6f, 0.f, 0.9f});
              s.camera->aperture_radius = 0.1f, s.camera->focus_distance = 3.4f;
          }},
    Alone{"camera-motion",
          [](Scene& s) {
              s.camera->position_end = s.camera->position + glm::vec3(0.25f, 0.f, 0.f);
              s.camera->target_end = s.camera->target + glm::vec3(0.25f, 0.f, 0.f);
          }},
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch) \
    Alone{text, [](Scene& s) { s.camera->projection = Projection::name, s.camera->orthographic_height = 3.2f; }},
    CLARAY_OTHER_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
        Alone{"instances", make_instances},
    Alone{"instance-motion", make_instance_move},
    Alone{"primitives", make_primitives},
};

bool has_own_scene(const MaterialKindRow& row) {
    return std::any_of(alone.begin(), alone.end(), [&](const Alone& one) { return one.name == row.name; });
}

}  // namespace

Scene effect_alone(const std::string& name) {
    std::string known;
    const auto is = [&](const std::string_view& other) {
        known += (known.empty() ? "" : ", ") + std::string(other);
        return name == other;
    };
    Scene scene = empty_stage();
    scene.sky = {{0.95f, 0.93f, 0.9f}, {0.35f, 0.5f, 0.8f}};
    for (const Alone& one : alone) {
        if (!is(one.name)) continue;
        one.change(scene);
        return scene;
    }
    for (const MaterialKindRow& row : material_kinds) {  // kinds without a designed scene: the ball is of that kind
        if (has_own_scene(row) || !is(row.name)) continue;
        set_kind(scene, row.kind, {0.7f, 0.25f, 0.12f}, 0.35f);
        return scene;
    }
    throw Error(ErrorKind::usage, "scene 'effect:NAME': NAME is '" + name + "'", "give one of: " + known);
}

}  // namespace claray::scenes
