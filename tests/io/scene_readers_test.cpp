// The table of formats: each row can be reached, and messages name all of it.
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "host/io/scene_readers.hpp"
#include "tests/io/expect_error.hpp"

namespace claray {
namespace {

using test::expect_error;
using SceneReaders = test::ReaderTest;

std::vector<std::string> words_of(const std::string& text) {
    std::istringstream stream(text);
    return {std::istream_iterator<std::string>(stream), {}};
}

TEST_F(SceneReaders, ExtensionsAreTheirOwn) {
    std::set<std::string> seen;
    for (const SceneReader& reader : scene_readers()) {
        EXPECT_FALSE(words_of(reader.extensions).empty() && !reader.recognizes) << reader.name << " reads nothing";
        for (const std::string& extension : words_of(reader.extensions)) {
            EXPECT_TRUE(seen.insert(extension).second) << extension << " stands in two rows";
            EXPECT_EQ(scene_reader_of("a" + extension), &reader) << extension;
            for (char& c : seen.extract(extension).value()) EXPECT_EQ(c, char(std::tolower(c))) << extension;
            seen.insert(extension);
        }
    }
}

TEST_F(SceneReaders, EachRowReadsOrTellsWhatToDo) {
    for (const SceneReader& reader : scene_readers()) {
        const bool reads = reader.load != nullptr;
        EXPECT_NE(reads, std::string(reader.remedy) != "") << reader.name;
        EXPECT_TRUE(reader.choices.animations || reader.animation_seconds == nullptr) << reader.name;
        EXPECT_EQ(scene_format_names().find(reader.name) != std::string::npos, reads) << reader.name;
        for (const std::string& extension : words_of(reader.extensions))
            EXPECT_EQ((scene_extensions() + ",").find(extension + ",") != std::string::npos, reads) << extension;
    }
}

/// A reader says that the file is missing, not that an option is wrong.
TEST_F(SceneReaders, MissingFilesAreNamed) {
    for (const SceneReader& reader : scene_readers()) {
        if (!reader.load) continue;
        for (const std::string& extension : words_of(reader.extensions)) {
            const std::string path = (folder / ("missing" + extension)).string();
            expect_error(ErrorKind::user, {"missing" + extension, "No such file"},
                         [&] { static_cast<void>(load_scene(path, warnings, LoadOptions{.time = 1.0})); });
        }
    }
}

}  // namespace
}  // namespace claray
