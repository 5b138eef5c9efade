// Driving the built program.
#pragma once

#include <gtest/gtest.h>

#include "tests/support/process.hpp"

namespace claray::test {

/// `claray ARGUMENT...` on the device that the tests use.
[[nodiscard]] std::vector<std::string> claray_command(const std::vector<std::string>& arguments);
[[nodiscard]] ProcessResult run_claray(const std::vector<std::string>& arguments, const Variables& environment = {});

[[nodiscard]] std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more);

/// A test whose files lie in a new folder.
class InFolder : public testing::Test {
protected:
    [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
    TemporaryFolder folder_;
};

/// A PFM file's values, row by row as stored; empty where the file is none.
[[nodiscard]] std::vector<float> read_pfm(const std::string& path, std::size_t channels);

/// Until a render tells that every pixel has a sample: before, there is no image to stop with.
void wait_for_samples(const Process& render);

/// Passes where the program ended with this code and said `words` in a single line "claray: error: ...".
[[nodiscard]] testing::AssertionResult failed_with(const ProcessResult& result, int exit_code,
                                                   const std::string& words);

}  // namespace claray::test
