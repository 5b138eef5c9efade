// host/measure/explain.hpp: nothing is compiled while renders are timed.
#include "host/measure/explain.hpp"

#include <gtest/gtest.h>

#include "tests/support/device.hpp"

namespace claray::test {
namespace {

TEST(Explain, CompilesAllKernelsBeforeItMeasures) {
    const Scene scene = *builtin_scene("cornell");
    measure::ExplainOptions options{.everything = false, .rounds = 1, .compile_beside = true};
    options.only = {Effect::mirror};
    options.approximations = {};
    unsigned begun = 0, prepared = 0, measured = 0;
    const auto compiled = [] { return compile_statistics().compiled + compile_statistics().from_cache; };
    (void)measure::explain(device(), scene, {.width = 16, .height = 16}, options, [&](const std::string& what) {
        if (what.starts_with("compiling")) return void(++prepared);
        if (measured++ == 0) begun = compiled();
    });
    EXPECT_EQ(prepared, 1u);
    EXPECT_EQ(measured, 1u);
    EXPECT_EQ(compiled(), begun);
}

}  // namespace
}  // namespace claray::test
