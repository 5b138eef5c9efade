// With which kernels a render begins, and with which it goes on once they are compiled. Where the kernels of the
// scene's own effects are in the cache, a render begins with them. Where they are not, but the generic ones are, which
// know every effect, it begins with those. On a machine where claray never ran it begins with the quick ones: the
// scene's effects over the binary tree, whose traversal compiles in a fraction of the time; where only shading is to be
// compiled, that is done first. Meanwhile another process compiles, for a driver may hold a lock that stops all kernels
// while it compiles (PoCL does). All of them make the same image bit for bit, so that nobody sees the change.
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

[[nodiscard]] KernelPlan plan_kernels(const Device& device, EffectSet effects, const RenderConfig& config);

/// Unless they are cached. Another process that is to compile the same waits for this one.
void compile_once(const Device& device, const KernelChoice& choice, const RenderConfig& config,
                  const std::function<void()>& compile);

/// Whether all of a render's kernels were compiled on this machine by this claray and kept in the cache.
[[nodiscard]] bool are_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config);
/// Says it of the kernels that trace, too, which other scenes share.
void remember_as_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config);

/// The same of the kernel that follows whole paths, which only some renders get to.
[[nodiscard]] bool is_path_kernel_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config);
void remember_path_kernel_as_cached(const Device& device, const KernelChoice& choice, const RenderConfig& config);

}  // namespace claray
