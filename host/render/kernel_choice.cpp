#include "host/render/kernel_choice.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host/compute/device_state.hpp"
#include "host/compute/hash.hpp"
#include "host/compute/kernel_sources.hpp"
#include "host/compute/program_cache.hpp"
#include "host/render/effects.hpp"

extern char** environ;

namespace claray {
namespace {

Layout tuned_layout(const Device& device, Layout layout) {
    if (layout != Layout::automatic) return layout;
    return device.tuning("trace/closest_hit", "WIDE") != 0 ? Layout::wide : Layout::binary;
}

/// Of all that the kernels depend on.
std::string key_of(const Device& device, const KernelChoice& choice, const RenderConfig& config) {
    const DeviceInfo& info = device.info();
    std::string all = "renderer\n" + info.platform + '\n' + info.name + '\n' + info.driver + '\n' + info.version + '\n';
    for (const KernelSource& source : kernel_sources()) all += source.path + '\n' + source.text + '\n';
    for (const auto& [name, value] : device.state().tuning) all += name + ' ' + std::to_string(value) + '\n';
    for (const int value : {int(choice.layout), int(config.sampler), int(config.bvh.builder),
                            int(config.bvh.morton_bits), int(config.bvh.max_leaf_triangles),
                            int(config.bvh.split_budget > 0), int(config.bvh.optimization_rounds > 0)})
        all += std::to_string(value) + '\n';
    return hash128(all + to_string(choice.effects));
}

}  // namespace

bool are_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config) {
    return load_cached_program(key_of(device, choice, config)).has_value();
}

void remember_as_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config) {
    const std::string text = to_string(choice.effects);
    store_cached_program(key_of(device, choice, config), {text.begin(), text.end()});
}

KernelPlan plan_kernels(const Device& device, EffectSet effects, const RenderConfig& config) {
    const KernelChoice own = {(effects | config.effects.add) - (config.effects.remove & aids),
                              tuned_layout(device, config.bvh.layout)};
    KernelPlan plan{KernelStart::own, own, own};
    if (config.compiler.empty() || are_cached(device, own, config)) return plan;
    const KernelChoice generic = {full_effects(), own.layout};
    const KernelChoice quick = {own.effects, config.bvh.layout == Layout::automatic ? Layout::binary : own.layout};
    if (generic != own && are_cached(device, generic, config))
        plan.start = KernelStart::generic, plan.first = generic;
    else if (quick != own)
        plan.start = KernelStart::quick, plan.first = quick;
    return plan;
}

void CompileProcess::start(const std::string& program, const Device& device, const KernelChoice& choice,
                           const RenderConfig& config) {
    std::vector<std::string> arguments = {program,
                                          "compile",
                                          "--quiet",
                                          "--device",
                                          std::to_string(device.info().index),
                                          "--effects",
                                          to_string(choice.effects),
                                          "--layout",
                                          choice.layout == Layout::wide ? "wide" : "binary",
                                          "--morton-bits",
                                          std::to_string(config.bvh.morton_bits),
                                          "--builder",
                                          config.bvh.builder == Builder::fast       ? "fast"
                                          : config.bvh.builder == Builder::balanced ? "balanced"
                                                                                    : "high"};
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    pid_t id = 0;
    if (::posix_spawn(&id, program.c_str(), nullptr, nullptr, pointers.data(), environ) == 0) id_ = id;
}

bool CompileProcess::finished() {
    int status = 0;
    if (id_ == 0 || ::waitpid(id_, &status, WNOHANG) != id_) return false;
    id_ = 0;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace claray
