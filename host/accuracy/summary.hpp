// What a newcomer should know of a scene first.
#pragma once

#include "claray/accuracy.hpp"

namespace claray {

/// How many samples an error of 1 % takes, from the study `sampling`, and how many surfaces paths must meet for it,
/// from the study `bias`. Of studies that are not there it tells nothing.
[[nodiscard]] std::vector<std::string> summary_of(const std::vector<Study>& studies);

}  // namespace claray
