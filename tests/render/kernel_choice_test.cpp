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
#include <thread>

#include "host/compute/device_state.hpp"
#include "host/render/kernels/background_compiler.hpp"
#include "host/render/renderer_state.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

/// What is known to be cached is noted for a tuning of the device. With one that no test ever had nothing is noted,
/// while the cache still holds the kernels that other tests compiled.
void forget_what_is_cached(const Device& device) {
    static auto tuning = unsigned(std::chrono::system_clock::now().time_since_epoch().count());
    device.set_tuning("tests/kernel_choice", "RUN", tuning++);
}
void forget_what_is_cached() { forget_what_is_cached(device()); }

class KernelChoices : public testing::Test {
protected:
    /// The configuration with a compiler that does nothing and succeeds.
    [[nodiscard]] static RenderConfig config() {
        RenderConfig config{.width = 40, .height = 30, .spp = 200};
        config.compiler = "/bin/true";
        return config;
    }
    [[nodiscard]] static KernelChoice own(const Scene& scene) {
        RenderConfig here;
        return plan_kernels(device(), effects_of(scene), here).last;
    }
    void SetUp() override {
        device().set_tuning("render/wavefront", "PATHS", 1200);  // many batches
        forget_what_is_cached();
    }
    void TearDown() override { device().set_tuning("render/wavefront", "PATHS", paths_); }

    /// It has no kernel in memory, and knows of none in the cache.
    [[nodiscard]] static Device with_nothing_loaded() {
        Device fresh = Device::open(std::to_string(device().info().index));
        fresh.set_tuning("render/wavefront", "PATHS", 1200);
        forget_what_is_cached(fresh);
        return fresh;
    }

    /// Renders with kernels that are replaced soon after the first batch.
    void expect_same_image(const Scene& scene, KernelStart start) {
        Renderer renderer(device(), scene, config());
        remember_as_cached(device(), own(scene), config());
        renderer.render();
        const RenderStatistics statistics = renderer.statistics();
        EXPECT_EQ(statistics.start, start);
        EXPECT_GT(statistics.first_pixel_seconds, 0);
        EXPECT_TRUE(statistics.own_kernels);
        EXPECT_GT(statistics.own_kernels_from, 0u);
        EXPECT_LT(statistics.own_kernels_from, config().spp);
        RenderConfig fixed = config();
        fixed.compiler.clear();
        const std::vector<glm::vec3> changed = renderer.image(), image = render_by_own_kernels(scene, fixed);
        ASSERT_EQ(changed.size(), image.size());
        EXPECT_EQ(std::memcmp(changed.data(), image.data(), image.size() * sizeof image[0]), 0);
    }

    unsigned paths_ = device().tuning("render/wavefront", "PATHS");
};

TEST_F(KernelChoices, BeginWithWhatTheCacheHolds) {
    const Scene scene = *builtin_scene("cornell");
    const EffectSet effects = effects_of(scene);
    const KernelChoice last = own(scene);
    const auto start = [&] { return plan_kernels(device(), effects, config()).start; };
    const bool has_quicker = last.layout == Layout::wide;
    EXPECT_EQ(start(), has_quicker ? KernelStart::quick : KernelStart::own);
    remember_as_cached(device(), {full_effects(), last.layout}, config());
    EXPECT_EQ(start(), KernelStart::generic);
    EXPECT_EQ(plan_kernels(device(), effects, config()).last, last);
    remember_as_cached(device(), last, config());
    EXPECT_EQ(start(), KernelStart::own);
    // Without a compiler there is nothing to wait for.
    EXPECT_EQ(plan_kernels(device(), {Effect::mirror}, RenderConfig()).start, KernelStart::own);
}

TEST_F(KernelChoices, InstancesHaveKernelsOfTheirOwn) {
    const EffectSet effects = effects_of(*builtin_scene("effect:instances"));
    ASSERT_TRUE(effects.has(Effect::instances));
    EffectSet without = effects;
    without.remove(Effect::instances);
    const KernelPlan plan = plan_kernels(device(), effects, config());
    const bool has_quicker = plan.last.layout == Layout::wide;
    const KernelStart begin = has_quicker ? KernelStart::quick : KernelStart::own;
    const auto start = [&] { return plan_kernels(device(), effects, config()).start; };
    EXPECT_EQ(start(), begin);
    remember_as_cached(device(), {full_effects(), plan.last.layout}, config());
    EXPECT_EQ(start(), begin) << "the generic kernels know no instances";
    remember_as_cached(device(), {without, plan.last.layout}, config());
    EXPECT_EQ(start(), begin) << "kernels that trace one tree are not cached for trees of trees";
    remember_as_cached(device(), plan.last, config());
    EXPECT_EQ(start(), KernelStart::own);
}

TEST_F(KernelChoices, WhatIsTracedByCachedKernelsNeedsNoQuickOnes) {
    const EffectSet effects = effects_of(*builtin_scene("cornell"));
    const KernelPlan plan = plan_kernels(device(), effects, config());
    EffectSet others = effects;
    others.add(Effect::mirror);  // other shading, same tracing
    ASSERT_FALSE(effects.has(Effect::mirror));
    remember_as_cached(device(), {others, plan.last.layout}, config());
    EXPECT_EQ(plan_kernels(device(), effects, config()).start, KernelStart::own);
}

TEST_F(KernelChoices, GenericKernelsGiveWayWithoutASeam) {
    for (const char* name : {"cornell", "spheres"}) {
        forget_what_is_cached();
        const Scene scene = *builtin_scene(name);
        remember_as_cached(device(), {full_effects(), own(scene).layout}, config());
        expect_same_image(scene, KernelStart::generic);
    }
}

TEST_F(KernelChoices, QuickKernelsGiveWayWithoutASeam) {
    for (const char* name : {"cornell", "spheres", "effect:instances", "effect:instance-motion"}) {
        forget_what_is_cached();
        const Scene scene = *builtin_scene(name);
        if (own(scene).layout != Layout::wide) GTEST_SKIP() << "the device traverses the binary tree anyway";
        expect_same_image(scene, KernelStart::quick);
    }
}

/// Of compiled programs and those from the cache.
unsigned programs_loaded() { return compile_statistics().compiled + compile_statistics().from_cache; }

TEST_F(KernelChoices, QuickKernelsAreOneProgramAndNeedNoBuilder) {
    const Scene scene = *builtin_scene("crate");
    if (own(scene).layout != Layout::wide) GTEST_SKIP() << "the device traverses the binary tree anyway";
    const Device fresh = with_nothing_loaded();
    const unsigned before = programs_loaded();
    RenderConfig once = config();
    once.width = 8, once.height = 6, once.spp = 1;
    Renderer renderer(fresh, scene, once);
    renderer.render();
    EXPECT_EQ(programs_loaded(), before + 1);
    EXPECT_GT(renderer.statistics().first_pixel_processor_seconds, 0);
}

TEST_F(KernelChoices, QuickKernelsOfManyEffectsAreOneProgramThatIsNotOptimized) {
    const Scene scene = *builtin_scene("effect:instance-motion");
    if (own(scene).layout != Layout::wide) GTEST_SKIP() << "the device traverses the binary tree anyway";
    RenderConfig few = config();
    few.width = 12, few.height = 9, few.spp = 16;  // the slow kernels have no kernels to switch to
    RenderConfig many = few;
    few.compiler.clear();
    many.effects.add = full_effects();
    const Device fresh = with_nothing_loaded();
    const unsigned before = programs_loaded();
    Renderer renderer(fresh, scene, many);
    renderer.render();
    EXPECT_EQ(programs_loaded(), before + 1);
    EXPECT_EQ(renderer.statistics().start, KernelStart::quick);
    EXPECT_FALSE(renderer.statistics().own_kernels);
    EXPECT_GT(renderer.statistics().first_pixel_processor_seconds, 0);
    EXPECT_TRUE(state_of(fresh).slow_programs.empty());
    const std::vector<glm::vec3> slow = renderer.image(), image = render_by_own_kernels(scene, few);
    ASSERT_EQ(slow.size(), image.size());
    EXPECT_EQ(std::memcmp(slow.data(), image.data(), image.size() * sizeof image[0]), 0);
}

/// A compiler that reports its priority and runs until it is released.
class BackgroundCompiler : public KernelChoices {
protected:
    BackgroundCompiler() {
        std::ofstream(script_) << "#!/bin/sh\nnice >> '" << told_.string() << "'\necho \"$@\" >> '" << told_.string()
                               << "'\nwhile [ -d '" << folder_.path().string() << "' ] && [ ! -e '"
                               << released_.string() << "' ]; do sleep 0.01; done\n";
        std::filesystem::permissions(script_, std::filesystem::perms::owner_all);
    }
    ~BackgroundCompiler() override {
        release();
        EXPECT_TRUE(becomes_true([] { return !is_compiling(); })) << "it may write to the folder";
    }
    void release() const { std::ofstream(released_) << '.'; }
    [[nodiscard]] bool start() const { return start_compiler(script_, device(), {{Effect::mirror}, Layout::wide}, {}); }
    TemporaryFolder folder_;
    ScopedEnvironment cache_{"CLARAY_CACHE_DIR", folder_.path().string()};
    std::filesystem::path script_ = folder_ / "compiler", told_ = folder_ / "told", released_ = folder_ / "released";
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

TEST(CompileKernels, MakesEveryKernelThatARenderNeeds) {
    const Scene scene = *builtin_scene("hills");
    RenderConfig config{.width = 8, .height = 8, .spp = 1};
    forget_what_is_cached();
    compile_kernels(device(), effects_of(scene), config);
    const unsigned before = compile_statistics().compiled + compile_statistics().from_cache;
    (void)render_by_own_kernels(scene, config);
    EXPECT_EQ(compile_statistics().compiled + compile_statistics().from_cache, before);
}

}  // namespace
}  // namespace claray::test
