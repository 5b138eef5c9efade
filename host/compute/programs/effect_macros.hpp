// The macros of effects (claray/shared/lists/effects.h) in kernels that are compiled for no scene.
#pragma once

#include <functional>

#include "claray/program.hpp"

namespace claray {

/// Adds those that are needed and not given: 1, so that a kernel has code for all effects, but 0 for those that the
/// structure brings that is traced.
void add_effect_macros(Defines& defines, const std::function<bool(const std::string&)>& is_needed);

}  // namespace claray
