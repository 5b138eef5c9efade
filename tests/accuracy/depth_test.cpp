// host/accuracy/studies: depth buffers against their steps, and lights added in gamma space against the curve.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/accuracy/study.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

const StudyPoint& point_at(const Study& study, const std::string& method, double value) {
    for (const StudyPoint& p : study.points)
        if (p.method == method && p.value == value) return p;
    throw Error(ErrorKind::usage, "no point of " + method);
}

/// Seen from the origin along -z, in this order; each fills the view.
Scene walls_at(std::initializer_list<float> distances) {
    Scene scene;
    scene.materials = {Material{}};
    for (const float z : distances) {
        Mesh wall;
        wall.positions = {{-2 * z, -2 * z, -z}, {2 * z, -2 * z, -z}, {2 * z, 2 * z, -z}, {-2 * z, 2 * z, -z}};
        wall.triangles = {{0, 1, 2}, {0, 2, 3}};
        scene.meshes.push_back(wall);
    }
    scene.camera = Camera{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 50.f};
    return scene;
}

const StudyOptions small_depths{.config = {.width = 24, .height = 16}};

/// Depths of 10 and 10.01 differ by about 1e-4 near: at far/near 1e4, near = 0.01, by 0.07 steps of 16 bits and 17
/// of 24.
TEST(DepthStudy, TellsSurfacesApartByTheStepsOfAFormat) {
    for (const bool far_first : {true, false}) {
        std::vector<ErrorMap> maps;
        const Scene scene = far_first ? walls_at({100.f, 10.01f, 10.f}) : walls_at({10.f, 10.01f, 100.f});
        const Study study = study_depth(device(), scene, small_depths, {}, &maps);
        ASSERT_EQ(study.points.size(), 20u);
        ASSERT_EQ(maps.size(), 20u);
        const auto ties = [&](const char* format, double ratio) { return point_at(study, format, ratio).error.median; };
        for (const double ratio : {1e2, 1e3, 1e4, 1e5}) {
            EXPECT_EQ(ties("8 bits", ratio), 100);
            EXPECT_EQ(fact_of(point_at(study, "8 bits", ratio), "wrong as drawn, %"), far_first ? 100 : 0);
            for (const char* format : {"24 bits", "float32", "reversed float32"})
                EXPECT_EQ(ties(format, ratio), 0) << format;
        }
        EXPECT_EQ(ties("16 bits", 1e2), 0);
        EXPECT_EQ(ties("16 bits", 1e4), 100);
        EXPECT_EQ(ties("16 bits", 1e5), 100);
        EXPECT_NEAR(fact_of(point_at(study, "8 bits", 1e2), "farthest mistaken, % behind"), 0.1, 1e-3);
        EXPECT_NEAR(fact_of(point_at(study, "8 bits", 1e4), "farthest mistaken, % behind"), 900, 1e-3);
        EXPECT_EQ(maps[0].name, "depth-8-bits-1e+02");
        for (const float value : maps[0].pixels) EXPECT_EQ(value, far_first ? 1.f : 0.5f);
        for (const float value : maps[19].pixels) EXPECT_EQ(value, 0.f);
    }
}

/// Float64 tells them apart; float32 near 1 has steps of 2^-24, and reversed ones of 2^-24 of the depth itself.
TEST(DepthStudy, FindsWhereFloatsEnd) {
    const Study study = study_depth(device(), walls_at({100.f, 10.0001f, 10.f}), small_depths);
    EXPECT_EQ(point_at(study, "float32", 1e2).error.median, 0);
    EXPECT_EQ(point_at(study, "float32", 1e5).error.median, 100);
    EXPECT_EQ(point_at(study, "24 bits", 1e5).error.median, 100);
    EXPECT_EQ(point_at(study, "reversed float32", 1e5).error.median, 0);
}

TEST(DepthStudy, CountsWhatIsBeforeTheNearPlaneApart) {
    const Study study = study_depth(device(), walls_at({100.f, 0.5f}), small_depths);
    EXPECT_EQ(fact_of(point_at(study, "8 bits", 1e2), "clipped, %"), 100);
    EXPECT_TRUE(std::isnan(fact_of(point_at(study, "8 bits", 1e3), "clipped, %")) ||
                fact_of(point_at(study, "8 bits", 1e3), "clipped, %") == 0);
    EXPECT_EQ(point_at(study, "8 bits", 1e2).error.median, 0);
}

TEST(DepthStudy, OfHillsNeedsReversedFloats) {
    const StudyOptions options{.config = {.width = 64, .height = 64}};
    const Study study = study_depth(device(), *builtin_scene("hills"), options);
    EXPECT_NE(study.findings.at(0).find("in 4096 of 4096 pixels"), std::string::npos) << study.findings.at(0);
    EXPECT_GT(point_at(study, "8 bits", 1e4).error.median, 10);
    EXPECT_GT(point_at(study, "16 bits", 1e4).error.median, 1);
    for (const double ratio : {1e2, 1e3, 1e4, 1e5})
        EXPECT_EQ(point_at(study, "reversed float32", ratio).error.median, 0) << ratio;
    const std::vector<std::string> summary = summary_of({study});
    ASSERT_EQ(summary.size(), 1u);
    EXPECT_NE(summary[0].find("reversed float32 0 %"), std::string::npos) << summary[0];
}

TEST(DepthStudy, HasNothingToCompareInOrthographicOrEmptyViews) {
    Scene scene = walls_at({10.f});
    scene.camera->projection = Projection::orthographic, scene.camera->orthographic_height = 3.f;
    EXPECT_TRUE(study_depth(device(), scene, small_depths).points.empty());
    scene.camera = Camera{{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 50.f};
    EXPECT_TRUE(study_depth(device(), scene, small_depths).points.empty());
}

/// A wall that every light gives a radiance of 0.25, without noise.
Scene wall_under(std::size_t lights) {
    Scene scene = walls_at({10.f});
    scene.materials[0].albedo = glm::vec3(0.5f);
    Light light;
    light.kind = LightKind::directional, light.direction = {0, 0, -1};
    light.intensity = glm::vec3(0.5f * std::numbers::pi_v<float>);
    scene.lights.assign(lights, light);
    return scene;
}

double radiance_of_added_values(double radiance, double count) {
    const double sum = count * (1.055 * std::pow(radiance, 1 / 2.4) - 0.055);
    return std::pow((sum + 0.055) / 1.055, 2.4);
}

TEST(GammaStudy, IsWhatTheCurveSays) {
    const StudyOptions options{.config = {.width = 8, .height = 8, .max_depth = 1}, .most_spp = 1, .runs = 1};
    const Study study = study_gamma(device(), wall_under(4), options);
    ASSERT_EQ(study.points.size(), 2u);
    const double twice = radiance_of_added_values(0.5, 2), four_times = radiance_of_added_values(0.25, 4);
    EXPECT_EQ(study.points[0].setting, "2 groups");
    EXPECT_EQ(study.points[1].setting, "4 lights");
    EXPECT_NEAR(study.points[0].error.median, twice - 1, 1e-5);
    EXPECT_NEAR(study.points[1].error.median, four_times - 1, 1e-5);
    EXPECT_NEAR(fact_of(study.points[1], "mean brightness"), four_times, 1e-5);
}

TEST(GammaStudy, NeedsTwoLights) {
    const StudyOptions options{.config = {.width = 8, .height = 8}, .most_spp = 1, .runs = 1};
    const Study study = study_gamma(device(), wall_under(1), options);
    EXPECT_TRUE(study.points.empty());
    EXPECT_EQ(study.findings.size(), 1u);
}

}  // namespace
}  // namespace claray::test
