// The device of a command.
#pragma once

#include "claray/device.hpp"

namespace claray::cli {

/// Device::open, with the warnings about the user's tuning tables on standard error.
[[nodiscard]] Device open_device(const std::string& selector = {});

}  // namespace claray::cli
