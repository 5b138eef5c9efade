#include "host/render/kernels/kernel_choice.hpp"

#include "host/base/hash.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/programs/kernel_sources.hpp"
#include "host/compute/programs/program_cache.hpp"
#include "host/effects/effects.hpp"
#include "host/render/guiding/path_guide.hpp"

namespace claray {
namespace {

Layout tuned_layout(const Device& device, Layout layout) {
    if (layout != Layout::automatic) return layout;
    return device.tuning("trace/closest_hit", "WIDE") != 0 ? Layout::wide : Layout::binary;
}

void remember(const Device& device, const KernelChoice& choice, const RenderConfig& config, const std::string& part) {
    const std::string text = part + " of " + to_string(choice.effects);
    store_cached_program(key_of_kernels(device, choice, config, part), {text.begin(), text.end()});
}

}  // namespace

Builder builder_for(Builder builder, const Device& device, bool instanced) {
    return builder == Builder::automatic && instanced ? Builder::balanced : resolve(builder, device);
}

std::string key_of_kernels(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                           const std::string& part) {
    const DeviceInfo& info = device.info();
    const bool lit = !(choice.effects & sampled_lights).empty();
    const EffectSet structure =
        choice.effects & EffectSet{Effect::instances, Effect::instance_motion, Effect::primitives};
    const EffectSet effects = part != "trace" ? choice.effects : structure | of_stage(choice.effects, Stage::trace);
    const Builder builder = builder_for(config.bvh.builder, device, structure.has(Effect::instances));
    std::string all = "renderer " + part + (lit ? " with shadows\n" : "\n") + info.platform + '\n' + info.name + '\n' +
                      info.driver + '\n' + info.version + '\n' + hash_of_kernel_sources() + '\n';
    for (const auto& [name, value] : state_of(device).tuning) all += name + ' ' + std::to_string(value) + '\n';
    for (const int value : {int(choice.layout), int(config.sampler), int(builder), int(config.bvh.morton_bits),
                            int(config.bvh.max_leaf_triangles), int(config.bvh.split_budget > 0)})
        all += std::to_string(value) + '\n';
    if (config.approximate.any()) all += to_string(config.approximate) + '\n';
    if (part == "all" && may_guide_paths(device, config)) all += "guided\n";
    return hash128(all + to_string(effects));
}

bool are_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config) {
    return load_cached_program(key_of_kernels(device, choice, config)).has_value();
}

void remember_as_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config) {
    for (const char* part : {"all", "trace"}) remember(device, choice, config, part);
}

bool is_path_kernel_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                           const std::string& name) {
    return load_cached_program(key_of_kernels(device, choice, config, name)).has_value();
}

void remember_path_kernel_as_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                                    const std::string& name) {
    remember(device, choice, config, name);
}

void compile_once(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                  const std::function<void()>& compile) {
    const CacheLock lock("renderers", key_of_kernels(device, choice, config));
    if (!are_cached(device, choice, config)) compile();
}

KernelPlan plan_kernels(const Device& device, EffectSet effects, const RenderConfig& config) {
    const KernelChoice own = {(effects | config.effects.add) - (config.effects.remove & aids),
                              tuned_layout(device, config.bvh.layout)};
    KernelPlan plan{KernelStart::own, own, own};
    if (config.compiler.empty() || are_cached(device, own, config)) return plan;
    const KernelChoice generic = {full_effects(), own.layout};
    const KernelChoice quick = {own.effects, config.bvh.layout == Layout::automatic ? Layout::binary : own.layout};
    const bool can_trace = load_cached_program(key_of_kernels(device, own, config, "trace")).has_value();
    // The generic kernels support neither.
    const bool special = effects.has(Effect::instances) || effects.has(Effect::primitives);
    if (!special && generic != own && are_cached(device, generic, config))
        plan.start = KernelStart::generic, plan.first = generic;
    else if (quick != own && !can_trace)
        plan.start = KernelStart::quick, plan.first = quick;
    return plan;
}

}  // namespace claray
