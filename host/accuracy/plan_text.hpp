// What planners say.
#pragma once

#include <cstdio>
#include <string>

#include "claray/target.hpp"

namespace claray {

template <class... Values>
[[nodiscard]] std::string told(const char* format, Values... values) {
    char text[320];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

/// "0.53 s", "2.1 min", "3.4 h", "12 days"
[[nodiscard]] std::string told_time(double seconds);

/// Sampler and tree for so many seconds of sampling; see plan_render.
void pick_for_time(TargetPlan& plan, const Device& device, double seconds);

}  // namespace claray
