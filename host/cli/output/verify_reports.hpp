// What `claray verify` found, for the programs that collect results of tests.
#pragma once

#include <span>
#include <string>

#include "claray/device.hpp"
#include "claray/verify.hpp"

namespace claray::cli {

/// The Test Anything Protocol, version 14 (testanything.org): a line for each case, and under a failed one what failed.
[[nodiscard]] std::string tap_of(std::span<const VerifyResult> results);

/// JUnit's XML, as build servers read it: a suite, and a test case for each case.
[[nodiscard]] std::string junit_of(const DeviceInfo& device, std::span<const VerifyResult> results);

}  // namespace claray::cli
