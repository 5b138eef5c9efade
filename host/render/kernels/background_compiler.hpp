// A process of low priority that compiles kernels while a render goes on with others.
#pragma once

#include "host/render/kernels/kernel_choice.hpp"

namespace claray {

/// `claray compile` for a choice and then for the generic kernels, in a process of its own that has low priority from
/// its first instruction. It goes on when this process ends: the next render finds its work. One runs at a time for a
/// cache folder: returns false where another is running, so that it can be asked for later. Does nothing, and returns
/// true, where the program can't be started or the cache can't be written to.
[[nodiscard]] bool start_compiler(const std::string& program, const Device& device, const KernelChoice& choice,
                                  const RenderConfig& config);

}  // namespace claray
