#include "host/compute/programs/kernel_sources.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace claray::test
