// What came of the user's tuning tables.
#pragma once

#include <string>
#include <vector>

#include "claray/device.hpp"

namespace claray {

/// Rows of the user's tuning tables that were ignored when the device was opened, since they name no tuning parameter,
/// or a value that does not work: file, line and remedy, a line each.
[[nodiscard]] std::vector<std::string> tuning_warnings(const Device& device);

}  // namespace claray
