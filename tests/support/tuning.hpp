// Tuning values for the length of a scope.
#pragma once

#include <string>

#include "host/compute/contexts.hpp"
#include "tests/support/device.hpp"

namespace claray::test {

/// Sets a tuning value of the test's device until the end of the scope.
struct ScopedTuning : claray::ScopedTuning {
    ScopedTuning(std::string kernel, std::string parameter, unsigned value)
        : claray::ScopedTuning(device(), std::move(kernel), std::move(parameter), value) {}
};

}  // namespace claray::test
