// Chooses the kernels with which a render begins, and those with which it continues once they are compiled. If the
// kernels of the scene's own effects are in the cache, a render begins with them; else with the generic kernels, which
// support every effect, if those are in the cache. On a machine where claray never ran it begins with quick kernels:
// the scene's effects over the binary tree, whose traversal compiles in a fraction of the time. If only shading must be
// compiled, that is done first. Meanwhile another process compiles, because a driver may hold a lock that stops all
// kernels while it compiles (PoCL does). All kernels make the same image bit for bit, except that quick kernels of many
// effects, which are not optimized, add up lights of lists in another order: their images differ by roundings.
#pragma once

#include <functional>

#include "claray/renderer.hpp"

namespace claray {

struct KernelChoice {
    EffectSet effects;
    Layout layout = Layout::automatic;
    bool operator==(const KernelChoice&) const = default;
};

struct KernelPlan {
    KernelStart start = KernelStart::own;
    KernelChoice first, last;
};

/// Returns what Builder::automatic stands for in a render; otherwise `builder`. Scenes with instances have one tree per
/// mesh, often many small ones, of which each takes `high` milliseconds on a GPU.
[[nodiscard]] Builder builder_for(Builder builder, const Device& device, bool instanced);

[[nodiscard]] KernelPlan plan_kernels(const Device& device, EffectSet effects, const RenderConfig& config);

/// Compiles kernels unless they are cached. Another process that compiles the same kernels waits for this one.
void compile_once(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                  const std::function<void()>& compile);

/// A digest of everything that the kernels of a render depend on. `part`: "all" of them, "trace" for queries and tree,
/// or the name of a kernel that follows paths.
[[nodiscard]] std::string key_of_kernels(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                                         const std::string& part = "all");

/// Returns whether all kernels of a render are in the cache, compiled on this machine by this claray.
[[nodiscard]] bool are_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config);
/// Records this, also for the tracing kernels, which other scenes share.
void remember_as_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config);

/// The same for a kernel that follows paths, which only some renders use.
[[nodiscard]] bool is_path_kernel_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                                         const std::string& name);
void remember_path_kernel_as_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                                    const std::string& name);

}  // namespace claray
