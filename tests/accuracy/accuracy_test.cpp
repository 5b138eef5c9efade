// host/accuracy: measures, references, studies and their plots.
#include "claray/accuracy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "host/accuracy/plot.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using Image = std::vector<glm::vec3>;

Image gradient(unsigned width, unsigned height) {
    Image image;
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x)
            image.emplace_back(0.2f + 0.6f * float(x) / float(width), 0.5f, 0.2f + 0.5f * float(y) / float(height));
    return image;
}

TEST(ImageError, IsWhatTheFormulasSay) {
    const Image reference(64, glm::vec3(0.5f));
    Image off = reference;
    for (std::size_t i = 0; i < off.size(); ++i) off[i] += i % 2 == 0 ? 0.05f : -0.05f;
    const ImageError none = image_error(reference, reference, 8), some = image_error(off, reference, 8);
    EXPECT_EQ(none.rmse, 0);
    EXPECT_EQ(none.relmse, 0);
    EXPECT_EQ(none.perceptual, 0);
    EXPECT_NEAR(some.rmse, 0.1, 1e-6);
    EXPECT_NEAR(some.relmse, 0.05 * 0.05 / (0.505 * 0.505), 1e-7);
    EXPECT_THROW((void)image_error(off, Image(63), 8), Error);
    EXPECT_THROW((void)image_error(Image(), Image(), 8), Error);
}

TEST(ImageError, SeesWhatEyesSee) {
    const unsigned width = 48;
    const Image reference = gradient(width, width);
    // The same error as a grain too fine to be seen well, and as a patch.
    Image grain = reference, patch = reference, black(reference.size(), glm::vec3(0));
    for (unsigned y = 0; y < width; ++y)
        for (unsigned x = 0; x < width; ++x) {
            grain[y * width + x] *= (x + y) % 2 == 0 ? 1.1f : 0.9f;
            patch[y * width + x] *= x < width / 2 ? 1.1f : 0.9f;
        }
    const double fine = image_error(grain, reference, width).perceptual;
    const double coarse = image_error(patch, reference, width).perceptual;
    EXPECT_GT(coarse, 3 * fine);
    EXPECT_GT(image_error(black, reference, width).perceptual, 2 * coarse);
    EXPECT_LE(image_error(black, reference, width).perceptual, 1);
    // It does not matter how bright both are.
    Image brighter = reference, brighter_patch = patch;
    for (glm::vec3& p : brighter) p *= 1000.f;
    for (glm::vec3& p : brighter_patch) p *= 1000.f;
    EXPECT_NEAR(image_error(brighter_patch, brighter, width).perceptual, coarse, 1e-4);
}

TEST(Study, FindsSlopesSpreadsAndTheFront) {
    const std::vector<double> x = {1, 2, 4, 8}, y = {8, 4, 2, 1}, flat = {3, 3, 3, 3};
    EXPECT_NEAR(log_log_slope(x, y), -1, 1e-12);
    EXPECT_NEAR(log_log_slope(x, flat), 0, 1e-12);
    EXPECT_EQ(log_log_slope(std::vector<double>{1}, std::vector<double>{1}), 0);
    const Spread spread = spread_of({5, 1, 4, 2, 3});
    EXPECT_EQ(spread.low, 2);
    EXPECT_EQ(spread.median, 3);
    EXPECT_EQ(spread.high, 4);

    const auto point = [](double error, double seconds, const char* failure = "") {
        StudyPoint p;
        p.method = "m", p.error.median = error, p.seconds.median = seconds, p.failure = failure;
        return p;
    };
    std::vector<StudyPoint> points = {point(1, 1), point(0.5, 2), point(0.7, 3), point(0.1, 0.1, "failed"),
                                      point(0.5, 2)};
    mark_front(points);
    EXPECT_TRUE(points[0].front && points[1].front && points[4].front);
    EXPECT_FALSE(points[2].front || points[3].front);
}

Scene small_scene() { return *builtin_scene("cornell"); }

TEST(ReferenceImage, GoesOnWhereItStoppedAndIsMadeAnewWhereItsFileIsDamaged) {
    const TemporaryFolder folder;
    const Scene scene = small_scene();
    const RenderConfig config = {.width = 12, .height = 12};
    const std::filesystem::path kept = folder / "kept";
    int renders = 0;
    const auto count = [&](double, const std::string&) { return ++renders > 0; };
    const ReferenceImage at_once = reference_image(device(), scene, config, {.least_spp = 1536});
    (void)reference_image(device(), scene, config, {.least_spp = 1024, .folder = kept});
    const ReferenceImage continued =
        reference_image(device(), scene, config, {.least_spp = 1536, .folder = kept}, count);
    EXPECT_EQ(renders, 2);  // the other four were in the file
    EXPECT_EQ(continued.pixels, at_once.pixels);
    EXPECT_EQ(continued.spp, 1536u);

    const std::filesystem::path file = std::filesystem::directory_iterator(kept)->path();
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(400);
    stream.put('\x55');
    stream.close();
    renders = 0;
    const ReferenceImage again = reference_image(device(), scene, config, {.least_spp = 1536, .folder = kept}, count);
    EXPECT_EQ(renders, 6);
    EXPECT_EQ(again.pixels, at_once.pixels);

    RenderConfig deeper = config;
    deeper.max_depth = 2;
    EXPECT_NE(reference_image(device(), scene, deeper, {.least_spp = 1024, .folder = kept}).pixels, at_once.pixels);
}

TEST(ReferenceImage, KnowsItsOwnError) {
    const Scene scene = *builtin_scene("hills");
    const RenderConfig config = {.width = 24, .height = 24};
    const ReferenceImage rough = reference_image(device(), scene, config, {.least_spp = 1024});
    const ReferenceImage fine =
        reference_image(device(), scene, config, {.least_spp = 1, .uncertainty = rough.uncertainty / 2});
    EXPECT_LE(fine.uncertainty, rough.uncertainty / 2);
    // Renders of both begin with the same seeds: what is left of the error is that of the others.
    const double share = double(rough.spp) / fine.spp;
    const double expected = rough.uncertainty * std::sqrt(1 - share);
    EXPECT_NEAR(image_error(rough.pixels, fine.pixels, config.width).rmse / expected, 1, 0.2);
}

TEST(Study, OfSamplesFallsAsMonteCarloDoes) {
    StudyOptions options;
    options.config = {.width = 24, .height = 24};
    options.most_spp = 16, options.runs = 3;
    double last = 0;
    const Study study = study_sampling(device(), small_scene(), options, [&](double done, const std::string&) {
        EXPECT_GE(done, last);
        last = done;
        return true;
    });
    EXPECT_NEAR(last, 1, 0.05);
    std::vector<double> samples, errors;
    for (const StudyPoint& p : study.points) {
        EXPECT_TRUE(p.failure.empty());
        EXPECT_EQ(p.runs, 3u);
        EXPECT_GT(p.seconds.median, 0);
        EXPECT_LE(p.error.low, p.error.median);
        if (p.method == "independent") samples.push_back(p.value), errors.push_back(p.error.median);
    }
    EXPECT_EQ(study.points.size(), 10u);
    EXPECT_NEAR(log_log_slope(samples, errors), -0.5, 0.1);  // of 576 pixels and three runs
    EXPECT_LT(study.floor, errors.back());
}

TEST(Study, OfDepthSeesWhatPathsThatEndEarlyLeaveOut) {
    StudyOptions options;
    options.config = {.width = 16, .height = 16};
    options.most_spp = 64, options.runs = 3;
    const Study study = study_depth(device(), small_scene(), options);
    ASSERT_EQ(study.points.size(), 8u);
    EXPECT_GT(study.points[0].error.median, 1.5 * study.points[1].error.median);
    EXPECT_GT(study.points[0].error.median, 0.2);
    EXPECT_FALSE(study.points[7].failure.empty());  // after 16 surfaces nothing is left that could be told
}

TEST(Plot, DrawsEveryPointButThoseThatFailed) {
    Study study;
    study.name = "made-up", study.title = "A <study>", study.error = "none";
    for (int i = 0; i < 4; ++i) {
        StudyPoint p;
        p.method = i < 2 ? "first" : "second", p.setting = "s" + std::to_string(i), p.runs = 1;
        p.error = {0.9 / (i + 1), 1.0 / (i + 1), 1.1 / (i + 1)},
        p.seconds = {0.1 * (i + 1), 0.1 * (i + 1), 0.1 * (i + 1)};
        if (i == 3) p.failure = "lost";
        study.points.push_back(p);
    }
    const std::string svg = svg_of(study, "here & now");
    const auto count = [&](const std::string& text, const std::string& words) {
        std::size_t found = 0;
        for (std::size_t at = 0; (at = text.find(words, at)) != std::string::npos; ++at) ++found;
        return found;
    };
    EXPECT_EQ(count(svg, "<circle"), 3u);             // two points and the legend's
    EXPECT_EQ(count(svg, "<rect"), 1u);               // the paper: without a floor nothing is shaded
    EXPECT_EQ(count(svg, "stroke-width=\"2\""), 5u);  // three marks, two in the legend
    EXPECT_EQ(count(svg, "A &lt;study&gt;"), 1u);
    EXPECT_EQ(count(svg, "here &amp; now"), 1u);
    EXPECT_EQ(count(svg, "nan"), 0u);
    const std::string csv = csv_of({study}, "a \"device\"", "1", "scene");
    EXPECT_EQ(count(csv, "\n"), 5u);
    EXPECT_EQ(count(csv, "\"a \"\"device\"\"\""), 4u);
    EXPECT_EQ(count(csv, "\"lost\""), 1u);
}

}  // namespace
}  // namespace claray::test
