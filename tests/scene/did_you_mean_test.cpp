// Suggestions for misspelt names.
#include "host/base/did_you_mean.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace claray {
namespace {

TEST(DidYouMean, TheNearestNameIsSuggested) {
    const std::vector<std::string> names = {"depth", "normal", "albedo", "primitive", "material", "heat"};
    const auto suggested = [&](const char* name) { return did_you_mean(name, names); };
    EXPECT_EQ(suggested("dept"), " (did you mean 'depth'?)") << "a letter is missing";
    EXPECT_EQ(suggested("deepth"), " (did you mean 'depth'?)") << "a letter too many";
    EXPECT_EQ(suggested("haet"), " (did you mean 'heat'?)") << "letters are exchanged, which is one change";
    EXPECT_EQ(suggested("Normals"), " (did you mean 'normal'?)");
    EXPECT_EQ(suggested("primitve"), " (did you mean 'primitive'?)");
    EXPECT_EQ(suggested("beauty"), "") << "nothing is near";
    EXPECT_EQ(suggested(""), "");
    EXPECT_EQ(suggested("ab"), "") << "a third of two letters is none";
    EXPECT_EQ(did_you_mean("depth", {}), "");
}

TEST(DidYouMean, FewerChangesWin) {
    const std::vector<std::string> names = {"stripes", "strips", "strip"};
    EXPECT_EQ(did_you_mean("strps", names), " (did you mean 'strips'?)");
}

}  // namespace
}  // namespace claray
