// Tuning values for the length of a scope.
#pragma once

#include <string>

#include "tests/support/device.hpp"

namespace claray::test {

/// Sets a tuning value of the test's device until the end of the scope.
class ScopedTuning {
public:
    ScopedTuning(std::string kernel, std::string parameter, unsigned value)
        : kernel_(std::move(kernel)), parameter_(std::move(parameter)), before_(device().tuning(kernel_, parameter_)) {
        device().set_tuning(kernel_, parameter_, value);
    }
    ~ScopedTuning() { device().set_tuning(kernel_, parameter_, before_); }
    ScopedTuning(const ScopedTuning&) = delete;
    ScopedTuning& operator=(const ScopedTuning&) = delete;

private:
    std::string kernel_, parameter_;
    unsigned before_;
};

}  // namespace claray::test
