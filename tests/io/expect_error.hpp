// What tests of readers share: their folder and warnings, and checks of claray::Error: kind, content, and that it is
// one line.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <algorithm>

#include "claray/error.hpp"
#include "claray/io.hpp"
#include "tests/support/process.hpp"

namespace claray::test {

class ReaderTest : public ::testing::Test {
protected:
    /// How many warnings hold these words.
    [[nodiscard]] std::size_t warned(const std::string& words) const {
        return std::size_t(std::count_if(warnings.begin(), warnings.end(), [&](const std::string& line) {
            return line.find(words) != std::string::npos;
        }));
    }

    /// The scene of a file with this content, which is sound. `warnings` has those of this file only.
    [[nodiscard]] Scene load_text(const std::string& name, const std::string& text) {
        warnings.clear();
        Scene scene = load_scene(folder.file(name, text).string(), warnings);
        validate(scene);
        return scene;
    }

    TemporaryFolder folder;
    Warnings warnings;
};

/// `action` throws an Error of `kind` whose one line holds every one of `words`.
template <class Action>
void expect_error(ErrorKind kind, const std::vector<std::string>& words, Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        const std::string text = error.what();
        EXPECT_EQ(int(error.kind()), int(kind)) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
        return;
    }
    ADD_FAILURE() << "no error was thrown";
}

}  // namespace claray::test
