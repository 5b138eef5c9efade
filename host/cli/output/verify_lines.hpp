// What commands print that run cases of `verify`.
#pragma once

#include <vector>

#include "claray/verify.hpp"

namespace claray::cli {

/// The device, and the names of the columns.
void print_head(const DeviceInfo& device);
/// The figures of a case, and what is wrong.
void print_result(const VerifyResult& result);
/// Which cases run each kernel.
void print_kernels(const std::vector<VerifyResult>& results);

}  // namespace claray::cli
