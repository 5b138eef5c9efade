// What planners say.
#pragma once

#include "claray/target.hpp"
#include "host/accuracy/study.hpp"

namespace claray {

/// Sampler and tree for so many seconds of sampling; see plan_render.
void pick_for_time(TargetPlan& plan, const Device& device, double seconds);

}  // namespace claray
