// Chooses the kernels with which a render begins, and those with which it continues once they are compiled: its own,
// those of all effects, or quick ones (docs/effects.md, "Kernels at the start of a render"). Another process compiles
// meanwhile. All make the same image bit for bit, but for quick kernels of many effects, which add up lists in another
// order.
#pragma once

#include "claray/renderer.hpp"
#include "host/compute/programs/kernel_set.hpp"

namespace claray {

struct StageConfig;

/// What kernels depend on in a scene.
struct SceneTraits {
    EffectSet effects = {};
    bool culls_back_faces = false;  // see Textures
    std::uint32_t primitives = 0;   // bits of their kinds
    bool is_split = false;          // into parts
    std::vector<EffectSet> shaders = {};
};
[[nodiscard]] SceneTraits traits_of(const Scene& scene);

/// Kernels of a render: the effects that they support, and the trees that they trace.
struct KernelChoice {
    EffectSet effects;
    Layout layout = Layout::automatic;
    KernelSet programs = {};  ///< without those of primitives; empty for quick kernels
    bool operator==(const KernelChoice&) const = default;
};

struct KernelPlan {
    KernelStart start = KernelStart::own;
    KernelChoice first, last;
};

/// Returns what Builder::automatic stands for in a render; otherwise `builder`. Scenes with instances have one tree per
/// mesh, often many small ones, of which each takes `high` milliseconds on a GPU.
[[nodiscard]] Builder builder_for(Builder builder, const Device& device, bool instanced);

/// The stages' kernels that support these effects, over trees that the device builds in this layout.
[[nodiscard]] StageConfig stages_for(const Device& device, const SceneTraits& scene, const RenderConfig& config,
                                     EffectSet effects, Layout layout);
/// The kernels of the scene's own effects.
[[nodiscard]] KernelChoice scene_kernels(const Device& device, const SceneTraits& scene, const RenderConfig& config);
/// Those that support all effects, for scenes without instances and primitives.
[[nodiscard]] KernelChoice generic_kernels(const Device& device, const SceneTraits& scene, const RenderConfig& config);

[[nodiscard]] KernelPlan plan_kernels(const Device& device, const SceneTraits& scene, const RenderConfig& config);

}  // namespace claray
