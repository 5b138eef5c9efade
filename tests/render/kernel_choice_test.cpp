// A render that begins with other kernels than the scene's own and switches while it runs gives the same image.
#include "host/render/kernels/kernel_choice.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <thread>
#include <utility>

#include "host/compute/device_state.hpp"
#include "host/compute/programs/compile_program.hpp"
#include "host/compute/programs/program_cache.hpp"
#include "host/render/kernels/background_compiler.hpp"
#include "host/render/renderer_state.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

/// Makes the cache seem to hold programs. They are never loaded.
void put_in_cache(const KernelSet& set) {
    for (const ProgramRequest& program : set.programs()) {
        const std::string options = build_options(device(), program.defines);
        ASSERT_EQ(store_cached_program(cache_identity(device(), kernel_source(program.file), options), {1}), "");
    }
}

/// The configuration with a compiler that does nothing and succeeds.
RenderConfig with_compiler() {
    RenderConfig config{.width = 40, .height = 30, .spp = 200};
    config.compiler = "/bin/true";
    return config;
}
KernelChoice own(const SceneTraits& scene) { return scene_kernels(device(), scene, with_compiler()); }
KernelChoice generic(const SceneTraits& scene) { return generic_kernels(device(), scene, with_compiler()); }

/// With an empty cache, into which nothing is compiled.
class KernelPlans : public testing::Test {
protected:
    /// The kernels with which a render of the scene begins.
    [[nodiscard]] static KernelStart start(const SceneTraits& scene) {
        return plan_kernels(device(), scene, with_compiler()).start;
    }
    [[nodiscard]] static bool has_quicker(const KernelChoice& choice) { return choice.layout == Layout::wide; }

    TemporaryFolder folder_;
    ScopedEnvironment cache_{"CLARAY_CACHE_DIR", folder_.path().string()};
};

TEST_F(KernelPlans, BeginWithWhatTheCacheHolds) {
    const SceneTraits scene = traits_of(*builtin_scene("cornell"));
    const KernelChoice last = own(scene);
    EXPECT_EQ(start(scene), has_quicker(last) ? KernelStart::quick : KernelStart::own);
    put_in_cache(generic(scene).programs);
    EXPECT_EQ(start(scene), KernelStart::generic);
    EXPECT_EQ(plan_kernels(device(), scene, with_compiler()).last, last);
    EXPECT_EQ(start({.effects = {Effect::lambert, Effect::sky}}), KernelStart::generic)
        << "without lamps it needs less";
    put_in_cache(last.programs);
    EXPECT_EQ(start(scene), KernelStart::own);
    // Without a compiler there is nothing to wait for.
    EXPECT_EQ(plan_kernels(device(), {.effects = {Effect::mirror}}, RenderConfig()).start, KernelStart::own);
}

TEST_F(KernelPlans, InstancesHaveKernelsOfTheirOwn) {
    const SceneTraits scene = traits_of(*builtin_scene("effect:instances"));
    ASSERT_TRUE(scene.effects.has(Effect::instances));
    SceneTraits without = scene;
    without.effects.remove(Effect::instances);
    const KernelChoice last = own(scene);
    const KernelStart begin = has_quicker(last) ? KernelStart::quick : KernelStart::own;
    EXPECT_EQ(start(scene), begin);
    put_in_cache(generic(without).programs);
    EXPECT_EQ(start(scene), begin) << "the generic kernels know no instances";
    put_in_cache(own(without).programs);
    EXPECT_EQ(start(scene), begin) << "kernels that trace one tree are not cached for trees of trees";
    put_in_cache(last.programs);
    EXPECT_EQ(start(scene), KernelStart::own);
}

TEST_F(KernelPlans, WhatIsTracedByCachedKernelsNeedsNoQuickOnes) {
    const SceneTraits scene = traits_of(*builtin_scene("cornell"));
    SceneTraits other = scene;
    other.effects.add(Effect::mirror);  // other shading, same tracing
    ASSERT_FALSE(scene.effects.has(Effect::mirror));
    put_in_cache(own(other).programs);
    EXPECT_EQ(start(scene), KernelStart::own);
}

class KernelChoices : public testing::Test {
protected:
    void SetUp() override { device().set_tuning("render/wavefront", "PATHS", 1200); }  // many batches
    void TearDown() override { device().set_tuning("render/wavefront", "PATHS", paths_); }

    /// It has no kernel in memory.
    [[nodiscard]] static Device with_nothing_loaded() {
        Device fresh = Device::open(std::to_string(device().info().index));
        fresh.set_tuning("render/wavefront", "PATHS", 1200);
        return fresh;
    }

    /// Renders with kernels that are replaced soon after the first batch. The cache seems to hold `cached` until then.
    void expect_same_image(const Scene& scene, KernelStart start, const KernelSet& cached = {}) {
        RenderConfig fixed = with_compiler();
        fixed.compiler.clear();
        compile_kernels(with_nothing_loaded(), effects_of(scene), fixed);
        load(device(), cached);
        const TemporaryFolder folder;
        std::optional<ScopedEnvironment> other(std::in_place, "CLARAY_CACHE_DIR", folder.path().string());
        put_in_cache(cached);
        Renderer renderer(device(), scene, with_compiler());
        other.reset();
        renderer.render();
        const RenderStatistics statistics = renderer.statistics();
        EXPECT_EQ(statistics.start, start);
        EXPECT_GT(statistics.first_pixel_seconds, 0);
        EXPECT_TRUE(statistics.own_kernels);
        EXPECT_GT(statistics.own_kernels_from, 0u);
        EXPECT_LT(statistics.own_kernels_from, with_compiler().spp);
        const std::vector<glm::vec3> changed = renderer.image(), image = render_by_own_kernels(scene, fixed);
        ASSERT_EQ(changed.size(), image.size());
        EXPECT_EQ(std::memcmp(changed.data(), image.data(), image.size() * sizeof image[0]), 0);
    }

    unsigned paths_ = device().tuning("render/wavefront", "PATHS");
};

TEST_F(KernelChoices, GenericKernelsGiveWayWithoutASeam) {
    for (const char* name : {"cornell", "spheres"}) {
        const Scene scene = *builtin_scene(name);
        expect_same_image(scene, KernelStart::generic, generic(traits_of(scene)).programs);
    }
}

TEST_F(KernelChoices, QuickKernelsGiveWayWithoutASeam) {
    for (const char* name : {"cornell", "spheres", "effect:instances", "effect:instance-motion"}) {
        const Scene scene = *builtin_scene(name);
        if (own(traits_of(scene)).layout != Layout::wide) GTEST_SKIP() << "the device traverses the binary tree anyway";
        expect_same_image(scene, KernelStart::quick);
    }
}

/// Of compiled programs and those from the cache.
unsigned programs_loaded() { return compile_statistics().compiled + compile_statistics().from_cache; }

TEST_F(KernelChoices, QuickKernelsAreOneProgramAndNeedNoBuilder) {
    const Scene scene = *builtin_scene("crate");
    if (own(traits_of(scene)).layout != Layout::wide) GTEST_SKIP() << "the device traverses the binary tree anyway";
    const Device fresh = with_nothing_loaded();
    const TemporaryFolder folder;
    const ScopedEnvironment empty("CLARAY_CACHE_DIR", folder.path().string());
    const unsigned before = programs_loaded();
    RenderConfig once = with_compiler();
    once.width = 8, once.height = 6, once.spp = 1;
    Renderer renderer(fresh, scene, once);
    renderer.render();
    EXPECT_EQ(programs_loaded(), before + 1);
    EXPECT_GT(renderer.statistics().first_pixel_processor_seconds, 0);
}

TEST_F(KernelChoices, QuickKernelsOfManyEffectsAreOneProgramThatIsNotOptimized) {
    const Scene scene = *builtin_scene("effect:instance-motion");
    if (own(traits_of(scene)).layout != Layout::wide) GTEST_SKIP() << "the device traverses the binary tree anyway";
    RenderConfig few = with_compiler();
    few.width = 12, few.height = 9, few.spp = 16;  // the slow kernels have no kernels to switch to
    RenderConfig many = few;
    few.compiler.clear();
    many.effects.add = full_effects();
    const Device fresh = with_nothing_loaded();
    const unsigned before = programs_loaded();
    const TemporaryFolder folder;
    std::optional<ScopedEnvironment> empty(std::in_place, "CLARAY_CACHE_DIR", folder.path().string());
    Renderer renderer(fresh, scene, many);
    renderer.render();
    EXPECT_EQ(programs_loaded(), before + 1);
    EXPECT_EQ(renderer.statistics().start, KernelStart::quick);
    EXPECT_FALSE(renderer.statistics().own_kernels);
    EXPECT_GT(renderer.statistics().first_pixel_processor_seconds, 0);
    EXPECT_TRUE(state_of(fresh).slow_programs.empty());
    empty.reset();
    const std::vector<glm::vec3> slow = renderer.image(), image = render_by_own_kernels(scene, few);
    ASSERT_EQ(slow.size(), image.size());
    EXPECT_EQ(std::memcmp(slow.data(), image.data(), image.size() * sizeof image[0]), 0);
}

/// A compiler that reports its priority and runs until it is released.
class BackgroundCompiler : public KernelChoices {
protected:
    BackgroundCompiler() {
        std::ofstream(script_) << "#!/bin/sh\nnice >> '" << told_.string() << "'\necho \"$@\" >> '" << told_.string()
                               << "'\ncat > '" << input_.string() << ".part'\nmv '" << input_.string() << ".part' '"
                               << input_.string() << "'\nwhile [ -d '" << folder_.path().string() << "' ] && [ ! -e '"
                               << released_.string() << "' ]; do sleep 0.01; done\n";
        std::filesystem::permissions(script_, std::filesystem::perms::owner_all);
    }
    ~BackgroundCompiler() override {
        release();
        EXPECT_TRUE(becomes_true([] { return !is_compiling(); })) << "it may write to the folder";
    }
    void release() const { std::ofstream(released_) << '.'; }
    [[nodiscard]] bool start() const { return start_compiler(script_, device(), {}, {}); }
    TemporaryFolder folder_;
    ScopedEnvironment cache_{"CLARAY_CACHE_DIR", folder_.path().string()};
    std::filesystem::path script_ = folder_ / "compiler", told_ = folder_ / "told", released_ = folder_ / "released";
    std::filesystem::path input_ = folder_ / "input";
};

TEST_F(BackgroundCompiler, HasLowPriorityFromItsStart) {
    const int before = ::getpriority(PRIO_PROCESS, 0);
    ASSERT_TRUE(start());
    ASSERT_TRUE(becomes_true([&] { return read_file(told_).find("compile") != std::string::npos; }));
    EXPECT_EQ(read_file(told_).substr(0, read_file(told_).find('\n')), std::to_string(std::min(before + 10, 19)));
    EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), before) << "the render keeps its own";
}

TEST_F(BackgroundCompiler, IsTheOnlyOne) {
    ASSERT_TRUE(start());
    EXPECT_FALSE(start()) << "it is asked for again later";
    release();
    EXPECT_TRUE(becomes_true([&] { return start(); })) << "once the other has ended";
    const ScopedEnvironment unwritable("CLARAY_CACHE_DIR", "/proc/nobody");
    EXPECT_TRUE(start()) << "what it compiles would be lost: there is nothing to ask for again";
}

/// Another process, as far as locks can tell.
class AnotherRender {
public:
    explicit AnotherRender(const std::filesystem::path& cache)
        : file_(::open((cache / "renders.lock").c_str(), O_RDWR | O_CREAT, 0600)) {
        EXPECT_EQ(::flock(file_, LOCK_SH), 0);
    }
    ~AnotherRender() { ::close(file_); }
    AnotherRender(const AnotherRender&) = delete;
    AnotherRender& operator=(const AnotherRender&) = delete;

private:
    int file_;
};

TEST_F(BackgroundCompiler, EndsAWhileAfterTheLastRender) {
    constexpr double most = 60;  // seconds, as promised
    CompilerWatch watch;
    {
        const AnotherRender render(folder_.path());
        EXPECT_FALSE(watch.must_end(0));
        EXPECT_FALSE(watch.must_end(1000)) << "a render lives";
    }
    EXPECT_FALSE(watch.must_end(1001));
    const AnotherRender next(folder_.path());
    EXPECT_FALSE(watch.must_end(2000)) << "another one began";
    {
        const ScopedEnvironment other("CLARAY_CACHE_DIR", (folder_ / "other").string());
        CompilerWatch alone;
        EXPECT_FALSE(alone.must_end(0));
        EXPECT_FALSE(alone.must_end(1)) << "the next render may begin";
        EXPECT_TRUE(alone.must_end(most));
    }
}

TEST_F(BackgroundCompiler, LetsOthersCompileInsteadOfWorkThatCanWait) {
    const AnotherRender render(folder_.path());
    CompilerWatch watch;
    ASSERT_TRUE(start());
    ASSERT_FALSE(start());
    EXPECT_FALSE(watch.must_end(1)) << "its render needs what it compiles";
    watch.let_others_compile();
    EXPECT_FALSE(watch.must_end(2)) << "nobody has asked since";
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the clock of files
    ASSERT_FALSE(start());
    EXPECT_TRUE(watch.must_end(3));
}

/// By quick kernels this render would take much longer than compiling does.
TEST_F(BackgroundCompiler, IsWaitedForOnCpus) {
    if (device().info().type != DeviceType::cpu) GTEST_SKIP() << "a GPU renders while a CPU compiles";
    RenderConfig config{.width = 64, .height = 64, .spp = 1u << 20, .report_seconds = 0.01};
    config.compiler = script_;
    Renderer renderer(device(), *builtin_scene("cornell"), config);
    if (renderer.statistics().start == KernelStart::own) GTEST_SKIP() << "no kernels are quicker to compile";
    unsigned spp = 0, equal = 0;
    const auto until_it_waits = [&](const RenderProgress& progress) {
        equal = progress.spp == spp && progress.waits_for_kernels ? equal + 1 : 0;
        spp = progress.spp;
        return equal < 10 && spp < 10000;
    };
    renderer.render(until_it_waits);
    EXPECT_EQ(equal, 10u) << "it samples while the compiler runs";
    unsigned of_view = 0;
    EXPECT_TRUE(becomes_true([&] { return (of_view = renderer.render_for(0.05).spp) > spp; }))
        << "a view does not wait";
    release();
    ASSERT_TRUE(becomes_true([] { return !is_compiling(); }));
    const auto until_more = [&](const RenderProgress& progress) { return progress.spp <= of_view; };
    EXPECT_GT(renderer.render(until_more).spp, of_view);
}

/// Otherwise the waiting would justify itself: a batch seems to take longer, and the rest with it.
TEST_F(BackgroundCompiler, IsWaitedForNoLongerThanTheRestTakes) {
    if (device().info().type != DeviceType::cpu) GTEST_SKIP() << "a GPU renders while a CPU compiles";
    const Scene scene = *builtin_scene("cornell");
    RenderConfig config{.width = 64, .height = 64, .spp = 1u << 20, .report_seconds = 0.01};
    config.compiler = script_;
    {
        Renderer first(device(), scene, config);  // compiles the quick kernels
        if (first.statistics().start == KernelStart::own) GTEST_SKIP() << "no kernels are quicker to compile";
        config.spp = 20 * std::max(1u, first.render_for(0.5).spp);
    }
    release();
    ASSERT_TRUE(becomes_true([] { return !is_compiling(); }));
    std::filesystem::remove(released_);
    Renderer renderer(device(), scene, config);
    unsigned waits = 0, samples_after = 0, spp = 0;
    renderer.render([&](const RenderProgress& progress) {
        if (progress.waits_for_kernels) ++waits, spp = progress.spp;
        samples_after = waits > 0 ? progress.spp - spp : 0;
        return samples_after == 0 && waits < 10000;
    });
    EXPECT_TRUE(is_compiling()) << "it never ends";
    EXPECT_GT(waits, 0u) << "the render waited";
    EXPECT_GT(samples_after, 0u) << "and went on";
}

TEST_F(BackgroundCompiler, OfAnotherRenderIsNotWaitedFor) {
    const int lock = ::open((folder_ / "compiler.lock").c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_EQ(::flock(lock, LOCK_EX), 0);
    RenderConfig config{.width = 64, .height = 64, .spp = 1u << 20, .seconds = 4, .report_seconds = 0.01};
    config.compiler = script_;
    Renderer renderer(device(), *builtin_scene("cornell"), config);
    unsigned waiting = 0;
    renderer.render([&](const RenderProgress& progress) {
        waiting += progress.waits_for_kernels;
        return true;
    });
    EXPECT_EQ(waiting, 0u);
    ::close(lock);
}

/// The decision counts, not how long a render stands still, which other programs decide.
TEST_F(BackgroundCompiler, IsNotWaitedForIfTimeIsShort) {
    RenderConfig config{.width = 16, .height = 16, .spp = 1u << 20, .seconds = 1, .report_seconds = 0.01};
    config.compiler = script_;
    Renderer renderer(with_nothing_loaded(), *builtin_scene("cornell"), config);
    unsigned reports = 0, waits = 0;
    renderer.render([&](const RenderProgress& progress) {
        ++reports, waits += progress.waits_for_kernels;
        return true;
    });
    EXPECT_GT(reports, 0u);
    EXPECT_EQ(waits, 0u);
}

/// With members of which its command line once told nothing.
TEST_F(BackgroundCompiler, IsToldEveryProgramOfTheRender) {
    RenderConfig config{.width = 16, .height = 16, .spp = 64, .sampler = Sampler::independent};
    config.bvh.max_leaf_triangles = 1, config.bvh.split_budget = 0;
    config.compiler = script_;
    Renderer renderer(device(), *builtin_scene("cornell"), config);
    const KernelPlan plan = state_of(renderer).kernels.plan;
    if (plan.start == KernelStart::own) GTEST_SKIP() << "no kernels are quicker to compile";
    renderer.render([](const RenderProgress&) { return false; });
    ASSERT_TRUE(becomes_true([&] { return std::filesystem::exists(input_); }));
    std::ifstream input(input_);
    const KernelSet first = read_kernel_set(input), later = read_kernel_set(input);
    EXPECT_EQ(first, plan.last.programs);
    EXPECT_FALSE(later.programs().empty());
    put_in_cache(first);
    EXPECT_EQ(plan_kernels(device(), traits_of(*builtin_scene("cornell")), config).start, KernelStart::own);
}

struct ChangedConfig {
    std::string name;
    RenderConfig config;
};

/// One for each member, of the configurations within, too. A member that is missing here does not compile.
std::vector<ChangedConfig> changed_configs(const std::filesystem::path& checkpoint_file) {
    RenderConfig config{.width = 16, .height = 12, .spp = 2};
    auto& [width, height, spp, max_depth, sample_clamp, seed, seconds, noise, error, adaptive, guide, report_seconds,
           sampler, bvh, parts, effects, approximate, light_grid, compiler, checkpoint, checkpoint_seconds, resume,
           region, alpha, lobes, light_groups] = config;
    auto& [builder, morton_bits, layout, split_budget, max_leaf_triangles, learns] = bvh;
    auto& [add, remove] = effects;
    auto& [tile_sum, uses_light_grid, flat, gouraud, no_shadows] = approximate;
    auto& [voxels, side, coefficients, levels, gather, rays, updates] = light_grid;
    side = 4, rays = 8, updates = 1;
    std::vector<ChangedConfig> all = {{"nothing", config}};
    const auto change = [&](const char* name, auto& member, const auto& value) {
        const auto before = std::exchange(member, value);
        all.push_back({name, config});
        member = before;
    };
    change("width", width, 20u), change("height", height, 20u), change("spp", spp, 4u);
    change("max_depth", max_depth, 1u), change("sample_clamp", sample_clamp, 1.f), change("seed", seed, 1u);
    change("seconds", seconds, 1.0), change("noise", noise, 0.5), change("error", error, 0.5);
    change("adaptive", adaptive, true), change("guide", guide, false), change("report_seconds", report_seconds, 1.0);
    change("sampler", sampler, Sampler::independent), change("parts", parts, 2u);
    change("bvh.builder", builder, Builder::fast), change("bvh.morton_bits", morton_bits, 30u);
    change("bvh.layout", layout, Layout::binary), change("bvh.split_budget", split_budget, 0.0);
    change("bvh.max_leaf_triangles", max_leaf_triangles, 1u), change("bvh.learns", learns, false);
    change("effects.add", add, EffectSet{Effect::cut_outs});
    change("effects.remove", remove, EffectSet{Effect::emissive_triangles});
    change("approximate.tile_sum", tile_sum, true), change("approximate.light_grid", uses_light_grid, true);
    change("approximate.flat", flat, true), change("approximate.gouraud", gouraud, true);
    change("approximate.no_shadows", no_shadows, true);
    change("light_grid.voxels", voxels, true), change("light_grid.side", side, 5u);
    change("light_grid.coefficients", coefficients, 4u), change("light_grid.levels", levels, 2u);
    change("light_grid.gather", gather, 1u), change("light_grid.rays", rays, 16u);
    change("light_grid.updates", updates, 2u);
    change("compiler", compiler, "/bin/true"), change("checkpoint_seconds", checkpoint_seconds, 1.0);
    change("region", region, Region{2, 3, 5, 4}), change("alpha", alpha, true);
    change("lobes", lobes, true), change("light_groups", light_groups, std::vector<std::string>{"a=sky"});
    change("checkpoint", checkpoint, checkpoint_file), change("resume", resume, checkpoint_file);
    return all;
}

/// Of two triangles and a lamp: the kernels of few effects.
Scene small_scene() {
    Scene scene;
    scene.materials = {lambert(0.5f), emitter(1)};
    scene.meshes = {square(1, 0), square(1, 2, 1)};
    scene.camera = narrow_camera({0, 1, 1}, {0, 0, 0});
    return scene;
}

std::string key_in_memory(const ProgramRequest& program, const Device& of) {
    return claray::key_in_memory(kernel_source(program.file), build_options(of, program.defines));
}

/// Such a set is what a process in the background compiles, and what the cache is asked for.
TEST(KernelSets, AreWhatARenderLoadsWhateverItsConfiguration) {
    const TemporaryFolder folder;
    const Scene scene = small_scene();
    std::map<std::string, Device> devices;  // each knows the programs of one set
    for (auto [name, config] : changed_configs(folder / "checkpoint")) {
        SceneTraits traits = traits_of(without_effects(scene, config.effects.remove));
        traits.is_split = config.parts > 1;
        const KernelChoice choice = scene_kernels(device(), traits, config);
        const std::string key = to_text(choice.programs);
        if (!devices.contains(key)) devices.emplace(key, Device::open(std::to_string(device().info().index)));
        const Device& on = devices.at(key);
        EXPECT_EQ(plan_kernels(on, traits, config).last, choice) << name;
        config.compiler.clear();
        Renderer renderer(on, scene, config);
        const Renderer::State& state = state_of(renderer);
        EXPECT_EQ(state.kernels.plan.last, choice) << name;
        EXPECT_TRUE(stages_for(on, traits, config, choice.effects, choice.layout) == state.stages(choice.effects))
            << name;
        renderer.render();
        (void)renderer.image();
        std::set<std::string> known;
        for (const ProgramRequest& program : choice.programs.programs()) known.insert(key_in_memory(program, on));
        for (const auto& [loaded, program] : state_of(on).programs)
            EXPECT_TRUE(known.contains(loaded)) << name << loaded;
        EXPECT_EQ(state_of(on).programs.size(), known.size()) << name;
        std::istringstream text(to_text(choice.programs));
        EXPECT_EQ(read_kernel_set(text), choice.programs) << name << ": as another process reads it";
    }
    EXPECT_GT(devices.size(), 10u) << "members on which kernels depend";
}

TEST(CompileKernels, MakesEveryKernelThatARenderNeeds) {
    const Scene scene = *builtin_scene("hills");
    RenderConfig config{.width = 8, .height = 8, .spp = 1};
    compile_kernels(device(), effects_of(scene), config);
    const unsigned before = compile_statistics().compiled + compile_statistics().from_cache;
    (void)render_by_own_kernels(scene, config);
    EXPECT_EQ(compile_statistics().compiled + compile_statistics().from_cache, before);
}

}  // namespace
}  // namespace claray::test
