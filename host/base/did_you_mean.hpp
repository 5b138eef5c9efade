// Suggestions for misspelt names.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace claray {

/// " (did you mean 'depth'?)", with the name that the fewest changes make of `name`; empty if none is near: a third of
/// its letters may differ. Upper and lower case are the same.
[[nodiscard]] std::string did_you_mean(std::string_view name, std::span<const std::string> names);

}  // namespace claray
