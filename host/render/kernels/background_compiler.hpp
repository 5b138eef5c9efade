// Compiles kernels in a process of low priority while a render uses other kernels.
#pragma once

#include "host/render/kernels/kernel_choice.hpp"

namespace claray {

/// Starts `claray compile` for a choice and then for the generic kernels, in a separate process that has low priority
/// from its start. It continues after this process ends, so that the next render finds its results. One runs at a time
/// per cache folder: returns false if another is running; call again later. Does nothing and returns true if the
/// program cannot be started or the cache cannot be written.
[[nodiscard]] bool start_compiler(const std::string& program, const Device& device, const KernelChoice& choice,
                                  const RenderConfig& config);

/// In such a process, before work that can wait: lets others start a compiler meanwhile.
void let_others_compile();

/// Whether a compiler runs that this process has started.
[[nodiscard]] bool is_compiling();

}  // namespace claray
