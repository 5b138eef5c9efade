// What the cases found, for programs that read results of tests. No library is needed.
#pragma once

#include <span>
#include <string>

#include "claray/device.hpp"
#include "claray/verify.hpp"

namespace claray::verify {

/// The Test Anything Protocol, version 14 (testanything.org): a line for each case, and under a failed one what failed.
[[nodiscard]] std::string tap_of(std::span<const VerifyResult> results);

/// JUnit's XML, as build servers read it: a suite, and a test case for each case.
[[nodiscard]] std::string junit_of(const DeviceInfo& device, std::span<const VerifyResult> results);

/// JSON, two blanks a level. `seconds` is the duration of all cases. Figures that are not finite are null.
[[nodiscard]] std::string json_of(const DeviceInfo& device, const VerifyOptions& options,
                                  std::span<const VerifyResult> results, double seconds);
/// The same for one case.
[[nodiscard]] std::string json_of(const VerifyResult& result, bool kernels = false);

}  // namespace claray::verify
