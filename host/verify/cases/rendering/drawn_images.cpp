// Images of scenes that are drawn at random. No value is known in closed form, but all devices and later versions must
// find the same light: a fault in a part that no other case calls for changes one of many scenes.
#include <algorithm>
#include <functional>

#include "claray/effects.hpp"
#include "host/effects/effects.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/committed.hpp"
#include "host/verify/cases/rendering/drawn_scene.hpp"
#include "host/verify/scenes.hpp"

namespace claray::verify {
namespace {

/// Effects of full kernels whose scenes are worked on in such lanes (claray/shared/lists/effects.h).
EffectSet effects_in_lanes(unsigned lanes) {
    static constexpr unsigned lanes_of[] = {
#define CLARAY_ROW(name, text, macro, bit, stages, in_lanes, ...) in_lanes,
#define CLARAY_OTHER_ROW(...) CLARAY_LANES_ALL,
        CLARAY_EFFECTS(CLARAY_ROW, CLARAY_OTHER_ROW, CLARAY_OTHER_ROW, CLARAY_OTHER_ROW)
#undef CLARAY_ROW
#undef CLARAY_OTHER_ROW
    };
    EffectSet set;
    for (const Effect effect : all_effects())
        if ((lanes_of[unsigned(effect)] & lanes) != 0) set.add(effect);
    return set & full_effects();
}

using Image = std::vector<glm::vec3>;

void append(Image& all, const Image& image) { all.insert(all.end(), image.begin(), image.end()); }

/// By kernels that have code for all of `effects`, so that all scenes share them.
RenderConfig config_with(EffectSet effects, std::uint64_t seed) {
    RenderConfig config = drawn_config(seed);
    config.effects.add = effects | effects_with(CLARAY_AID);
    return config;
}

Image drawn_image(const Run& run, std::uint64_t seed, EffectSet allowed, EffectSet effects) {
    return render(run, drawn_scene(seed, allowed), config_with(effects, seed));
}

constexpr std::uint64_t set_of_scenes = 16;
/// Each scene has other materials, and would have GPUs compile kernels for them.
const Form drawing = {"", {{"render/shade_surface", "SPLIT_FROM", 0}}};

struct Family {
    const char* name;
    EffectSet effects;
    std::uint64_t scenes;
};
/// The approximations know nothing of other effects.
const Family few_effects = {"few effects",
                            {Effect::smooth_normals, Effect::lambert, Effect::blinn_phong, Effect::textures,
                             Effect::emissive_triangles, Effect::point_lights, Effect::spot_lights,
                             Effect::directional_lights, Effect::light_falloff, Effect::sky, Effect::linear_ranges},
                            96};

/// Compilers take long for kernels with all effects, those of GPUs minutes.
std::vector<Family> families(const Run& run) {
    std::vector<Family> all = {few_effects};
    if (!run.full() && run.device().info().type != DeviceType::cpu) return all;
    all.push_back({"all effects", full_effects(), 320});
    all.push_back({"instances and primitives", known_effects(), 96});
    return all;
}

/// Compares the images of each set of a family, one after the other. One sampler halves the number of kernels.
void compare_family(const Run& run, Committed& images, const Family& family, Layout layout = Layout::automatic) {
    for (std::uint64_t first = 0; first < family.scenes; first += set_of_scenes) {
        Image all;
        for (std::uint64_t seed = first; seed < first + set_of_scenes; ++seed) {
            RenderConfig config = config_with(family.effects - EffectSet{Effect::instances, Effect::primitives}, seed);
            config.sampler = Sampler::sobol, config.bvh.layout = layout;
            append(all, render(run, drawn_scene(seed, family.effects), config));
        }
        images.compare(std::string("drawn scenes with ") + family.name + " from " + std::to_string(first), all);
    }
}

/// GPUs trace binary trees, and follow paths by one kernel.
void compare_as_gpus(const Run& run, Committed& images) {
    compare_family(run, images, {"all effects", full_effects(), 2 * set_of_scenes}, Layout::binary);
    for (const Form& form : {whole_paths(), last_paths()}) {
        const ScopedForm set(run.device(), form);
        compare_family(run, images, few_effects, Layout::binary);
    }
}

void drawn_images(Run& run) {
    const ScopedForm set(run.device(), drawing);
    Committed images(run);
    for (const Family& family : families(run)) compare_family(run, images, family);
    if (run.device().info().type == DeviceType::cpu) compare_as_gpus(run, images);
    images.check("sets of sixteen images");
}

/// Guides learn brightnesses of many orders here.
void drawn_guides(Run& run) {
    if (run.device().info().type != DeviceType::cpu) return run.fact("guides", "CPUs alone guide paths");
    const ScopedTuning always(run.device(), "render/path_guide", "LEAST_GAIN_PERCENT", 1);
    Image all;
    std::uint64_t guided = 0;
    for (std::uint64_t seed = 0; seed < 4 * set_of_scenes; ++seed) {
        RenderConfig config = config_with(few_effects.effects, seed);
        config.width = config.height = 128, config.spp = 20, config.adaptive = false;
        Renderer renderer(run.device(), drawn_scene(seed, few_effects.effects), config);
        render(renderer);
        guided += renderer.statistics().guided;
        append(all, renderer.image());
    }
    Committed images(run);
    images.compare("guided drawn scenes", all);
    images.check("sets of images");
    run.check("renders without guides", 4 * set_of_scenes, double(4 * set_of_scenes - guided), 3 * set_of_scenes, "");
}

/// The kernels of all effects work on single rays; they must find what lanes find.
void drawn_lanes(Run& run) {
    if (run.device().info().type != DeviceType::cpu) return run.fact("lanes", "CPUs alone work on sixteen rays");
    Committed images(run);
    for (const unsigned lanes : {CLARAY_LANES_SHADE, CLARAY_LANES_LISTS}) {
        const std::string name = lanes == CLARAY_LANES_SHADE ? "lanes" : "lanes of light lists";
        const EffectSet effects = effects_in_lanes(lanes);
        Tally same;
        for (std::uint64_t first = 0; first < 96; first += set_of_scenes) {
            Image all;
            for (std::uint64_t seed = first; seed < first + set_of_scenes; ++seed) {
                const Image image = drawn_image(run, seed, effects, effects);
                append(all, image);
                if (same.add(image == drawn_image(run, seed, effects, full_effects())))
                    run.failure("scene " + std::to_string(seed) + " has another image by " + name);
            }
            images.compare("drawn scenes by " + name + " from " + std::to_string(first), all);
        }
        run.check("images by " + name + " that differ from those by single rays", same, "images");
    }
    images.check("sets of sixteen images");
}

void add_pixels(std::vector<GBufferPixel>& all, const GBuffer& buffer) {
    all.insert(all.end(), buffer.pixels.begin(), buffer.pixels.end());
}

/// Results with their names.
using Hashes = std::vector<std::pair<std::string, std::string>>;

/// All but the image that a render gives.
Hashes other_results(const Run& run, const Device& on) {
    const EffectSet effects = few_effects.effects;
    Image filtered;
    std::vector<float> surfaces, noise;
    std::vector<GBufferPixel> packed;
    for (std::uint64_t seed = 0; seed < 2 * set_of_scenes; ++seed) {
        RenderConfig config = config_with(effects, seed);
        config.width = 40, config.height = 30;
        const Scene scene = drawn_scene(seed, effects);
        Renderer renderer(on, scene, config);
        render(renderer);
        append(filtered, renderer.denoised(DenoiserKind::claray));
        for (const float number : numbers_of(renderer.aovs())) surfaces.push_back(number);
        for (const float number : renderer.noise_map()) noise.push_back(number);
        if (!traits_of(scene.camera->projection)->flat) continue;
        for (const NormalPacking packing : {NormalPacking::octahedral, NormalPacking::spherical})
            add_pixels(packed, renderer.gbuffer(packing));
    }
    return {{of_kind(run, "drawn scenes, denoised"), hash_of(filtered)},
            {"surfaces of drawn scenes", hash_of(surfaces)},
            {"noise of drawn scenes", hash_of(noise)},
            {"packed surfaces of drawn scenes", hash_of(packed)}};
}

Hashes approximate_results(const Run& run, const Device& on, const Approximations& approximate) {
    const EffectSet effects = few_effects.effects;
    Image all;
    for (std::uint64_t seed = 0; seed < (approximate.tile_sum ? 4 : 1) * set_of_scenes; ++seed) {
        RenderConfig config = config_with(effects, seed);
        config.adaptive = false, config.approximate = approximate;
        config.light_grid = {.side = 4, .rays = 16, .updates = 2};
        if (approximate.tile_sum) config.width = 80, config.height = 48, config.spp = 1;
        Renderer renderer(on, drawn_scene(seed, effects), config);
        render(renderer);
        append(all, renderer.image());
    }
    return {{of_kind(run, "drawn scenes by " + to_string(approximate)), hash_of(all)}};
}

void drawn_results(Run& run) {
    using Piece = std::function<Hashes(const Device&)>;
    std::vector<Piece> pieces = {[&](const Device& on) { return other_results(run, on); }};
    for (const Approximations& approximate : {Approximations{.tile_sum = true}, Approximations{.light_grid = true}})
        pieces.push_back([&run, approximate](const Device& on) { return approximate_results(run, on, approximate); });
    std::vector<Hashes> found(pieces.size());
    run.side_by_side(pieces.size(), [&](const Device& on, std::size_t i) {
        const ScopedForm set(on, drawing);
        found[i] = pieces[i](on);
    });
    Committed results(run);
    for (const Hashes& hashes : found)
        for (const auto& [name, hash] : hashes) results.compare_hash(name, hash);
    results.check("sets of results");
}

}  // namespace

Cases drawn_cases() {
    return {
        {{"drawn-images", "sameness", "Images of scenes drawn at random have the committed light"}, drawn_images},
        {{"drawn-guides", "sameness", "Guided paths bring the committed light of scenes drawn at random"},
         drawn_guides},
        {{"drawn-lanes", "sameness", "Lanes find the light of single rays in scenes drawn at random"}, drawn_lanes},
        {{"drawn-results", "sameness",
          "Surfaces, noise, filtered and approximate images of scenes drawn at random are the committed ones"},
         drawn_results},
    };
}

}  // namespace claray::verify
