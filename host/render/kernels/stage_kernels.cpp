#include "host/render/kernels/stage_kernels.hpp"

#include "host/compute/tuning.hpp"
#include "host/render/film/film.hpp"
#include "host/render/guiding/path_guide.hpp"

namespace claray {
namespace {

void append(Defines& to, const Defines& more) { to.insert(to.end(), more.begin(), more.end()); }

Defines defines_for(const StageConfig& config, Stage stage) {
    Defines defines = defines_of(config.effects, stage);
    append(defines, config.structure.defines());
    defines.emplace_back("SAMPLER", std::to_string(std::uint32_t(config.sampler)));
    return defines;
}

/// Macros of shading set by the tuning table, for tests and studies.
Defines macros_of_shading(const Device& device) {
    Defines macros = with_tuning(device, "render/shade_surface", {});
    std::erase_if(macros, [](const auto& m) { return m.first == "GROUP_SIZE" || m.first == "PATHS_PER_ITEM"; });
    return macros;
}

/// Macros of approximations other than PathTask. Without shadows, lamps are found by light sampling alone, since rays
/// that bounce cannot pass through surfaces.
Defines defines_of(const Approximations& approximate) {
    Defines defines;
    if (approximate.flat) defines.emplace_back("SHADING", "CLARAY_FLAT");
    if (approximate.gouraud) defines.emplace_back("SHADING", "CLARAY_GOURAUD");
    if (approximate.no_shadows) defines.emplace_back("TECHNIQUES", "1");
    return defines;
}

/// Surfaces of other scenes are never shaded by sixteen (PLAIN_IN_LANES): with the macro the same kernel would be
/// compiled a second time.
bool may_shade_sixteen(EffectSet effects) {
    return (effects.has(Effect::lambert) || effects.has(Effect::principled) || effects.has(Effect::metal)) &&
           have_lanes(effects, CLARAY_LANES_SHADE);
}

/// Of the stages that shade.
Defines defines_of_shading(const Device& device, const StageConfig& config) {
    Defines defines = defines_for(config, Stage::shade);
    if (config.task == PathTask::bake) defines.emplace_back("BAKE", "1");
    if (config.task == PathTask::light_grid) defines.emplace_back("LIGHT_GRID", "1");
    if (config.is_guided) defines.emplace_back("PATH_GUIDE", "1");
    if (config.light_layers > 0) defines.emplace_back("LIGHT_LAYERS", "1");
    append(defines, defines_of(config.approximate));
    // On CPUs the binary tree is used for a quick start, when long compilation does not pay. Light is split hit by hit.
    if ((config.structure.is_one_binary_tree() || config.light_layers > 0) && may_shade_sixteen(config.effects))
        defines.emplace_back("SIXTEEN", "0");
    if (config.task == PathTask::sum_tiles) append(defines, macros_of_shading(device));
    return defines;
}

bool shadow_rays_add_light(const Device& device, const StageConfig& config) {
    return config.light_layers == 0 && !config.approximate.no_shadows && config.structure.is_one_binary_tree() &&
           device.tuning("render/add_light", "WITH_SHADOW_RAYS") != 0;
}

KernelsOf<LightGridKernels> kernels_of_light_grid(const StageConfig& config) {
    Defines shading = defines_for(config, Stage::shade);
    shading.emplace_back("LIGHT_GRID", "1");
    return LightGridKernels::requests(defines_for(config, Stage::generate), shading);
}

KernelsOf<WavefrontKernels> kernels_of(const Device& device, const StageConfig& config) {
    using Kernels = WavefrontKernels;
    KernelsOf<Kernels> kernels = {{&Kernels::empty_queues, {"render/queues/empty_queues.cl", "empty_queues", {}}}};
    if (config.task == PathTask::bake)
        kernels.push_back({&Kernels::generate, {"render/generate_texels.cl", "generate_texels", {}}});
    else
        kernels.push_back(
            {&Kernels::generate, {"render/generate_rays.cl", "generate_rays", defines_for(config, Stage::generate)}});
    if (config.task == PathTask::sum_tiles) return kernels;
    if (!config.shaders.empty())
        kernels.push_back({&Kernels::sort, {"render/queues/sort_hits.cl", "sort_hits", config.structure.defines()}});
    if (config.is_lit && config.light_layers > 0)
        kernels.push_back({&Kernels::add_light, {"render/layers/add_light_layers.cl", "add_light_layers", {}}});
    else if (config.is_lit && !shadow_rays_add_light(device, config))
        kernels.push_back({&Kernels::add_light, {"render/add_light.cl", "add_light", {}}});
    return kernels;
}

/// One kernel for all surfaces, or one for each of the shaders.
std::vector<KernelRequest> kernels_of_surfaces(const Device& device, const StageConfig& config) {
    std::vector<KernelRequest> kernels;
    const auto add = [&](const StageConfig& with) {
        kernels.push_back({"render/shade_surface.cl", "shade_surface", defines_of_shading(device, with)});
    };
    if (config.task == PathTask::sum_tiles) return kernels;
    if (config.shaders.empty()) add(config);
    for (const EffectSet shader : config.shaders) {
        StageConfig with = config;
        with.effects = (config.effects - effects_with(CLARAY_OF_BSDF)) | shader;
        add(with);
        kernels.back().defines.emplace_back("SORTED", "1");
    }
    return kernels;
}

/// A query of the stages.
struct StageQuery {
    SceneQuery WavefrontKernels::*member;
    const char* name;
    QueryKind kind;
    Coherence coherence;
    const char* file = "";
};

std::vector<StageQuery> queries_of(const Device& device, const StageConfig& config) {
    using Kernels = WavefrontKernels;
    std::vector<StageQuery> queries = {
        {&Kernels::trace_camera, trace_camera_name, QueryKind::closest, Coherence::coherent}};
    if (config.task == PathTask::sum_tiles) return queries;
    queries.push_back({&Kernels::trace_bounce, trace_bounce_name, QueryKind::closest, Coherence::incoherent});
    if (config.is_lit && !config.approximate.no_shadows)
        queries.push_back({&Kernels::trace_shadow, trace_shadow_name, QueryKind::any, Coherence::automatic,
                           shadow_rays_add_light(device, config) ? "render/trace_shadow_rays.cl" : ""});
    return queries;
}

QueryOptions options_of(const StageQuery& query, const StageConfig& config) {
    QueryOptions options;
    options.coherence = query.coherence, options.cull_back_faces = config.culls_back_faces;
    return options;
}

}  // namespace

std::vector<EffectSet> shaders_with_kernels(const Device& device, const std::vector<EffectSet>& shaders,
                                            EffectSet effects) {
    const unsigned from = device.tuning("render/shade_surface", "SPLIT_FROM");
    EffectSet needed;
    for (const EffectSet shader : shaders) needed = needed | shader;
    const bool pays = from > 0 && shaders.size() > 1 && number_of(of_stage(effects, Stage::shade)) >= from;
    return pays && (effects & effects_with(CLARAY_OF_BSDF)) == needed ? shaders : std::vector<EffectSet>{};
}

StageConfig stages_of(const SceneBuffers& scene, Sampler sampler, EffectSet effects, const Approximations& approximate,
                      unsigned light_layers) {
    return {.effects = effects,
            .sampler = sampler,
            .task = path_task_of(approximate),
            .approximate = approximate,
            .structure = scene.structure.format(),
            .culls_back_faces = scene.textures.culls_back_faces,
            .is_lit = has_lights(scene.lights),
            .is_guided = scene.where.guide != CLARAY_NO_TABLE,
            .light_layers = light_layers,
            .shaders = shaders_with_kernels(scene.structure.device(), scene.shaders, effects)};
}

KernelSet programs_of_queries(const Device& device, const StageConfig& config) {
    KernelSet set;
    for (const StageQuery& query : queries_of(device, config))
        set.add(programs_of_query(device, config.structure, query.kind, options_of(query, config), query.file));
    return set;
}

KernelSet programs_of_paths(const Device& device, const StageConfig& config) {
    KernelSet set = programs_of(device, kernels_of(device, config));
    for (const KernelRequest& kernel : kernels_of_surfaces(device, config)) set.add(device, kernel);
    set.add(programs_of(device, Film::Kernels::requests()));
    if (config.is_guided) set.add(PathGuide::programs(device));
    if (config.light_layers > 0) set.add(device, kernel_of_layers());
    if (config.task == PathTask::light_grid) set.add(programs_of(device, kernels_of_light_grid(config)));
    if (config.task == PathTask::sum_tiles)
        set.add(programs_of(device, TileSum::kernels(device, config.structure, defines_of_shading(device, config))));
    return set;
}

KernelSet programs_of_stages(const Device& device, const StageConfig& config) {
    KernelSet set = programs_of_paths(device, config);
    set.add(programs_of_queries(device, config));
    return set;
}

bool StageConfig::supports(const SceneBuffers& scene) const {
    return effects.contains(scene.effects) && (!has_lights(scene.lights) || is_lit || task == PathTask::sum_tiles) &&
           (shaders.empty() || shaders == scene.shaders);
}

WavefrontKernels::WavefrontKernels(const SceneBuffers& scene, const StageConfig& with) : config(with) {
    const Device& device = scene.structure.device();
    load(device, kernels_of(device, config), *this);
    for (const KernelRequest& kernel : kernels_of_surfaces(device, config))
        shade.push_back(load_kernel(device, kernel));
    for (const StageQuery& query : queries_of(device, config))
        this->*query.member =
            SceneQuery(scene.structure, query.kind, options_of(query, config), query.name, query.file);
    if (config.task == PathTask::light_grid) load(device, kernels_of_light_grid(config), light_grid.emplace());
    if (config.task == PathTask::sum_tiles) {
        tile_sum.emplace(scene, defines_of_shading(device, config),
                         config.approximate.flat || config.approximate.gouraud);
        return;
    }
    adds_light = config.is_lit && shadow_rays_add_light(device, config);
}

PathTask path_task_of(const Approximations& approximate) {
    if (approximate.tile_sum) return PathTask::sum_tiles;
    return approximate.light_grid ? PathTask::light_grid : PathTask::render;
}

/// From render/trace_paths.cl or render/finish_paths.cl.
KernelRequest kernel_of_layers() { return {"render/layers/accumulate_layers.cl", "accumulate_layers", {}}; }

KernelRequest kernel_of_paths(const Device& device, const StageConfig& config, const std::string& name) {
    Defines defines = defines_for(config, Stage::shade);
    append(defines, defines_of(config.effects, Stage::generate));
    append(defines, config.structure.trees.defines());
    append(defines, macros_of_shading(device));
    if (config.task == PathTask::light_grid) defines.emplace_back("LIGHT_GRID", "1");
    if (config.culls_back_faces) defines.emplace_back("CULL_BACK_FACES", "1");
    return {"render/" + name + ".cl", name, defines};
}

}  // namespace claray
