// What a scene calls for is derived from it, and what it does not call for costs and changes nothing.
#include "claray/effects.hpp"

#include <gtest/gtest.h>

#include "host/effects/effects.hpp"
#include "host/effects/parts/part.hpp"
#include "tests/render/scenes.hpp"
#include "tests/render/textures/textures.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

/// A diffuse square in the dark.
Scene plain_scene() {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.camera = narrow_camera({0, 3, 3}, {0, 0, 0});
    return scene;
}

/// A scene with one reason for each effect that the kernels know.
std::vector<std::pair<Effect, Scene>> scenes_by_effect() {
    std::vector<std::pair<Effect, Scene>> scenes;
    for (const Effect effect : all_effects())
        scenes.emplace_back(effect, *builtin_scene(std::string("effect:") + name_of(effect)));
    return scenes;
}

TEST(Effects, AreDerivedFromTheScene) {
    EXPECT_EQ(effects_of(plain_scene()), EffectSet{Effect::lambert});
    EXPECT_EQ(effects_of(Scene()), EffectSet());
    for (const auto& [effect, scene] : scenes_by_effect())
        EXPECT_TRUE(effects_of(scene).has(effect)) << name_of(effect) << ": " << to_string(effects_of(scene));
    Scene idle = plain_scene();
    idle.materials.push_back(material(MaterialKind::glass, 1.f));  // on no triangle
    idle.lights = {point_light({0, 1, 0}, {0, 0, 0})};             // black
    EXPECT_EQ(effects_of(idle), EffectSet{Effect::lambert});
}

TEST(Effects, SayWhoCallsForThem) {
    Scene scene = plain_scene();
    scene.materials[0].name = "paint";
    scene.lights = {point_light({0, 1, 0}, {1, 1, 1}), point_light({0, 2, 0}, {1, 1, 1})};
    const std::vector<EffectCause> causes = causes_of_effects(scene);
    ASSERT_EQ(causes.size(), 3u);
    EXPECT_EQ(causes[0].effect, Effect::lambert);
    EXPECT_EQ(causes[0].first, "the material 'paint'");
    EXPECT_EQ(causes[0].count, 1u);
    EXPECT_EQ(causes[1].effect, Effect::point_lights);
    EXPECT_EQ(causes[1].first, "the light 0");
    EXPECT_EQ(causes[1].count, 2u);
    EXPECT_EQ(causes[2].effect, Effect::light_lists);
}

TEST(Effects, CausesAreTheSet) {
    for (const char* name : {"cornell", "spheres", "hills", "crate"}) {
        const Scene scene = *builtin_scene(name);
        EffectSet named;
        for (const EffectCause& cause : causes_of_effects(scene)) named.add(cause.effect);
        EXPECT_EQ(named, effects_of(scene)) << name;
    }
}

TEST(Effects, StrippedScenesDoNotCallForThem) {
    for (const auto& [effect, scene] : scenes_by_effect()) {
        if (effect == Effect::lambert) continue;  // other materials turn into it
        if (effects_with(CLARAY_AID).has(effect)) continue;
        const EffectSet left = effects_of(without_effects(scene, {effect}));
        EXPECT_FALSE(left.has(effect)) << name_of(effect);
        EXPECT_TRUE((effects_of(scene) | EffectSet{Effect::lambert}).contains(left)) << name_of(effect);
    }
}

TEST(Effects, SetsHaveRoomForMoreThanAWord) {
    const Effect last = Effect(EffectSet::most - 1), same_bit = Effect(EffectSet::most - 1 - 64);
    EffectSet set = {last};
    EXPECT_TRUE(set.has(last));
    EXPECT_FALSE(set.has(same_bit));
    EXPECT_FALSE(set.empty());
    EXPECT_NE(set, EffectSet{same_bit});
    EXPECT_TRUE((set & EffectSet{same_bit}).empty());
    EXPECT_EQ((set | EffectSet{same_bit}) - set, EffectSet{same_bit});
    EXPECT_FALSE((EffectSet{same_bit}).contains(set));
    set.remove(last);
    EXPECT_TRUE(set.empty());
}

TEST(Effects, TellWhatSixteenRaysAtOnceKnow) {
    const EffectSet diffuse = {Effect::lambert, Effect::emissive_triangles, Effect::smooth_normals, Effect::sky};
    EXPECT_TRUE(have_lanes(diffuse, CLARAY_LANES_SHADE));
    for (const Effect unknown : {Effect::instances, Effect::vertex_colors, Effect::nested_media}) {
        EXPECT_FALSE(have_lanes(diffuse | EffectSet{unknown}, CLARAY_LANES_SHADE)) << name_of(unknown);
        EXPECT_FALSE(have_lanes(diffuse | EffectSet{unknown}, CLARAY_LANES_LISTS)) << name_of(unknown);
    }
    EXPECT_TRUE(have_lanes(diffuse | EffectSet{Effect::textures}, CLARAY_LANES_SHADE));
    EXPECT_FALSE(have_lanes(diffuse | EffectSet{Effect::textures}, CLARAY_LANES_LISTS));
    EXPECT_FALSE(have_lanes({Effect::light_lists}, CLARAY_LANES_SHADE));
    EXPECT_TRUE(have_lanes({Effect::light_lists}, CLARAY_LANES_LISTS));
    EXPECT_TRUE(have_lanes({Effect::absorption}, CLARAY_LANES_SHADE));
    EXPECT_FALSE(have_lanes({Effect::absorption}, CLARAY_LANES_LISTS));
}

TEST(Effects, NamesAreParsed) {
    EXPECT_EQ(parse_effects(to_string(full_effects())), full_effects());
    EXPECT_EQ(parse_effects("mirror,sky"), (EffectSet{Effect::mirror, Effect::sky}));
    EXPECT_EQ(parse_effects(to_string(EffectSet())), EffectSet());
    EXPECT_TRUE(throws_error(ErrorKind::usage, "'stars'", [] { (void)parse_effects("sky,stars"); }));
}

TEST(Effects, OverridesAreParsed) {
    const EffectOverrides overrides = parse_effect_overrides("+mirror,-sky,+glass");
    EXPECT_EQ(overrides.add, (EffectSet{Effect::mirror, Effect::glass}));
    EXPECT_EQ(overrides.remove, EffectSet{Effect::sky});
    for (const char* bad : {"", "mirror", "+", "+mirrors", "+mirror,", "+mirror,-mirror", "*sky"})
        EXPECT_TRUE(throws_error(ErrorKind::usage, "effect", [&] { (void)parse_effect_overrides(bad); })) << bad;
}

TEST(Effects, EveryMacroIsZeroOrItsBits) {
    for (const Stage stage : {Stage::generate, Stage::trace, Stage::shade, Stage::aovs}) {
        const Defines none = defines_of({}, stage);
        for (const auto& [name, value] : none) EXPECT_EQ(value, "0") << name;
        for (const Effect effect : all_effects()) {
            const Defines one = defines_of({effect}, stage);
            ASSERT_EQ(one.size(), none.size());
            std::size_t changed = 0;
            for (std::size_t i = 0; i < one.size(); ++i) changed += one[i] != none[i];
            EXPECT_EQ(changed, concerns(effect, stage) ? 1u : 0u) << name_of(effect);
        }
    }
}

/// One scene for each, and one for all at once. All are rendered by the generic kernels, which compile once.
TEST(Effects, HaveBuiltInScenes) {
    RenderConfig config{.width = 24, .height = 16, .spp = 4, .max_depth = 5, .effects = {full_effects(), {}}};
    const auto expect_picture = [&](const Scene& scene) {
        const glm::dvec3 light = mean(render_image(scene, config));
        EXPECT_TRUE(light.x > 0.01 && light.x < 10) << light.x;
    };
    // What an effect can't be had without, beside Lambert and one kind of light.
    const EffectSet base = {Effect::lambert,        Effect::sky,          Effect::point_lights,
                            Effect::glass,          Effect::principled,   Effect::textures,
                            Effect::mip_maps,       Effect::instances,    Effect::emissive_triangles,
                            Effect::smooth_normals, Effect::metal,        Effect::clearcoat,
                            Effect::environment,    Effect::light_falloff};
    for (const Effect effect : all_effects()) {
        SCOPED_TRACE(name_of(effect));
        const Scene scene = *builtin_scene(std::string("effect:") + name_of(effect));
        validate(scene);
        EXPECT_TRUE(effects_of(scene).has(effect));
        const EffectSet needed = effect == Effect::layered_coat   ? EffectSet{Effect::normal_maps}
                                 : effect == Effect::tilted_focus ? EffectSet{Effect::depth_of_field}
                                                                  : EffectSet();
        EXPECT_EQ(effects_of(scene) - base - needed - EffectSet{effect}, EffectSet());
        expect_picture(scene);
    }
    const Scene all = *builtin_scene("effects");
    validate(all);
    EffectSet apart;
    for (const Effect effect : all_effects())
        if (part_of(effect).apart) apart.add(effect);
    EXPECT_EQ(effects_of(all), known_effects() - apart);
    expect_picture(all);
    EXPECT_TRUE(throws_error(ErrorKind::usage, "mirror", [] { (void)builtin_scene("effect:stars"); }));
}

/// Thin walls need none of the effects of solids, for any other parameters of the material.
TEST(Effects, ThinWallsAreNoSolids) {
    for (const MaterialKind kind : {MaterialKind::glass, MaterialKind::principled}) {
        Scene scene = plain_scene();
        Material& wall = scene.materials[0];
        wall.kind = kind, wall.roughness = 0.5f, wall.transmission = 0.5f, wall.thin_walled = true;
        wall.attenuation = glm::vec3(0.5f), wall.attenuation_distance = 1.f;
        const EffectSet of_walls = {Effect::thin_walls}, of_kind = {Effect::principled};
        EXPECT_EQ(effects_of(scene), kind == MaterialKind::glass ? of_walls : of_walls | of_kind);
        for (const EffectCause& cause : causes_of_effects(scene)) EXPECT_EQ(cause.count, 1u);
        EXPECT_EQ(effects_of(without_effects(scene, of_walls)),
                  kind == MaterialKind::glass ? EffectSet{Effect::lambert} : of_kind);
        EXPECT_EQ(effects_of(without_effects(scene, {Effect::transmission, Effect::glass})), effects_of(scene));
    }
}

/// The image is the same whatever else the kernels could do: most tests of rendering rely on it.
TEST(Effects, OwnKernelsMakeTheSameImage) {
    for (const char* name :
         {"cornell", "spheres", "crate", "effect:height-maps", "effect:mip-maps", "effect:layered-coat",
          "effect:environment", "effect:instance-motion", "effect:cut-outs", "effect:hot-spots"}) {
        const Scene scene = *builtin_scene(name);
        const RenderConfig config{.width = 24, .height = 20, .spp = 3, .max_depth = 6};
        EXPECT_TRUE(same_bits(render_image(scene, config), render_by_own_kernels(scene, config))) << name;
    }
}

/// Without lights, normals or a sky, so that every effect has nothing to do.
TEST(Effects, FindNothingInTheDark) {
    EXPECT_EQ(mean(render_image(plain_scene(), {.width = 16, .height = 16, .spp = 2})), glm::dvec3(0.0));
}

/// Kernels with it shade rays one by one, and kernels with the other view lights one by one.
constexpr Effect shaded_alone = Effect::vertex_colors, viewed_alone = Effect::spot_lights;

/// Where surfaces are diffuse, CPUs shade sixteen rays at once (render/shade_sixteen.clh).
TEST(Effects, DiffuseScenesAreShadedWithTheSameBitsSixteenAtOnce) {
    Scene dark = *builtin_scene("cornell");
    for (Material& m : dark.materials) m.emission = glm::vec3(0.f);
    Scene points = dark;
    points.lights = {point_light({0.2f, 0.5f, 0.1f}, {1, 2, 3}), point_light({0.4f, 0.3f, 0.3f}, {2, 1, 1})};
    Scene open = points;
    open.sky = {glm::vec3(0.3f), glm::vec3(0.5f, 0.6f, 1.f)};
    open.meshes.resize(open.meshes.size() - 1);
    Scene needle = dark;  // a light so narrow that the square of its normal, as it is computed, underflows
    needle.materials.push_back(emitter(1e19f));
    needle.materials.back().cull_back = true;
    Mesh light;
    light.positions = {{0.1f, 0.4f, 0}, {0.4f, 0.4f, 0}, {0.1f, 0.4f, 1e-20f}};
    light.triangles = {{0, 1, 2}};
    light.materials = {std::uint32_t(needle.materials.size() - 1)};
    needle.meshes.push_back(light);
    const Scene scenes[] = {*builtin_scene("cornell"), dark, points, open, needle};
    for (std::size_t i = 0; i < std::size(scenes); ++i)
        for (const unsigned width : {1u, 13u}) {
            RenderConfig config{.width = width, .height = 11, .spp = 3, .max_depth = 6};
            config.effects.remove = {Effect::light_lists};
            const std::vector<glm::vec3> image = render_by_own_kernels(scenes[i], config);
            EXPECT_EQ(mean(image).x > 0, i != 1);
            for (const Effect added : {shaded_alone, viewed_alone}) {
                config.effects.add = {added};
                EXPECT_TRUE(same_bits(image, render_image(scenes[i], config)))
                    << "scene " << i << ", width " << width << ", " << name_of(added);
            }
        }
}

/// The scenes' own kernels make the images of a kernel that shades surfaces one by one.
void expect_same_bits_one_by_one(const std::vector<Scene>& scenes) {
    EffectSet one_by_one = {shaded_alone};  // and all else, so that one kernel compiles
    for (const Scene& scene : scenes) one_by_one = one_by_one | effects_of(scene);
    one_by_one.remove(Effect::light_lists);
    for (std::size_t i = 0; i < scenes.size(); ++i)
        for (const unsigned width : {13u, 32u}) {
            RenderConfig config{.width = width, .height = 33, .spp = 3, .max_depth = 6};
            config.effects.remove = {Effect::light_lists};
            const std::vector<glm::vec3> image = render_by_own_kernels(scenes[i], config);
            EXPECT_GT(mean(image).x, 0);
            config.effects.add = one_by_one;
            EXPECT_TRUE(same_bits(image, render_image(scenes[i], config))) << "scene " << i << ", width " << width;
        }
}

/// The diffuse surfaces of scenes that have others as well are shaded so, too.
TEST(Effects, DiffuseSurfacesAreShadedWithTheSameBitsSixteenAtOnce) {
    Scene mixed = *builtin_scene("cornell");
    const std::size_t plain = mixed.materials.size();
    mixed.materials.resize(plain + 3);
    Material &glass = mixed.materials[plain], &mirror = mixed.materials[plain + 1], &cloth = mixed.materials[plain + 2];
    glass.kind = MaterialKind::glass, glass.attenuation = {0.5f, 0.8f, 0.9f}, glass.attenuation_distance = 0.1f;
    mirror.kind = MaterialKind::mirror;
    cloth.kind = MaterialKind::principled, cloth.sheen = glm::vec3(0.5f), cloth.sheen_roughness = 0.4f;
    for (std::size_t i = 0; i < mixed.meshes.size(); ++i)
        for (std::size_t t = 0; t < mixed.meshes[i].materials.size(); ++t) {
            std::uint32_t& material = mixed.meshes[i].materials[t];
            if (!(mixed.materials[material].emission.x > 0) && (i + t / 2) % 2 == 1)
                material = std::uint32_t(plain + (i + t / 2) / 2 % 3);
        }
    ASSERT_TRUE(
        (EffectSet{Effect::lambert, Effect::glass, Effect::absorption, Effect::mirror} - effects_of(mixed)).empty());
    Scene points = mixed;
    for (Material& m : points.materials) m.emission = glm::vec3(0.f);
    points.sky = {glm::vec3(0.3f), glm::vec3(0.5f, 0.6f, 1.f)};
    points.lights = {point_light({0.2f, 0.5f, 0.1f}, {1, 2, 3}), point_light({0.4f, 0.3f, 0.3f}, {2, 1, 1})};
    Scene many_points = points, many_lamps = mixed;  // by the light tree
    for (int i = 0; i < 40; ++i)
        many_points.lights.push_back(point_light({0.1f + 0.01f * float(i), 0.5f, 0.1f}, glm::vec3(0.1f)));
    Mesh& lamps = many_lamps.meshes.emplace_back();
    for (std::uint32_t i = 0; i < 40; ++i) {
        const glm::vec3 at{0.1f + 0.01f * float(i), 0.5f, 0.1f};
        for (const glm::vec3 corner : {glm::vec3(0), glm::vec3(0.005f, 0, 0), glm::vec3(0, 0, 0.1f)})
            lamps.positions.push_back(at + corner);
        lamps.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        lamps.materials.push_back(std::uint32_t(plain - 1));
    }
    ASSERT_TRUE(effects_of(many_lamps).has(Effect::many_lights) && effects_of(many_points).has(Effect::many_lights));
    expect_same_bits_one_by_one({mixed, points, many_points, many_lamps});
}

/// As above, with normals of half of the meshes and an image around the scene.
TEST(Effects, SmoothSurfacesAndEnvironmentsAreShadedWithTheSameBitsSixteenAtOnce) {
    Scene lamp = *builtin_scene("cornell");
    lamp.camera->position *= 8.f, lamp.camera->target *= 8.f;  // directions to the image are shorter than the scene
    for (Mesh& mesh : lamp.meshes)
        for (glm::vec3& at : mesh.positions) at *= 8.f;
    lamp.meshes[0].triangles.resize(lamp.meshes[0].triangles.size() / 2);  // open to the image
    lamp.meshes[0].materials.resize(lamp.meshes[0].triangles.size());
    for (std::size_t i = 0; i < lamp.meshes.size(); i += 2)
        for (const glm::vec3& at : lamp.meshes[i].positions)
            lamp.meshes[i].normals.push_back(glm::normalize(glm::vec3(2.f, 2.4f, 0.8f) - at));
    Scene smooth = lamp;  // without an image
    lamp.environment.images = {
        float_texture({32, 16}, [](double u, double v) { return glm::vec3(u < 0.2 && v < 0.3 ? 20 : 0.2, 0.3, v); })};
    Scene dark = lamp;
    for (Material& m : dark.materials) m.emission = glm::vec3(0.f);
    Scene points = dark, many_points = dark;
    points.lights = {point_light({1.6f, 4, 0.8f}, {64, 128, 192}), point_light({3.2f, 2.4f, 2.4f}, {128, 64, 64})};
    for (int i = 0; i < 40; ++i)  // by the light tree
        many_points.lights.push_back(point_light({0.8f + 0.08f * float(i), 4, 0.8f}, glm::vec3(6.4f)));
    ASSERT_TRUE(effects_of(many_points).has(Effect::many_lights) && effects_of(dark).has(Effect::smooth_normals));
    expect_same_bits_one_by_one({lamp, smooth, dark, points, many_points});
}

/// So is smooth glass, of both kinds of materials, which absorbs light.
TEST(Effects, SmoothGlassIsShadedWithTheSameBitsSixteenAtOnce) {
    Scene flat = *builtin_scene("cornell");
    const std::size_t plain = flat.materials.size();
    flat.materials.resize(plain + 2);
    Material &glass = flat.materials[plain], &principled = flat.materials[plain + 1];
    glass.kind = MaterialKind::glass, glass.roughness = 0, glass.ior = 1.4f;
    principled.kind = MaterialKind::principled, principled.roughness = 0, principled.transmission = 1;
    for (Material* m : {&glass, &principled}) m->attenuation = {0.5f, 0.8f, 0.9f}, m->attenuation_distance = 0.1f;
    for (Mesh& mesh : flat.meshes)
        for (std::size_t t = 0; t < mesh.materials.size(); ++t)
            if (!(flat.materials[mesh.materials[t]].emission.x > 0) && t / 2 % 3 != 2)
                mesh.materials[t] = std::uint32_t(plain + t / 2 % 3);
    ASSERT_TRUE((EffectSet{Effect::lambert, Effect::glass, Effect::absorption} - effects_of(flat)).empty());
    ASSERT_FALSE(effects_of(flat).has(Effect::rough_glass));
    Scene smooth = flat;
    for (std::size_t i = 0; i < smooth.meshes.size(); i += 2)
        for (const glm::vec3& at : smooth.meshes[i].positions)
            smooth.meshes[i].normals.push_back(glm::normalize(glm::vec3(0.25f, 0.3f, 0.1f) - at));
    expect_same_bits_one_by_one({flat, smooth});
}

/// Bare dielectrics are shaded so as well, smooth or not, and maps of albedo, roughness and metallic value are applied.
/// Where such a map makes metal or a mirror, rays are shaded one by one.
TEST(Effects, MappedDielectricsAreShadedWithTheSameBitsSixteenAtOnce) {
    Scene plastic = *builtin_scene("cornell");
    for (std::size_t i = 0; i < plastic.materials.size(); ++i) {
        Material& m = plastic.materials[i];
        if (m.emission.x > 0 || i % 3 == 2) continue;
        m.kind = MaterialKind::principled, m.roughness = 0.2f + 0.3f * float(i % 3);
    }
    Scene smooth = plastic;
    for (std::size_t i = 0; i < smooth.meshes.size(); i += 2)
        for (const glm::vec3& at : smooth.meshes[i].positions)
            smooth.meshes[i].normals.push_back(glm::normalize(glm::vec3(0.25f, 0.3f, 0.1f) - at));
    Scene mapped = smooth;
    mapped.textures = {
        float_texture({8, 8}, [](double u, double v) { return glm::vec3(u, v, 0.5); }),
        float_texture({8, 8}, [](double u, double v) { return glm::vec3(0, u < 0.4 ? 0 : u, v > 0.6); })};
    for (Mesh& mesh : mapped.meshes)
        for (const glm::vec3& at : mesh.positions) mesh.uvs.push_back(3.f * glm::vec2(at.x + at.z, at.y + at.z));
    for (Material& m : mapped.materials) {
        m.albedo_map = {.texture = 0};
        if (m.kind == MaterialKind::principled) m.metallic_roughness_map = {.texture = 1}, m.metallic = 1;
    }
    ASSERT_TRUE((EffectSet{Effect::principled, Effect::metal, Effect::textures} - effects_of(mapped)).empty());
    Scene sunny = mapped;
    sunny.sky = {glm::vec3(0.3f), glm::vec3(0.5f, 0.6f, 1.f)};
    sunny.meshes.resize(sunny.meshes.size() - 1);
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {0.3f, -1.f, 0.2f}, sun.intensity = glm::vec3(2.f);
    sunny.lights = {sun};
    expect_same_bits_one_by_one({plastic, smooth, mapped, sunny});
}

/// Asked of the buffers, since hits are the same: traversal looks up a word for every triangle.
TEST(Effects, CutOutsCanBeAddedToTraversal) {
    const Scene scene = plain_scene();
    const auto outcome_of = [&](EffectSet add) {
        const RenderConfig config{.width = 16, .height = 16, .spp = 1, .effects = {add, {}}};
        Renderer renderer(device(), scene, config);
        (void)renderer.render();
        return std::pair(renderer.statistics().device_bytes, renderer.image());
    };
    const auto [bytes, image] = outcome_of({});
    for (const Effect effect : {Effect::cut_outs, Effect::culling}) {
        const auto [more, same] = outcome_of({effect});
        EXPECT_GE(more, bytes + scene.meshes[0].triangles.size() * sizeof(std::uint32_t)) << name_of(effect);
        EXPECT_EQ(same, image) << name_of(effect);
    }
}

/// Asked of the profiler and of the buffers, under kernels that could do everything.
TEST(Effects, WithoutThemThereIsNoPassAndNoMemory) {
    const RenderConfig config{.width = 16, .height = 16, .spp = 1, .effects = {full_effects(), {}}};
    const auto bytes = [&](const Scene& scene) {
        Renderer renderer(device(), scene, config);
        renderer.render();
        return renderer.statistics().device_bytes;
    };
    Scene scene = plain_scene();
    scene.sky.zenith = glm::vec3(1.f);
    device().finish();
    device().profiler().reset();
    const std::uint64_t plain = bytes(scene);
    const auto& commands = device().profiler().summary();
    EXPECT_EQ(commands.count("trace_bounce_rays"), 1u);
    EXPECT_EQ(commands.count("trace_shadow_rays"), 0u);
    EXPECT_EQ(commands.count("add_light"), 0u);

    Scene coordinates = scene;  // and an image, that nothing uses
    coordinates.meshes[0].uvs.assign(4, glm::vec2(0.5f));
    coordinates.textures = builtin_scene("effect:textures")->textures;
    EXPECT_EQ(bytes(coordinates), plain);
    coordinates.materials[0].albedo_map.texture = 0;
    EXPECT_GT(bytes(coordinates), plain + 64 * 64);
    Scene lit = scene;
    lit.lights = {point_light({0, 2, 0}, {1, 1, 1})};
    EXPECT_GT(bytes(lit), plain + 256 * sizeof(Ray));
}

TEST(Effects, TakenFromTheSceneAreGone) {
    Scene scene = *builtin_scene("cornell");
    scene.sky.zenith = scene.sky.horizon = glm::vec3(0.5f);
    const RenderConfig config{.width = 16, .height = 16, .spp = 4, .effects = {{}, {Effect::emissive_triangles}}};
    for (Material& m : scene.materials) m.emission = glm::vec3(0.f);
    const std::vector<glm::vec3> by_hand = render_image(scene, {.width = 16, .height = 16, .spp = 4});
    scene.materials.back().emission = glm::vec3(9.f);
    EXPECT_TRUE(same_bits(by_hand, render_image(scene, config)));
}

/// Without lists the tree picks lights, and without the tree their power: another noise, the same light.
TEST(Effects, LightListsAndManyLightsAreAids) {
    Scene scene = plain_scene();
    for (int i = 0; i < 30; ++i) scene.lights.push_back(point_light({0.2f * float(i) - 3, 1, 0.5f}, glm::vec3(0.1f)));
    RenderConfig config{.width = 16, .height = 16, .spp = 64, .max_depth = 1};
    const std::vector<glm::vec3> with_lists = render_image(scene, config);
    config.effects.remove = {Effect::light_lists};
    const std::vector<glm::vec3> with_tree = render_image(scene, config);
    config.effects.remove.add(Effect::many_lights);
    const std::vector<glm::vec3> by_power = render_image(scene, config);
    EXPECT_FALSE(same_bits(with_lists, with_tree));
    EXPECT_FALSE(same_bits(with_tree, by_power));
    EXPECT_NEAR(mean(with_lists).x / mean(by_power).x, 1, 0.01);
    EXPECT_NEAR(mean(with_tree).x / mean(by_power).x, 1, 0.01);
}

}  // namespace
}  // namespace claray::test
