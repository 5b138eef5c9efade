// A render passes to the process that compiles for it all on which its kernels depend.
#include "host/cli/options/compile_options.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "host/render/kernels/background_compiler.hpp"
#include "tests/support/device.hpp"

namespace claray::cli {
namespace {

using test::device;

/// What `claray compile` makes of these arguments.
CompileOptions parsed(std::vector<std::string> arguments) {
    CLI::App app;
    CompileOptions options;
    add_compile_options(*app.add_subcommand("compile"), options);
    std::ranges::reverse(arguments);  // as CLI11 takes them
    app.parse(arguments);
    return options;
}

struct NamedChange {
    const char* name;
    void (*change)(RenderConfig&);
};

/// Every member on which a kernel may depend; the others belong to the picture, the progress and files.
const NamedChange changes[] = {
    {"nothing", [](RenderConfig&) {}},
    {"sampler", [](RenderConfig& c) { c.sampler = Sampler::independent; }},
    {"bvh.builder", [](RenderConfig& c) { c.bvh.builder = Builder::fast; }},
    {"bvh.morton_bits", [](RenderConfig& c) { c.bvh.morton_bits = 30; }},
    {"bvh.layout", [](RenderConfig& c) { c.bvh.layout = Layout::binary; }},
    {"bvh.split_budget", [](RenderConfig& c) { c.bvh.split_budget = 0; }},
    {"bvh.max_leaf_triangles", [](RenderConfig& c) { c.bvh.max_leaf_triangles = 1; }},
    {"effects.add", [](RenderConfig& c) { c.effects.add = {Effect::mirror}; }},
    {"effects.remove", [](RenderConfig& c) { c.effects.remove = {Effect::emissive_triangles}; }},
    {"approximate.tile_sum", [](RenderConfig& c) { c.approximate.tile_sum = true; }},
    {"approximate.light_grid", [](RenderConfig& c) { c.approximate.light_grid = true; }},
    {"approximate.flat", [](RenderConfig& c) { c.approximate.flat = true; }},
    {"approximate.gouraud", [](RenderConfig& c) { c.approximate.gouraud = true; }},
    {"approximate.no_shadows", [](RenderConfig& c) { c.approximate.no_shadows = true; }},
    {"guide", [](RenderConfig& c) { c.guide = false; }},
    {"adaptive", [](RenderConfig& c) { c.adaptive = true; }},
    {"max_depth", [](RenderConfig& c) { c.max_depth = 1; }},
    {"size", [](RenderConfig& c) { c.width = c.height = 16; }},
};

TEST(CompileOptions, AreAllThatTheKernelsOfARenderDependOn) {
    const EffectSet effects = {Effect::lambert, Effect::emissive_triangles};
    for (const auto& [name, change] : changes) {
        RenderConfig config;
        change(config);
        config.bvh.builder = resolve(config.bvh.builder, device());
        const KernelChoice wanted = plan_kernels(device(), effects, config).last;
        const CompileOptions options = parsed(compiler_arguments(device(), wanted, config));
        EXPECT_TRUE(options.background);
        EXPECT_EQ(options.device, std::to_string(device().info().index));
        const KernelChoice made = plan_kernels(device(), parse_effects(options.effects), options.config).last;
        EXPECT_EQ(key_of_kernels(device(), made, options.config), key_of_kernels(device(), wanted, config)) << name;
    }
}

}  // namespace
}  // namespace claray::cli
