#include "host/render/kernels/kernel_choice.hpp"

#include "host/effects/effects.hpp"
#include "host/render/guiding/path_guide.hpp"
#include "host/render/kernels/stage_kernels.hpp"
#include "host/render/layers/light_layers.hpp"
#include "host/render/layers/matte.hpp"
#include "host/textures/cutouts.hpp"
#include "host/textures/texture_use.hpp"

namespace claray {
namespace {

constexpr EffectSet of_cutouts = {Effect::cut_outs, Effect::culling};

/// As SceneBuffers and Textures find them.
bool has_cutouts(const SceneTraits& scene, const RenderConfig& config) {
    const bool any = !(scene.effects & of_cutouts).empty() && !scene.culls_back_faces;
    return any || !(config.effects.add & of_cutouts).empty();
}

/// The programs of trees and queries.
KernelSet programs_of_tracing(const Device& device, const StageConfig& stages, const RenderConfig& config) {
    Bvh::Config tree = config.bvh;
    tree.builder = builder_for(tree.builder, device, stages.structure.has_instances);
    tree.layout = stages.structure.trees.wide ? Layout::wide : Layout::binary;
    KernelSet set = programs_of_structure(device, stages.structure, tree);
    set.add(programs_of_queries(device, stages));
    return set;
}

KernelChoice choice_of(const Device& device, const SceneTraits& scene, const RenderConfig& config, EffectSet effects) {
    const Layout layout = resolve(config.bvh.layout, device);
    const StageConfig stages = stages_for(device, scene, config, effects, layout);
    KernelChoice choice{effects, layout, programs_of_tracing(device, stages, config)};
    choice.programs.add(programs_of_paths(device, stages));
    if (config.alpha) choice.programs.add(Matte::programs(device, stages.structure));
    return choice;
}

}  // namespace

SceneTraits traits_of(const Scene& scene) {
    return {.effects = effects_of(scene),
            .culls_back_faces = culls_everywhere(scene, used_materials(scene)),
            .primitives = kinds_of_primitives(scene),
            .shaders = shaders_of(scene)};
}

Builder builder_for(Builder builder, const Device& device, bool instanced) {
    return builder == Builder::automatic && instanced ? Builder::balanced : resolve(builder, device);
}

StageConfig stages_for(const Device& device, const SceneTraits& scene, const RenderConfig& config, EffectSet effects,
                       Layout layout) {
    const bool instanced = scene.effects.has(Effect::instances);
    return {.effects = effects,
            .sampler = config.sampler,
            .task = path_task_of(config.approximate),
            .approximate = config.approximate,
            .structure = {.trees = {.wide = layout == Layout::wide,
                                    .moves = instanced && scene.effects.has(Effect::instance_motion),
                                    .cutouts = has_cutouts(scene, config)},
                          .has_instances = instanced,
                          .is_split = scene.is_split,
                          .primitives = scene.primitives},
            .culls_back_faces = scene.culls_back_faces,
            .is_lit = !(scene.effects & effects_with(CLARAY_SAMPLED)).empty(),
            .is_guided = may_guide_paths(device, config),
            .light_layers = light_layers_of(config),
            .shaders = shaders_with_kernels(device, scene.shaders, effects)};
}

KernelChoice scene_kernels(const Device& device, const SceneTraits& scene, const RenderConfig& config) {
    return choice_of(device, scene, config,
                     (scene.effects | config.effects.add) - (config.effects.remove & effects_with(CLARAY_AID)));
}

KernelChoice generic_kernels(const Device& device, const SceneTraits& scene, const RenderConfig& config) {
    return choice_of(device, scene, config, full_effects());
}

KernelPlan plan_kernels(const Device& device, const SceneTraits& scene, const RenderConfig& config) {
    const KernelChoice own = scene_kernels(device, scene, config);
    KernelPlan plan{KernelStart::own, own, own};
    if (config.compiler.empty() || are_cached(device, own.programs)) return plan;
    const StageConfig stages = stages_for(device, scene, config, own.effects, own.layout);
    const bool can_trace = are_cached(device, programs_of_tracing(device, stages, config));
    const Layout layout = config.bvh.layout == Layout::automatic ? Layout::binary : own.layout;
    StageConfig full = stages;
    full.effects = full_effects(), full.shaders = {};
    // The generic kernels support neither.
    const bool special = scene.effects.has(Effect::instances) || scene.effects.has(Effect::primitives);
    if (!special && full.effects != own.effects && are_cached(device, programs_of_paths(device, full)))
        plan.start = KernelStart::generic, plan.first = generic_kernels(device, scene, config);
    else if (layout != own.layout && !can_trace)
        plan.start = KernelStart::quick, plan.first = {own.effects, layout};
    return plan;
}

}  // namespace claray
