// Images whose values are committed: of every effect alone and together, by the kernels of all scenes and by a scene's
// own, and all else that renders give. Lights, layers of materials and samplers have no closed form together, but every
// device must find the same light by the same random numbers.
#include <algorithm>
#include <bit>
#include <cmath>

#include "claray/effects.hpp"
#include "claray/renderer.hpp"
#include "host/base/format.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/committed.hpp"
#include "host/verify/cases/rendering/bsdf.hpp"
#include "host/verify/scenes.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

RenderConfig small_image(unsigned spp) { return {.width = 32, .height = 24, .spp = spp, .seed = 5}; }

void compare_render(const Run& run, Committed& committed, const std::string& name, const Scene& scene,
                    const RenderConfig& config) {
    committed.compare(name, render(run, scene, config));
}

// ---- every effect ------------------------------------------------------------------------------------------------

bool has_surfaces_of_its_own(Effect effect) {
    static const EffectSet those{Effect::smooth_normals, Effect::depth_of_field, Effect::vertex_colors,
                                 Effect::textures,       Effect::mip_maps,       Effect::nearest_levels,
                                 Effect::normal_maps,    Effect::height_maps,    Effect::cut_outs,
                                 Effect::culling,        Effect::orthographic,   Effect::panorama};
    return those.has(effect);
}

/// A mirror and a metal, seen and left by rays within 0.03 degrees of their planes.
Scene grazing_views() {
    Scene scene;
    scene.materials = {grey(0.9f), grey(0.7f)};
    scene.materials[0].kind = MaterialKind::mirror;
    scene.materials[1].kind = MaterialKind::metal, scene.materials[1].roughness = 0.04f;
    scene.meshes = {square(1.f, 0.f, 0), square(1.f, 0.f, 1)};
    for (glm::vec3& p : scene.meshes[1].positions) p.z += 2.f;
    scene.sky.horizon = glm::vec3(0.5f, 0.7f, 0.9f), scene.sky.zenith = glm::vec3(2.f);
    scene.camera = Camera{{4.f, 0.002f, 1.f}, {0.f, 0.f, 1.f}, {0, 1, 0}, 0.05f};
    return scene;
}

/// A model of the scene, whose texels are small, too. Its tangents are short and lead elsewhere.
Scene in_small(Scene scene) {
    constexpr float scale = 1.f / 256;
    for (Mesh& mesh : scene.meshes) {
        for (glm::vec3& p : mesh.positions) p *= scale;
        if (!mesh.uvs.empty()) mesh.tangents.assign(mesh.positions.size(), {0.01f, 0.004f, 0.006f, -1.f});
    }
    scene.camera->position *= scale, scene.camera->target *= scale;
    return scene;
}

/// Kernels that have all effects render the scene of each.
void effect_images(Run& run) {
    Committed images(run), surfaces(run);
    for (const Effect effect : all_effects()) {
        if (!full_effects().has(effect)) continue;  // it has kernels of its own
        const std::string name = std::string("effect:") + name_of(effect);
        const std::optional<Scene> scene = builtin_scene(name);
        if (!scene || !full_effects().contains(effects_of(*scene))) continue;
        RenderConfig config = small_image(8);
        config.effects.add = full_effects();
        Renderer renderer(run.device(), *scene, config);
        render(renderer);
        images.compare(name, renderer.image());
        if (has_surfaces_of_its_own(effect)) surfaces.compare(name + " surfaces", numbers_of(renderer.aovs()));
    }
    RenderConfig config = small_image(8);
    config.effects.add = full_effects();
    compare_render(run, images, "grazing views", grazing_views(), config);
    for (const char* const name : {"effect:normal-maps", "effect:height-maps", "effect:anisotropy"})
        compare_render(run, images, name + std::string(" in small"), in_small(*builtin_scene(name)), config);
    images.check("images");
    surfaces.check("depths, numbers, normals and albedos");
}

// ---- materials ---------------------------------------------------------------------------------------------------

void add_values(const std::vector<Sampled>& samples, std::vector<float>& to) {
    for (const Sampled& s : samples)
        if (s.valid) to.insert(to.end(), {s.x, s.y, s.z, s.weight, s.pdf, s.eval_value, s.eval_pdf});
}

/// Samples by random numbers of all kinds, the least and the largest among them, and values for given directions.
void bsdf_values(Run& run) {
    Committed values(run);
    Tally finite;
    std::vector<float> directions;
    for (const double theta : {0.02, 0.5, 1.1, 1.55, 1.5704, 1.5712, 1.65, 2.2, 3.0})
        for (const double phi : {0.3, 2.0, 3.44}) {
            const glm::vec3 d = at_angle(theta, phi);
            directions.insert(directions.end(), {d.x, d.y, d.z});
        }
    for (const Kind& kind : bsdf_kinds()) {
        std::vector<float> all;
        for (const float roughness : {0.f, 0.1f, 0.35f, 1.f}) {
            const TestedMaterial material = tested(run.device(), kind, roughness);
            for (const double theta : {0.9, 1.5703}) {
                const glm::vec3 outgoing = at_angle(theta);
                add_values(material.draw(outgoing, 64, 0xffffffffu),
                           all);  // EXTREME_NUMBERS of kernels/verify/bsdf/bsdf.clh
                add_values(material.draw(outgoing, 2048, 5), all);
                const auto [found, pdfs] = material.evaluate(outgoing, directions);
                all.insert(all.end(), found.begin(), found.end()), all.insert(all.end(), pdfs.begin(), pdfs.end());
            }
        }
        for (const float value : all) finite.add(std::isfinite(value));
        values.compare(kind.name, all);
    }
    values.check("samples and values");
    run.check("values that are not finite", finite, "values");
}

// ---- a scene's own kernels ---------------------------------------------------------------------------------------

/// Lights of every kind over a floor with balls, too many for one list.
Scene many_lights() {
    Scene scene;
    scene.materials = {grey(0.6f), grey(0.4f)};
    scene.materials[1].kind = MaterialKind::principled, scene.materials[1].roughness = 0.4f;
    scene.meshes = {square(4.f, 0.f, 0), sphere(3, 0.6f, {0.4f, 0.6f, 0.2f}), sphere(2, 0.3f, {-1.f, 0.3f, 0.8f})};
    for (const std::size_t i : {1u, 2u}) scene.meshes[i].materials.assign(scene.meshes[i].triangles.size(), 1);
    for (const glm::vec3& p : scene.meshes[1].positions)
        scene.meshes[1].normals.push_back(glm::normalize(p - glm::vec3(0.4f, 0.6f, 0.2f)));
    for (const MaterialKind kind : {MaterialKind::glass, MaterialKind::mirror, MaterialKind::blinn_phong}) {
        const auto number = std::uint32_t(scene.materials.size());
        scene.materials.push_back(grey(0.8f));
        scene.materials.back().kind = kind;
        scene.meshes.push_back(sphere(2, 0.25f, {1.1f * float(number) - 3.6f, 0.3f, 1.4f}));
        scene.meshes.back().materials.assign(scene.meshes.back().triangles.size(), number);
    }
    Random random(3);
    for (int i = 0; i < 700; ++i) {
        Light light = point_light({random.uniform(-4, 4), random.uniform(0.05f, 0.8f), random.uniform(-4, 4)},
                                  0.02f * glm::vec3(random.uniform(1, 2), random.uniform(1, 2), 1.f));
        light.range = i % 50 == 0 ? 0.f : random.uniform(0.3f, 1.2f), light.linear_range = i % 9 == 0;
        if (i % 3 == 0) {
            light.kind = LightKind::spot, light.direction = random.in_cube(1.f) - glm::vec3(0.f, 1.f, 0.f);
            light.inner_angle = 0.3f, light.outer_angle = i % 2 ? 0.6f : 1.3f;
        }
        scene.lights.push_back(light);
    }
    Light far = point_light({}, glm::vec3(0.3f));
    far.kind = LightKind::directional, far.direction = {0.3f, -1.f, 0.2f};
    scene.lights.push_back(far);
    scene.camera = Camera{{0.5f, 2.2f, 4.2f}, {0.f, 0.3f, 0.f}, {0, 1, 0}, 45.f};
    return scene;
}

/// A ball whose vertices have normals of all lengths: those that have no direction in float32 are left out.
Scene ball_of_long_normals() {
    Scene scene;
    scene.materials = {grey(0.6f)};
    scene.meshes = {square(6.f, -0.7f, 0), sphere(2, 0.7f, {0.1f, 0.f, 0.f})};
    scene.meshes[0].normals.assign(4, glm::vec3(1.3e38f, 2.7e38f, 0.f));
    Mesh& ball = scene.meshes[1];
    for (std::size_t i = 0; i < ball.positions.size(); ++i) {
        constexpr float lengths[] = {1.f, 1e25f, 1.f, 1e-25f, 1.f, 1e-15f, 1e15f, 0.f};
        ball.normals.push_back(lengths[i % 8] * glm::normalize(ball.positions[i] - glm::vec3(0.1f, 0.f, 0.f)));
    }
    scene.lights = {point_light({1.f, 2.f, 1.5f}, glm::vec3(4.f))};
    scene.camera = Camera{{0.f, 0.8f, 3.f}, {0, 0, 0}, {0, 1, 0}, 40.f};
    return scene;
}

void own_images(Run& run) {
    Committed images(run), others(run);
    for (const char* const name : {"cornell", "spheres", "crate"}) {
        const RenderConfig config = small_image(16);
        Renderer renderer(run.device(), *builtin_scene(name), config);
        render(renderer);
        images.compare(name, renderer.image());
        others.compare(name + std::string(" surfaces"), numbers_of(renderer.aovs()));
        if (name != std::string("cornell")) continue;
        const std::vector<float> noise = renderer.noise_map();
        others.compare("cornell noise", noise);
        const auto larger = renderer.image(40, 40);
        others.compare("cornell in another size", larger);
        others.compare("cornell in bytes", renderer.picture({.exposure = 1.f}));
        const std::vector<float> cut_off = {float(renderer.cut_off())};
        others.compare("cornell cut off", cut_off);
    }
    for (const char* const name : {"effect:instances", "effect:instance-motion", "effect:primitives"})
        compare_render(run, images, name, *builtin_scene(name), small_image(16));
    compare_render(run, images, "normals of all lengths", ball_of_long_normals(), small_image(8));
    Scene lights = many_lights();
    compare_render(run, images, "many lights of short ranges", lights, small_image(8));
    Scene through_glass = lights;
    through_glass.materials[2].roughness = 0.4f;
    Light sun = point_light({}, glm::vec3(0.5f));
    sun.kind = LightKind::sun, sun.direction = {-0.2f, -0.3f, 1.f}, sun.outer_angle = 0.4f;
    through_glass.lights.push_back(sun);
    compare_render(run, images, "many lights, and a sun behind rough glass", through_glass, small_image(16));
    for (Light& light : lights.lights) light.range = 0.f;
    compare_render(run, images, "many lights", lights, small_image(8));
    const Scene cornell = *builtin_scene("cornell");
    RenderConfig config = small_image(32);
    config.adaptive = true;
    Renderer adaptive(run.device(), cornell, config);
    render(adaptive);
    run.check("adaptive renders that give all pixels the same samples", 1, adaptive.statistics().adapted ? 0 : 1, 0,
              "");
    images.compare("cornell, adaptive", adaptive.image());
    config = small_image(32);
    config.error = 1e-6;
    compare_render(run, images, "cornell to an error", cornell, config);
    config = small_image(8);
    config.sample_clamp = 0.5f;
    compare_render(run, images, "cornell, clamped", cornell, config);
    config.sample_clamp = 0, config.sampler = Sampler::independent;
    compare_render(run, images, "cornell, independent samples", cornell, config);
    images.check("images");
    others.check("other results");
}

// ---- approximations ----------------------------------------------------------------------------------------------

void approximate_images(Run& run) {
    Committed images(run);
    const Scene lights = many_lights(), cornell = *builtin_scene("cornell");
    RenderConfig config{.width = 80, .height = 60, .spp = 2, .seed = 5};
    config.approximate.tile_sum = true;
    compare_render(run, images, of_kind(run, "tiles of lights"), lights, config);
    config.approximate.flat = true;
    compare_render(run, images, "tiles of lights, flat", lights, config);
    config.approximate.flat = false, config.approximate.gouraud = true;
    compare_render(run, images, "tiles of lights, gouraud", lights, config);
    {
        const ScopedTuning shorter(run.device(), "deferred/list_lights", "MOST_PER_TILE", 16);
        const ScopedTuning short_too(run.device(), "deferred/list_lights", "MOST_PER_BLOCK", 200);
        compare_render(run, images, "short lists of lights", lights, config);
    }
    Scene aimed = many_lights();
    const glm::vec3 target(2.5f, 0.f, -2.f);
    for (Light& light : aimed.lights)
        if (light.kind == LightKind::spot)
            light.position = target + 0.5f * (light.position - glm::vec3(0.f, -0.2f, 0.f)),
            light.direction = target - light.position, light.range = 0.f;
    aimed.camera = narrow_camera(target + glm::vec3(0.f, 3.f, 0.1f), target);
    RenderConfig tile = small_image(1);
    tile.approximate.tile_sum = true;
    compare_render(run, images, of_kind(run, "spots that aim at a tile"), aimed, tile);
    config = small_image(8);
    for (const auto flag : {&Approximations::flat, &Approximations::gouraud, &Approximations::no_shadows}) {
        config.approximate = {};
        config.approximate.*flag = true;
        const std::string name = "cornell, " + to_string(config.approximate);
        compare_render(run, images, config.approximate.gouraud ? of_kind(run, name) : name, cornell, config);
    }
    config.approximate = {.light_grid = true};
    config.width = 33, config.height = 23;  // groups of items end beyond the last one, here and in the grids
    for (const LightGridConfig& grid :
         {LightGridConfig{.side = 7, .rays = 16, .updates = 3},
          LightGridConfig{.side = 5, .coefficients = 4, .levels = 2, .gather = 1, .rays = 32, .updates = 2},
          LightGridConfig{.voxels = true, .side = 11, .rays = 32, .updates = 2}}) {
        config.light_grid = grid;
        Renderer renderer(run.device(), cornell, config);
        render(renderer);
        const std::string name = of_kind(run, "cornell by a grid, " + to_string(grid));
        images.compare(name, renderer.image());
        if (grid.voxels) images.compare(name + ", its voxels", renderer.voxels());
    }
    images.check("images");
}

// ---- without noise, with guides, into maps -----------------------------------------------------------------------

void denoised_images(Run& run) {
    Committed images(run);
    for (const char* const name : {"cornell", "spheres"}) {
        Scene scene = *builtin_scene(name);
        const RenderConfig config{.width = 64, .height = 48, .spp = 4, .seed = 5};
        Renderer renderer(run.device(), scene, config);
        render(renderer);
        images.compare(of_kind(run, name + std::string(", denoised")), renderer.denoised(DenoiserKind::claray));
        for (int frame = 0; frame < 3; ++frame) {
            images.compare(name + std::string(", frame ") + std::to_string(frame), renderer.denoised_picture());
            scene.camera->position.x += 0.02f * glm::length(scene.camera->target - scene.camera->position);
            renderer.update(scene, {.camera = true});
            render(renderer);
        }
    }
    // Rough surfaces, textures and lenses, whose guides have noise, by common kernels.
    const char* const noisy[] = {"effect:depth-of-field", "effect:metal", "effect:rough-glass", "effect:textures"};
    RenderConfig common = small_image(4);
    for (const char* const name : noisy) common.effects.add = common.effects.add | effects_of(*builtin_scene(name));
    for (const char* const name : noisy) {
        Renderer renderer(run.device(), *builtin_scene(name), common);
        render(renderer);
        images.compare(of_kind(run, name + std::string(", denoised")), renderer.denoised(DenoiserKind::claray));
    }
    const RenderConfig config{.width = 512, .height = 384, .spp = 1, .seed = 5};
    Renderer renderer(run.device(), *builtin_scene("spheres"), config);
    render(renderer);
    const auto image = renderer.denoised(DenoiserKind::claray);
    images.compare(of_kind(run, "spheres, denoised and large"), image);
    images.check("images");
}

void guided_images(Run& run) {
    if (run.device().info().type != DeviceType::cpu) return run.fact("guides", "CPUs alone guide paths");
    Committed images(run);
    const ScopedTuning always(run.device(), "render/path_guide", "LEAST_GAIN_PERCENT", 1);
    Tally guided;
    const auto compare = [&](const std::string& name, const RenderConfig& config) {
        Renderer renderer(run.device(), *builtin_scene("cornell"), config);
        render(renderer);
        guided.add(renderer.statistics().guided);
        const auto image = renderer.image();
        images.compare(name, image);
    };
    compare("cornell, guided", {.width = 128, .height = 128, .spp = 24, .seed = 5});
    compare("cornell, guided by every second pixel", {.width = 320, .height = 256, .spp = 12, .seed = 5});
    run.check("renders without guides", guided, "");
    images.check("images");
}

void baked_light(Run& run) {
    Committed maps(run);
    Scene scene;
    scene.materials = {grey(0.6f), grey(0.3f, 2.f)};
    scene.meshes = {square(1.f, 0.f, 0), sphere(1, 0.4f, {0.4f, 0.7f, -0.3f})};
    scene.meshes[1].materials.assign(scene.meshes[1].triangles.size(), 1);
    scene.lights = {point_light({-0.5f, 0.8f, 0.3f}, {1.f, 2.f, 3.f})};
    scene.sky.horizon = glm::vec3(0.2f), scene.sky.zenith = glm::vec3(0.5f);
    const Texture map =
        bake_light_map(run.device(), scene, 0, {.width = 32, .height = 16, .spp = 16, .seed = 5, .uv_set = 0});
    maps.compare("a baked floor", map.floats);
    maps.check("images");
}

}  // namespace

Cases committed_cases() {
    return {
        {{"effect-images", "sameness", "Images of every effect have the committed light, by kernels with all effects"},
         effect_images},
        {{"bsdf-values", "sameness", "Materials have the committed samples, densities and values"}, bsdf_values},
        {{"own-images", "sameness",
          "Images by a scene's own kernels, with all that a film tells, are the committed ones"},
         own_images},
        {{"approximate-images", "sameness",
          "Sums of tiles, light grids and other approximations are the committed ones"},
         approximate_images},
        {{"denoised-images", "sameness", "Stills and frames without noise are the committed ones"}, denoised_images},
        {{"guided-images", "sameness", "Guided paths bring the committed light"}, guided_images},
        {{"baked-light", "sameness", "Light maps hold the committed light"}, baked_light},
    };
}

}  // namespace claray::verify
