// claray.h: renderers.
#include "host/capi/renderer.hpp"

#include "host/capi/members.hpp"
#include "host/capi/scene.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

claray_progress progress_of(const RenderProgress& p) {
    auto progress = put_into<claray_progress>(p);
    progress.struct_size = sizeof progress;
    progress.error_is_sure = p.error_is_sure() ? 1 : 0;
    return progress;
}

SceneChanges changes_of(std::uint32_t bits) {
    constexpr std::uint32_t all = 2 * CLARAY_CHANGED_VERTICES - 1;
    if ((bits & ~all) != 0) refuse("changes is " + std::to_string(bits), "use bits of claray_scene_changes");
    SceneChanges changes;
    changes.camera = (bits & CLARAY_CHANGED_CAMERA) != 0;
    changes.lights = (bits & CLARAY_CHANGED_LIGHTS) != 0;
    changes.materials = (bits & CLARAY_CHANGED_MATERIALS) != 0;
    changes.sky = (bits & CLARAY_CHANGED_SKY) != 0;
    changes.instances = (bits & CLARAY_CHANGED_INSTANCES) != 0;
    changes.vertices = (bits & CLARAY_CHANGED_VERTICES) != 0;
    return changes;
}

std::vector<std::string> parts_of(const std::string& text, char at) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size(); begin += parts.back().size() + 1)
        parts.push_back(text.substr(begin, text.find(at, begin) - begin));
    return parts;
}

/// Calls `use` with the renderer of the handle.
template <class Use>
claray_status with_renderer(claray_renderer* renderer, const Use& use) {
    return guarded([&] { use(required(renderer, "renderer").renderer); });
}

}  // namespace

namespace claray::capi {

RenderConfig render_config_of(const claray_render_config* given) {
    const claray_render_config known = versioned(given, "config");
    RenderConfig config;
    visit_pairs(known, config, TakeGiven{"config"});
    config.guide = known.no_guide == 0;
    config.region = {known.region[0], known.region[1], known.region[2], known.region[3]};
    if (known.bvh) config.bvh = config_of(known.bvh);
    if (known.effects) config.effects = parse_effect_overrides(known.effects);
    if (known.approximate) config.approximate = parse_approximations(known.approximate);
    if (known.light_groups) config.light_groups = parts_of(known.light_groups, ';');
    if (known.light_grid)
        visit_pairs(versioned(known.light_grid, "light_grid"), config.light_grid, TakeGiven{"light_grid"});
    return config;
}

claray_render_config render_config_of(const RenderConfig& config, ConfigTexts& texts) {
    auto known = put_into<claray_render_config>(config);
    known.no_guide = config.guide ? 0 : 1;
    const Region& region = config.region;
    known.region[0] = region.x, known.region[1] = region.y;
    known.region[2] = region.width, known.region[3] = region.height;
    texts.bvh = config_of(config.bvh), known.bvh = &texts.bvh;
    texts.light_grid = put_into<claray_light_grid_config>(config.light_grid), known.light_grid = &texts.light_grid;
    texts.light_grid.struct_size = sizeof texts.light_grid;
    for (const Effect effect : all_effects()) {
        const char* sign = config.effects.add.has(effect) ? "+" : config.effects.remove.has(effect) ? "-" : nullptr;
        if (sign) texts.effects += (texts.effects.empty() ? "" : ",") + std::string(sign) + name_of(effect);
    }
    if (!texts.effects.empty()) known.effects = texts.effects.c_str();
    if (config.approximate.any()) {
        texts.approximate = to_string(config.approximate);
        known.approximate = texts.approximate.c_str();
    }
    for (const std::string& group : config.light_groups)
        texts.light_groups += (texts.light_groups.empty() ? "" : ";") + group;
    if (!texts.light_groups.empty()) known.light_groups = texts.light_groups.c_str();
    return known;
}

void report(const Render& render, claray_progress_callback callback, void* user, claray_progress* reached) {
    if (reached) static_cast<void>(struct_size(*reached, "reached"));
    const auto call = [&](const RenderProgress& p) {
        const claray_progress progress = progress_of(p);
        return callback(&progress, user) != 0;
    };
    const RenderProgress progress = render(callback ? std::function<bool(const RenderProgress&)>(call) : nullptr);
    if (reached) give(reached, progress_of(progress), "reached");
}

}  // namespace claray::capi

claray_status claray_renderer_create(claray_device* device, const claray_scene* scene,
                                     const claray_render_config* config, claray_renderer** renderer) {
    return guarded([&] {
        const RenderConfig known = render_config_of(config);
        hand_out(renderer, "renderer", [&] {
            return new claray_renderer{
                known.image_width(),
                known.image_height(),
                Renderer(required(device, "device").device, required(scene, "scene").scene, known),
                {},
                {},
                {},
                {}};
        });
    });
}

claray_status claray_renderer_render(claray_renderer* renderer, claray_progress_callback callback, void* user,
                                     claray_progress* reached) {
    return with_renderer(renderer, [&](Renderer& used) {
        report([&](const auto& progress) { return used.render(progress); }, callback, user, reached);
    });
}

claray_status claray_renderer_render_for(claray_renderer* renderer, double seconds, claray_progress_callback callback,
                                         void* user, claray_progress* reached) {
    return with_renderer(renderer, [&](Renderer& used) {
        report([&](const auto& progress) { return used.render_for(seconds, progress); }, callback, user, reached);
    });
}

claray_status claray_renderer_restart(claray_renderer* renderer, uint32_t seed, uint32_t spp, uint32_t max_depth) {
    return with_renderer(renderer, [&](Renderer& used) { used.restart(seed, spp, max_depth); });
}

claray_status claray_renderer_update(claray_renderer* renderer, const claray_scene* scene, uint32_t changes) {
    return with_renderer(renderer,
                         [&](Renderer& used) { used.update(required(scene, "scene").scene, changes_of(changes)); });
}

claray_status claray_renderer_settle(claray_renderer* renderer) {
    return with_renderer(renderer, [](Renderer& used) { used.settle(); });
}

claray_status claray_renderer_load_kernels(claray_renderer* renderer) {
    return with_renderer(renderer, [](Renderer& used) { used.load_kernels(); });
}

claray_status claray_renderer_resize(claray_renderer* renderer, uint32_t width, uint32_t height) {
    return with_renderer(renderer, [&](Renderer& used) {
        used.resize(width, height);
        renderer->width = width, renderer->height = height;
    });
}

claray_status claray_renderer_size(const claray_renderer* renderer, uint32_t* width, uint32_t* height) {
    return guarded([&] {
        const claray_renderer& of = required(renderer, "renderer");
        required(width, "width") = of.width, required(height, "height") = of.height;
    });
}

claray_status claray_renderer_rebuild(claray_renderer* renderer, const claray_bvh_config* config, int* rebuilt) {
    return with_renderer(renderer, [&](Renderer& used) {
        const bool done = used.rebuild(config_of(config));
        if (rebuilt) *rebuilt = done ? 1 : 0;
    });
}

claray_status claray_renderer_cut_off(const claray_renderer* renderer, double* cut_off) {
    return guarded([&] { required(cut_off, "cut_off") = required(renderer, "renderer").renderer.cut_off(); });
}

claray_status claray_approximation_error(claray_renderer* approximate, claray_renderer* exact, double* error) {
    return guarded([&] {
        required(error, "error") =
            approximation_error(required(approximate, "approximate").renderer, required(exact, "exact").renderer);
    });
}

claray_status claray_renderer_statistics_get(claray_renderer* renderer, claray_bvh_statistics* bvh,
                                             claray_render_statistics* statistics) {
    return guarded([&] {
        claray_renderer& of = required(renderer, "renderer");
        of.statistics = of.renderer.statistics();
        of.effects = to_string(of.statistics.effects);
        of.why_unguided = of.renderer.why_unguided();
        of.checkpoint_error = of.renderer.checkpoint_error();
        auto known = put_into<claray_render_statistics>(of.statistics);
        known.effects = of.effects.c_str();
        known.why_unguided = of.why_unguided.c_str();
        known.checkpoint_error = of.checkpoint_error.c_str();
        give(statistics, known, "statistics");
        if (bvh) give(bvh, put_into<claray_bvh_statistics>(of.statistics.bvh), "bvh");
    });
}

void claray_renderer_release(claray_renderer* renderer) { delete renderer; }
