// The cost of each effect of a scene: renders with and without it, in alternating runs.
#pragma once

#include <functional>
#include <optional>

#include "claray/renderer.hpp"
#include "host/compute/programs/build_report.hpp"

namespace claray::measure {

/// A renderer of the scene for one set of effects.
struct Variant {
    double milliseconds = 0;  ///< device time of one frame: a sample for every pixel; of others than a scene's own
                              ///< kernels that of these times the ratio of pairs
    double compile_milliseconds = 0;
    std::optional<unsigned> registers, spill_bytes;  ///< of the shading kernel
    std::uint64_t bytes = 0;                         ///< device memory
};

struct ExplainedEffect {
    Effect effect{};
    bool called_for = false;
    EffectCause cause;                    ///< where it is called for
    bool fixed = false;                   ///< nothing can take its place: only Lambert
    Variant other;                        ///< the scene without it, or with it compiled in though nothing calls for it
    double own_compile_milliseconds = 0;  ///< of the same kernels as compiled for the scene
    double ratio = 1;    ///< time of `other` over that of the scene's own kernels, from pairs of frames
    bool noise = false;  ///< the pairs don't agree about which is slower
};

/// An approximation that the scene has a use for: tile-sum, if it has lights without extent.
struct ExplainedApproximation {
    Approximations approximate;
    double ratio = 1;    ///< time of a frame with it over that without it
    bool noise = false;  ///< the pairs don't agree about which is slower
    double error = 0;    ///< RMSE of its image over the mean of the true one, both of many samples per pixel
};

struct Explanation {
    Variant own;            ///< what the scene calls for and nothing else
    Variant full;           ///< everything compiled in, if ExplainOptions::everything
    double full_ratio = 1;  ///< as in ExplainedEffect
    bool full_noise = false;
    std::vector<ExplainedEffect> effects;
    std::vector<ExplainedApproximation> approximations;
};

struct ExplainOptions {
    EffectSet only = known_effects();                      ///< the effects to measure
    Approximations approximations = all_approximations();  ///< to measure where the scene has a use for them
    bool everything = true;                                ///< also measure kernels of all effects, compiled in
    int rounds = 7;                                        ///< pairs of short renders that are compared for each
    bool compile_times = true;                             ///< compile all kernels once more for their time
    std::optional<bool> compile_beside = {};               ///< in a context of their own; by default on GPUs
};
/// The rows of an explanation before measuring: which effects the scene uses, and where.
[[nodiscard]] std::vector<ExplainedEffect> effects_to_explain(const Scene& scene, const RenderConfig& config,
                                                              EffectSet only);
/// Compiles all kernels before it measures. `progress` receives what it does next.
[[nodiscard]] Explanation explain(const Device& device, const Scene& scene, const RenderConfig& config,
                                  const ExplainOptions& options,
                                  const std::function<void(const std::string&)>& progress = {});

/// The times of two renderers of the same size with the same samples, in alternating runs: milliseconds per sample of
/// every pixel, and the median of the rounds' ratios of the second to the first.
struct PairedTimes {
    double first = 0, second = 0, ratio = 1;
    bool noise = false;
};
/// True for fewer than five ratios, or if more than an eighth are on the other side of 1 than the rest. With 7 rounds
/// of two equally fast renderers, one comparison in 64 appears to be a difference.
[[nodiscard]] bool is_noise(const std::vector<double>& ratios);
[[nodiscard]] PairedTimes compare(const Device& device, Renderer& first, Renderer& second, int rounds);

}  // namespace claray::measure
