// Renders that stop and go on from a file.
#include <gtest/gtest.h>

#include <fstream>

#include "claray/renderer.hpp"
#include "host/render/checkpoint/checkpoint.hpp"
#include "host/render/checkpoint/scene_digest.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"
#include "tests/support/tuning.hpp"

namespace claray::test {
namespace {

class CheckpointFiles : public testing::Test {
protected:
    /// Renders until so many reports have come.
    void render_a_part(const RenderConfig& config, int reports) const {
        Renderer renderer(device(), scene_, config);
        renderer.render([&](const RenderProgress&) { return --reports > 0; });
    }
    [[nodiscard]] RenderConfig resumed() const {
        RenderConfig config = config_;
        config.resume = config_.checkpoint;
        return config;
    }
    [[nodiscard]] std::vector<glm::vec3> finish(const RenderConfig& config) const {
        return render_by_own_kernels(scene_, config);
    }
    [[nodiscard]] testing::AssertionResult refused(const RenderConfig& config, const std::string& words) const {
        return throws_error(ErrorKind::user, words, [&] { Renderer(device(), scene_, config); });
    }

    TemporaryFolder folder_;
    Scene scene_ = *builtin_scene("cornell");
    RenderConfig config_{.width = 61, .height = 43, .spp = 21, .checkpoint = folder_ / "c"};
};

TEST_F(CheckpointFiles, ResumedIsUninterruptedBitForBit) {
    const std::vector<glm::vec3> whole = render_by_own_kernels(scene_, {.width = 61, .height = 43, .spp = 21});
    for (const unsigned paths : {3u, 1'000u, 10'000u}) {  // within a pixel, within a pass, and after one
        const ScopedTuning tuning("render/wavefront", "FIRST_PATHS", paths);
        render_a_part(config_, 1);
        const auto saved = Renderer(device(), scene_, resumed()).image();
        EXPECT_FALSE(same_bits(saved, whole));
        EXPECT_TRUE(same_bits(finish(resumed()), whole)) << paths << " paths at first";
    }
    {
        const ScopedTuning tuning("render/wavefront", "PATHS", 777);  // continues with other batches
        render_a_part(config_, 1);
    }
    EXPECT_TRUE(same_bits(finish(resumed()), whole));
    EXPECT_TRUE(same_bits(finish(resumed()), whole)) << "what is complete stays so";
}

/// As an interrupted render of several devices leaves it: one of them was at the last pass, another was behind.
TEST_F(CheckpointFiles, PendingSamplesComeFirst) {
    const std::vector<glm::vec3> whole = finish(config_);
    const RenderIdentity identity = identity_of(scene_, config_);
    (void)render_by_own_kernels(scene_, {.width = 61, .height = 43, .spp = 16, .checkpoint = config_.checkpoint});
    Checkpoint checkpoint = read_checkpoint(config_.checkpoint, identity, 16);
    const std::uint32_t pixels = 61 * 43;
    for (const std::uint32_t done : {17u, 21u}) {
        checkpoint.position = {
            {done, 0, 0, 0}, {}, {{0, 1000, 16, done - 16, 0}, {1000, pixels - 1000, 16, done - 16, 0}}};
        write_checkpoint(config_.checkpoint, identity, checkpoint);
        EXPECT_TRUE(same_bits(finish(resumed()), whole)) << done;
    }
}

TEST_F(CheckpointFiles, RendersToAnErrorGoOn) {
    config_.spp = 4096;
    for (const double error : {0.25, 0.1}) {
        config_.error = error;
        RenderConfig whole = config_;
        whole.checkpoint.clear();
        const std::vector<glm::vec3> expected = finish(whole);
        for (const unsigned paths : {3u, 1'000u, 10'000u}) {
            const ScopedTuning tuning("render/wavefront", "FIRST_PATHS", paths);
            render_a_part(config_, 1);
            EXPECT_TRUE(same_bits(finish(resumed()), expected)) << paths << " paths at first";
        }
        for (const unsigned reports : {2u, 3u, 5u, 8u, 11u}) {  // after some looks at the error
            render_a_part(config_, reports);
            EXPECT_TRUE(same_bits(finish(resumed()), expected)) << reports << " reports";
        }
    }
}

/// A target is no part of the image.
TEST_F(CheckpointFiles, AnErrorMayBeAskedForLaterOrNoMore) {
    RenderConfig to_an_error = config_;
    to_an_error.spp = 4096, to_an_error.error = 0.25;
    const RenderProgress reached = Renderer(device(), scene_, to_an_error).render();
    RenderConfig plain = config_;
    plain.spp = reached.spp + 20, plain.checkpoint.clear();
    const std::vector<glm::vec3> expected = finish(plain);
    plain.resume = config_.checkpoint;
    EXPECT_TRUE(same_bits(finish(plain), expected));

    (void)finish(config_);
    to_an_error.resume = config_.checkpoint, to_an_error.checkpoint.clear(), to_an_error.error = 0.1;
    const RenderProgress later = Renderer(device(), scene_, to_an_error).render();
    EXPECT_GT(later.spp, config_.spp);
    EXPECT_GT(later.error_bound, 0);
    EXPECT_LE(later.error_bound, 0.1);
}

/// Within the first pass of the image, within a round, and between rounds.
TEST_F(CheckpointFiles, AdaptiveRendersGoOn) {
    config_.spp = 40, config_.adaptive = true;
    RenderConfig whole = config_;
    whole.checkpoint.clear();
    const std::vector<glm::vec3> expected = finish(whole);
    EXPECT_FALSE(same_bits(expected, render_by_own_kernels(scene_, {.width = 61, .height = 43, .spp = 40})));
    const ScopedTuning tuning("render/wavefront", "PATHS", 3'777);
    config_.report_seconds = 0;
    for (const int reports : {1, 12, 14, 19, 23}) {
        render_a_part(config_, reports);
        EXPECT_FALSE(same_bits(Renderer(device(), scene_, resumed()).image(), expected)) << reports;
        EXPECT_TRUE(same_bits(finish(resumed()), expected)) << reports << " reports";
        EXPECT_TRUE(same_bits(finish(resumed()), expected)) << "what is complete stays so";
    }
    RenderConfig uniform = resumed();
    uniform.adaptive = false;
    EXPECT_TRUE(refused(uniform, "other use of --adaptive"));
}

TEST_F(CheckpointFiles, MoreSamplesGoOnWhereFewerStopped) {
    RenderConfig few = config_;
    few.spp = 5;
    (void)finish(few);
    EXPECT_TRUE(same_bits(finish(resumed()), render_by_own_kernels(scene_, {.width = 61, .height = 43, .spp = 21})));
    RenderConfig too_few = resumed();
    too_few.spp = 4;
    EXPECT_TRUE(refused(too_few, "it has 21 samples per pixel, but only 4 are requested; use a larger --spp"));
}

TEST_F(CheckpointFiles, WrittenNowAndThen) {
    config_.checkpoint_seconds = 1e-9;
    Renderer renderer(device(), scene_, config_);
    std::string before;
    unsigned reports = 0;
    renderer.render([&](const RenderProgress&) {
        EXPECT_TRUE(std::filesystem::exists(config_.checkpoint)) << "before the end";
        return ++reports < 1;
    });
    EXPECT_EQ(renderer.checkpoint_error(), "");
}

TEST_F(CheckpointFiles, EveryFlippedBitIsNoticed) {
    config_.width = config_.height = 4, config_.spp = 1;
    (void)finish(config_);
    const std::string good = read_file(config_.checkpoint);
    for (std::size_t at = 0; at < good.size(); ++at) {
        std::string bad = good;
        bad[at] = char(bad[at] ^ (1 << at % 8));
        std::ofstream(config_.checkpoint, std::ios::binary) << bad;
        ASSERT_TRUE(refused(resumed(), "cannot continue from '" + config_.checkpoint.string() + "': "))
            << "byte " << at;
    }
    for (const std::size_t length :
         {std::size_t(0), std::size_t(7), std::size_t(8), std::size_t(143), good.size() - 1}) {
        std::ofstream(config_.checkpoint, std::ios::binary) << good.substr(0, length);
        ASSERT_TRUE(refused(resumed(), length < 8 ? "it is not a checkpoint" : "the file is damaged")) << length;
    }
    std::ofstream(config_.checkpoint, std::ios::binary) << good + "x";
    ASSERT_TRUE(refused(resumed(), "bytes instead of"));
    std::ofstream(config_.checkpoint, std::ios::binary) << good;
    EXPECT_NO_THROW((void)finish(resumed()));
}

TEST_F(CheckpointFiles, OtherScenesAndSettingsAreRefused) {
    render_a_part(config_, 1);
    const auto with = [&](auto change) {
        RenderConfig config = resumed();
        change(config);
        return config;
    };
    EXPECT_TRUE(refused(with([](auto& c) { c.width = 60; }), "its image has 61x43 pixels instead of 60x43"));
    EXPECT_TRUE(refused(with([](auto& c) { c.seed = 1; }), "another seed, depth, sampler"));
    EXPECT_TRUE(refused(with([](auto& c) { c.max_depth = 7; }), "another seed, depth, sampler"));
    EXPECT_TRUE(refused(with([](auto& c) { c.sampler = Sampler::independent; }), "another seed, depth, sampler"));
    EXPECT_TRUE(refused(with([](auto& c) { c.effects.remove.add(Effect::mirror); }), "sampler or effects"));
    EXPECT_TRUE(refused(with([&](auto& c) { c.resume = folder_ / "none"; }), "No such file"));
    EXPECT_TRUE(refused(with([&](auto& c) { c.resume = folder_.path(); }), "it is a folder"));
    scene_.camera->position.x += 1e-4f;
    EXPECT_TRUE(refused(resumed(), "it belongs to another scene or camera"));
    scene_.camera->position.x -= 1e-4f;
    std::swap(scene_.materials[0], scene_.materials[1]);
    EXPECT_TRUE(refused(resumed(), "it belongs to another scene or camera"));
}

TEST_F(CheckpointFiles, ThatCannotBeWritten) {
    config_.checkpoint = folder_ / "no/such/folder";
    EXPECT_TRUE(refused(config_, "no/such/folder"));
    config_.checkpoint = "/dev/full";  // opens, and then is full
    Renderer renderer(device(), scene_, config_);
    EXPECT_EQ(renderer.render().spp, config_.spp) << "the render is not lost";
    EXPECT_NE(renderer.checkpoint_error().find("No space left on device"), std::string::npos);
}

/// Every value of a scene is in its digest, and nothing else.
TEST(SceneDigest, TellsScenesApart) {
    const Scene scene = *builtin_scene("effects");
    const Digest digest = digest_of(scene);
    EXPECT_EQ(digest, digest_of(*builtin_scene("effects")));
    unsigned changes = 0;
    const auto differs = [&](auto change) {
        Scene other = scene;
        change(other);
        EXPECT_NE(digest_of(other), digest) << "change " << changes;
        ++changes;
    };
    differs([](Scene& s) { s.meshes[0].positions[0].y += 1e-3f; });
    differs([](Scene& s) { s.meshes[0].triangles.pop_back(); });
    differs([](Scene& s) { s.meshes[0].mask = 1; });
    differs([](Scene& s) { s.instances.at(0).transform[3][0] += 1; });
    differs([](Scene& s) { s.materials[0].light_map.scale.y = 2; });
    differs([](Scene& s) { s.materials[0].ior = 1.6f; });
    differs([](Scene& s) { s.textures.at(0).wrap_v = Wrap::mirror; });
    differs([](Scene& s) { s.lights.emplace_back(); });
    differs([](Scene& s) { s.sky.zenith.z = 3; });
    differs([](Scene& s) { s.environment.rotation = 1; });
    differs([](Scene& s) { s.camera->target_end = glm::vec3(1.f); });
    differs([](Scene& s) { s.camera.reset(); });
    Scene renamed = scene;
    renamed.name = "other", renamed.meshes[0].name = "other", renamed.materials[0].name = "other";
    EXPECT_EQ(digest_of(renamed), digest) << "names don't count";
}

}  // namespace
}  // namespace claray::test
