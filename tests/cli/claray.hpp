// Driving the built program.
#pragma once

#include <gtest/gtest.h>

#include "tests/support/process.hpp"

namespace claray::test {

/// `claray ARGUMENT...` on the device that the tests use.
[[nodiscard]] std::vector<std::string> claray_command(const std::vector<std::string>& arguments);
[[nodiscard]] ProcessResult run_claray(const std::vector<std::string>& arguments, const Variables& environment = {});

/// Until a render tells that every pixel has a sample: before, there is no image to stop with.
void wait_for_samples(const Process& render);

/// Passes where the program ended with this code and said `words` in a single line "claray: error: ...".
[[nodiscard]] testing::AssertionResult failed_with(const ProcessResult& result, int exit_code,
                                                   const std::string& words);

}  // namespace claray::test
