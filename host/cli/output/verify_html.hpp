// The report of `claray verify` as one HTML file, with a picture of the worst case of every failure.
#pragma once

#include <span>
#include <string>

#include "claray/verify.hpp"

namespace claray::cli {

[[nodiscard]] std::string html_of(const DeviceInfo& device, std::span<const VerifyResult> results);

}  // namespace claray::cli
