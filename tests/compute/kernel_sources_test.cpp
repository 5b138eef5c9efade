#include "host/compute/programs/kernel_sources.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "host/base/hash.hpp"

namespace claray::test {
namespace {

/// What is known of compiled kernels is stored under this hash.
TEST(KernelSources, HashIsThatOfTheTextsInUse) {
    const auto hash_of_texts = [] {
        std::string all;
        for (const KernelSource& source : kernel_sources()) all += source.path + '\n' + source.text + '\n';
        return hash128(all);
    };
    const std::string path = "bsdf/custom.clh", text = kernel_source(path).text, before = hash_of_kernel_sources();
    EXPECT_EQ(before, hash_of_texts());
    replace_kernel_source(path, text + "// more\n");
    EXPECT_NE(hash_of_kernel_sources(), before);
    EXPECT_TRUE(has_own_kernel_sources());
    EXPECT_EQ(hash_of_kernel_sources(), hash_of_texts());
    replace_kernel_source(path, text);
    EXPECT_EQ(hash_of_kernel_sources(), before);
    EXPECT_FALSE(has_own_kernel_sources()) << "other processes have the same texts again";
}

/// The name of a macro counts where the compiler reads it, in the file or in what it includes.
TEST(KernelSources, NeedTheMacrosThatTheirTextsName) {
    const std::string path = "bsdf/custom.clh", text = kernel_source(path).text;
    const KernelSource& direct = kernel_source(path);
    const KernelSource& including = kernel_source("bsdf/kinds.clh");
    const auto included = included_sources(including.text);
    ASSERT_NE(std::find(included.begin(), included.end(), &direct), included.end());
    EXPECT_FALSE(needs(direct, "OF_THIS_TEST"));
    replace_kernel_source(path, text + "// OF_THIS_TEST\n#define NOT_OF_THIS_TEST OF_THIS_TEST2\n");
    EXPECT_FALSE(needs(direct, "OF_THIS_TEST")) << "in a comment and in longer names";
    replace_kernel_source(path, text + "#ifdef OF_THIS_TEST  // a comment\n#endif\n");
    EXPECT_TRUE(needs(direct, "OF_THIS_TEST"));
    EXPECT_TRUE(needs(including, "OF_THIS_TEST"));
    EXPECT_TRUE(mentions(direct, "OF_THIS_TEST"));
    EXPECT_FALSE(mentions(including, "OF_THIS_TEST"));
    replace_kernel_source(path, text);
    EXPECT_FALSE(needs(including, "OF_THIS_TEST"));
}

}  // namespace
}  // namespace claray::test
