#include "host/compute/programs/kernel_sources.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "claray/program.hpp"
#include "host/base/hash.hpp"
#include "host/compute/programs/effect_macros.hpp"
#include "tests/support/device.hpp"

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

/// Drivers need not know `#pragma once`, and messages keep their lines.
TEST(KernelSources, HaveGuardsInPlaceOfPragmaOnce) {
    for (const KernelSource& source : kernel_sources())
        EXPECT_EQ(source.text.find("#pragma once"), std::string::npos) << source.path;
    const std::string path = "bsdf/custom.clh", text = kernel_source(path).text;
    replace_kernel_source(path, "// first\n#pragma once\n// third");
    EXPECT_EQ(kernel_source(path).text,
              "// first\n#ifndef CLARAY_ONCE_bsdf_custom_clh\n// third\n#define CLARAY_ONCE_bsdf_custom_clh\n#endif\n");
    replace_kernel_source(path, text);
    EXPECT_EQ(kernel_source(path).text, text) << "a guard stays as it is";
}

TEST(EffectMacros, HaveDefaultsWhereTheyAreNeeded) {
    Defines defines = {{"TEXTURES", "0"}, {"OTHER", "7"}};
    const std::vector<std::string> needed = {"TEXTURES", "SHEEN", "PRIMITIVES", "OTHER", "MATERIALS"};
    add_effect_macros(defines, [&](const std::string& macro) {
        return std::find(needed.begin(), needed.end(), macro) != needed.end();
    });
    const Defines expected = {{"TEXTURES", "0"}, {"OTHER", "7"}, {"SHEEN", "1"}, {"PRIMITIVES", "0"}};
    EXPECT_EQ(defines, expected) << "MATERIALS has one beside its list";
}

/// A program's own kernel includes claray's files as they are.
TEST(EffectMacros, ReachKernelsOfPrograms) {
    const char* source =
        "#include \"bsdf/materials.clh\"\n"
        "kernel void tell(global int* out) { out[0] = SHEEN; out[1] = CLEARCOAT; }";
    Buffer<int> out(device(), 2);
    compile_kernel(device(), source, "tell").run({1, 0}, out);
    EXPECT_EQ(out.read(), (std::vector<int>{1, 1}));
    compile_kernel(device(), source, "tell", {{"SHEEN", "0"}}).run({1, 0}, out);
    EXPECT_EQ(out.read(), (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace claray::test
