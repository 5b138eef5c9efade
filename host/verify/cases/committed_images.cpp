// Images whose values are committed: of every effect alone and together, by the kernels of all scenes and by a scene's
// own, and all else that renders give. Lights, layers of materials and samplers have no closed form together, but every
// device must find the same light by the same random numbers.
#include <algorithm>

#include "claray/effects.hpp"
#include "claray/renderer.hpp"
#include "host/base/format.hpp"
#include "host/verify/cases/bsdf.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/expected_values.hpp"
#include "host/verify/scenes.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

RenderConfig small_image(unsigned spp) { return {.width = 32, .height = 24, .spp = spp, .seed = 5}; }

/// All but the work of the traversal, which depends on the layout of the tree.
std::vector<float> numbers_of(const Aovs& aovs, unsigned width) {
    std::vector<float> all;
    const auto add = [&](std::span<const float> values, unsigned channels) {
        const std::vector<float> sums = sums_of_blocks(values, width, channels, 8);
        all.insert(all.end(), sums.begin(), sums.end());
    };
    const auto add_numbers = [&](const auto& values, double missing) {
        std::vector<float> floats;
        for (const auto value : values) floats.push_back(double(value) < missing ? float(value) : -1.f);
        add(floats, 1);
    };
    add_numbers(aovs.depth, 1e30), add_numbers(aovs.primitive, CLARAY_MISS), add_numbers(aovs.material, CLARAY_MISS);
    add({&aovs.normal[0].x, 3 * aovs.normal.size()}, 3), add({&aovs.albedo[0].x, 3 * aovs.albedo.size()}, 3);
    return all;
}

std::vector<float> as_floats(std::span<const std::uint8_t> bytes) {
    return {bytes.begin(), bytes.end()};
}

void compare_render(const Run& run, Committed& committed, const std::string& name, const Scene& scene,
                    const RenderConfig& config) {
    committed.compare_image(name, render(run, scene, config), config.width);
}

// ---- every effect ------------------------------------------------------------------------------------------------

bool has_surfaces_of_its_own(Effect effect) {
    static const EffectSet those{Effect::smooth_normals, Effect::depth_of_field, Effect::vertex_colors,
                                 Effect::textures,       Effect::mip_maps,       Effect::nearest_levels,
                                 Effect::normal_maps,    Effect::height_maps,    Effect::cut_outs,
                                 Effect::culling,        Effect::orthographic,   Effect::panorama};
    return those.has(effect);
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
        renderer.render();
        images.compare_image(name, renderer.image(), config.width);
        if (has_surfaces_of_its_own(effect))
            surfaces.compare(name + " surfaces", numbers_of(renderer.aovs(), config.width));
    }
    images.check("sums of light");
    surfaces.check("sums of depths, numbers, normals and albedos");
}

// ---- materials ---------------------------------------------------------------------------------------------------

/// Sums of samples with a weight for each, so that no two samples' errors cancel.
void add_sums(const std::vector<Sampled>& samples, std::vector<float>& to) {
    for (const auto member : {&Sampled::x, &Sampled::y, &Sampled::z, &Sampled::weight, &Sampled::pdf,
                              &Sampled::eval_value, &Sampled::eval_pdf}) {
        double sum = 0;
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (samples[i].valid) sum += (1 + double(i * 7 % 64) / 64) * std::min(samples[i].*member, 1e4f);
        to.push_back(float(sum));
    }
}

/// Samples by random numbers of all kinds, the least and the largest among them, and values for given directions.
void bsdf_values(Run& run) {
    Committed values(run);
    std::vector<float> directions;
    for (const double theta : {0.02, 0.5, 1.1, 1.55, 1.5704, 1.5712, 1.65, 2.2, 3.0})
        for (const double phi : {0.3, 2.0, 3.44}) {
            const glm::vec3 d = at_angle(theta, phi);
            directions.insert(directions.end(), {d.x, d.y, d.z});
        }
    for (const Kind& kind : bsdf_kinds())
        for (const float roughness : {0.f, 0.1f, 0.35f, 1.f}) {
            const TestedMaterial material = tested(run.device(), kind, roughness);
            std::vector<float> sums;
            for (const double theta : {0.9, 1.5703}) {
                const glm::vec3 outgoing = at_angle(theta);
                add_sums(material.draw(outgoing, 64, 0xffffffffu), sums);  // EXTREME_NUMBERS of kernels/verify/bsdf.clh
                add_sums(material.draw(outgoing, 2048, 5), sums);
                const auto [found, pdfs] = material.evaluate(outgoing, directions);
                for (const std::vector<float>& all : {found, pdfs})
                    for (std::size_t part = 0; part < 3; ++part) {
                        double sum = 0;
                        for (std::size_t i = part; i < all.size(); i += 3) sum += double(i + 8) * all[i];
                        sums.push_back(float(sum));
                    }
            }
            values.compare(printed("%s, roughness %.2f", kind.name, double(roughness)), sums);
        }
    values.check("sums of samples and values", 7);  // of one sample
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

void own_images(Run& run) {
    Committed images(run), others(run);
    for (const char* const name : {"cornell", "spheres", "crate"}) {
        const RenderConfig config = small_image(16);
        Renderer renderer(run.device(), *builtin_scene(name), config);
        renderer.render();
        images.compare_image(name, renderer.image(), config.width);
        others.compare(name + std::string(" surfaces"), numbers_of(renderer.aovs(), config.width));
        if (name != std::string("cornell")) continue;
        const std::vector<float> noise = renderer.noise_map();
        others.compare("cornell noise", sums_of_blocks(noise, config.width, 1, 8));
        const auto larger = renderer.image(40, 40);
        others.compare("cornell in another size", sums_of_blocks({&larger[0].x, 3 * larger.size()}, 40, 3, 8));
        others.compare("cornell in bytes",
                       sums_of_blocks(as_floats(renderer.picture({.exposure = 1.f})), config.width, 4, 8));
        const float cut_off[] = {float(renderer.cut_off())};
        others.compare("cornell cut off", cut_off);
    }
    for (const char* const name : {"effect:instances", "effect:instance-motion", "effect:primitives"})
        compare_render(run, images, name, *builtin_scene(name), small_image(16));
    Scene lights = many_lights();
    compare_render(run, images, "many lights of short ranges", lights, small_image(8));
    for (Light& light : lights.lights) light.range = 0.f;
    compare_render(run, images, "many lights", lights, small_image(8));
    const Scene cornell = *builtin_scene("cornell");
    RenderConfig config = small_image(32);
    config.adaptive = true;
    Renderer adaptive(run.device(), cornell, config);
    adaptive.render();
    run.check("adaptive renders that give all pixels the same samples", 1, adaptive.statistics().adapted ? 0 : 1, 0, "");
    images.compare_image("cornell, adaptive", adaptive.image(), config.width);
    config = small_image(32);
    config.error = 1e-6;
    compare_render(run, images, "cornell to an error", cornell, config);
    config = small_image(8);
    config.sample_clamp = 0.5f;
    compare_render(run, images, "cornell, clamped", cornell, config);
    config.sample_clamp = 0, config.sampler = Sampler::independent;
    compare_render(run, images, "cornell, independent samples", cornell, config);
    images.check("sums of light");
    others.check("other sums");
}

// ---- approximations ----------------------------------------------------------------------------------------------

void approximate_images(Run& run) {
    Committed images(run);
    const Scene lights = many_lights(), cornell = *builtin_scene("cornell");
    RenderConfig config{.width = 80, .height = 60, .spp = 2, .seed = 5};
    config.approximate.tile_sum = true;
    compare_render(run, images, "tiles of lights", lights, config);
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
    compare_render(run, images, "spots that aim at a tile", aimed, tile);
    config = small_image(8);
    for (const auto flag : {&Approximations::flat, &Approximations::gouraud, &Approximations::no_shadows}) {
        config.approximate = {};
        config.approximate.*flag = true;
        compare_render(run, images, "cornell, " + to_string(config.approximate), cornell, config);
    }
    config.approximate = {.light_grid = true};
    for (const LightGridConfig& grid :
         {LightGridConfig{.side = 8, .rays = 16, .updates = 3},
          LightGridConfig{.side = 6, .coefficients = 4, .levels = 2, .gather = 1, .rays = 32, .updates = 2},
          LightGridConfig{.voxels = true, .side = 12, .rays = 32, .updates = 2}}) {
        config.light_grid = grid;
        Renderer renderer(run.device(), cornell, config);
        renderer.render();
        const std::string name = "cornell by a grid, " + to_string(grid);
        images.compare_image(name, renderer.image(), config.width);
        if (grid.voxels) images.compare_image(name + ", its voxels", renderer.voxels(), config.width);
    }
    images.check("sums of light");
}

// ---- without noise, with guides, into maps -----------------------------------------------------------------------

void denoised_images(Run& run) {
    Committed images(run);
    for (const char* const name : {"cornell", "spheres"}) {
        Scene scene = *builtin_scene(name);
        const RenderConfig config{.width = 64, .height = 48, .spp = 4, .seed = 5};
        Renderer renderer(run.device(), scene, config);
        renderer.render();
        images.compare_image(name + std::string(", denoised"), renderer.denoised(DenoiserKind::claray), config.width);
        for (int frame = 0; frame < 3; ++frame) {
            const auto bytes = as_floats(renderer.denoised_picture());
            images.compare(name + std::string(", frame ") + std::to_string(frame),
                           sums_of_blocks(bytes, config.width, 4, 8));
            scene.camera->position.x += 0.02f * glm::length(scene.camera->target - scene.camera->position);
            renderer.update(scene, {.camera = true});
            renderer.render();
        }
    }
    // Rough surfaces, textures and lenses, whose guides have noise, by common kernels.
    const char* const noisy[] = {"effect:depth-of-field", "effect:metal", "effect:rough-glass", "effect:textures"};
    RenderConfig common = small_image(4);
    for (const char* const name : noisy) common.effects.add = common.effects.add | effects_of(*builtin_scene(name));
    for (const char* const name : noisy) {
        Renderer renderer(run.device(), *builtin_scene(name), common);
        renderer.render();
        images.compare_image(name + std::string(", denoised"), renderer.denoised(DenoiserKind::claray), common.width);
    }
    const RenderConfig config{.width = 512, .height = 384, .spp = 1, .seed = 5};
    Renderer renderer(run.device(), *builtin_scene("spheres"), config);
    renderer.render();
    const auto image = renderer.denoised(DenoiserKind::claray);
    images.compare("spheres, denoised and large", sums_of_blocks({&image[0].x, 3 * image.size()}, config.width, 3, 32));
    images.check("sums of light");
}

void guided_images(Run& run) {
    Committed images(run);
    const ScopedTuning always(run.device(), "render/path_guide", "LEAST_GAIN_PERCENT", 1);
    const RenderConfig config{.width = 128, .height = 128, .spp = 24, .seed = 5};
    Renderer renderer(run.device(), *builtin_scene("cornell"), config);
    renderer.render();
    run.check("renders without guides", 1, renderer.statistics().guided ? 0 : 1, 0, "");
    const auto image = renderer.image();
    images.compare("cornell, guided", sums_of_blocks({&image[0].x, 3 * image.size()}, config.width, 3, 16));
    images.check("sums of light");
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
    maps.compare("a baked floor", sums_of_blocks(map.floats, map.width, map.channels, 4));
    maps.check("sums of light");
}

}  // namespace

Cases committed_cases() {
    return {
        {{"effect-images", "sameness", "Images of every effect have the committed light, by kernels with all effects"},
         effect_images},
        {{"bsdf-values", "sameness", "Materials have the committed samples, densities and values"}, bsdf_values},
        {{"own-images", "sameness", "Images by a scene's own kernels, with all that a film tells, are the committed ones"},
         own_images},
        {{"approximate-images", "sameness", "Sums of tiles, light grids and other approximations are the committed ones"},
         approximate_images},
        {{"denoised-images", "sameness", "Stills and frames without noise are the committed ones"}, denoised_images},
        {{"guided-images", "sameness", "Guided paths bring the committed light"}, guided_images},
        {{"baked-light", "sameness", "Light maps hold the committed light"}, baked_light},
    };
}

}  // namespace claray::verify
