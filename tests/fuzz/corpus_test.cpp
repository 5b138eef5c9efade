// Every file of the corpus, what fuzzers have found included, and each of them cut off and damaged in a few places.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <span>

#include "tests/fuzz/targets.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

class Corpus : public testing::TestWithParam<FuzzTarget> {};

TEST_P(Corpus, IsReadOrRefused) {
    std::mt19937 random(1);
    std::vector<fs::path> files;
    for (const auto& entry :
         fs::directory_iterator(fs::path(CLARAY_SOURCE_DIR) / "tests/fuzz/corpus" / GetParam().name))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    ASSERT_FALSE(files.empty());
    bool any_read = false;
    for (const fs::path& path : files) {
        SCOPED_TRACE(path);
        const std::string text = read_file(path);
        std::vector<std::uint8_t> bytes(text.begin(), text.end());
        any_read = GetParam().run(bytes) || any_read;
        for (std::size_t cut = 1; cut < 16; ++cut) GetParam().run(std::span(bytes).first(bytes.size() * cut / 16));
        for (int i = 0; i < 10 && !bytes.empty(); ++i) {
            bytes[random() % bytes.size()] = std::uint8_t(random());
            GetParam().run(bytes);
        }
        bytes.resize(bytes.size() / 2);
        GetParam().run(bytes);
    }
    GetParam().run({});
    EXPECT_TRUE(any_read) << "from files that are all of an old format a fuzzer finds nothing";
}

INSTANTIATE_TEST_SUITE_P(All, Corpus, testing::ValuesIn(fuzz_targets().begin(), fuzz_targets().end()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace claray::test
