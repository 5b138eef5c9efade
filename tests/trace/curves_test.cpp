// Curves: primitives/curves.clh, a kind of primitives/primitives.cl.
#include "claray/primitives/curves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/verify/oracles/primitive_oracle.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/not_finite.hpp"
#include "tests/support/query.hpp"

namespace claray::test {
namespace {

using namespace verify;  // the oracle of curves

class CurvesTest : public testing::TestWithParam<std::tuple<CurveBasis, CurveShape, Layout>> {
protected:
    static CurveBasis basis() { return std::get<0>(GetParam()); }
    static CurveShape shape() { return std::get<1>(GetParam()); }
    static Primitives build(const Tufts& tufts, Builder builder = Builder::balanced) {
        return build_curves(device(), tufts.points, tufts.segments, basis(), shape(),
                            {.builder = builder, .layout = std::get<2>(GetParam())});
    }
};

/// A curve that is thinner by the tolerance is hit later or not, one that is thicker earlier.
TEST_P(CurvesTest, HitsAreWithinTheToleranceOfTheExactCurve) {
    const Tufts tufts = random_strands(40, 3, basis(), 1);
    const std::vector<ExactCurve> curves = exact_curves(tufts, basis());
    const std::vector<Ray> rays = random_rays(1501, 4.f, 1.f, 2);
    const std::vector<Hit> hits = closest_hit(build(tufts), rays);
    constexpr double tolerance = 0.02 / 32 + 0.02 / 50;  // and the steps of the samples
    std::size_t found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const double unit = std::sqrt(rays[i].dx * rays[i].dx + rays[i].dy * rays[i].dy + rays[i].dz * rays[i].dz);
        const auto [early, late] = first_contact(curves, rays[i], tolerance, shape());
        const bool hit = hits[i].primitive != CLARAY_MISS;
        found += hit;
        if (hit) {
            const double slack = shape() == CurveShape::flat ? 0.01 / unit : 1e-6;  // a step of the samples
            ASSERT_TRUE(std::isfinite(hits[i].t)) << i;
            ASSERT_GE(hits[i].t, early - slack) << i;
            ASSERT_LE(hits[i].t, late + slack) << i;
            ASSERT_TRUE(hits[i].u >= 0 && hits[i].u <= 1 && std::fabs(hits[i].v) <= 1) << i;
        } else {
            ASSERT_EQ(late, infinity) << i;
        }
    }
    EXPECT_GT(found, 50u);
}

/// Rays that begin just before a surface, or a little in front of it, meet it as rays from afar do.
TEST_P(CurvesTest, RaysMayBeginAtASurface) {
    const Primitives curves = build(random_strands(60, 5, basis(), 7));
    const std::vector<Ray> rays = random_rays(3001, 4.f, 1.f, 8);
    const std::vector<Hit> hits = closest_hit(curves, rays);
    for (const float share : {0.99999f, 0.999f, 0.99f}) {
        std::vector<Ray> late = rays;
        for (std::size_t i = 0; i < rays.size(); ++i)
            if (hits[i].primitive != CLARAY_MISS) late[i].tmin = share * hits[i].t;
        const std::vector<Hit> again = closest_hit(curves, late);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(again[i].primitive, hits[i].primitive) << i;
            ASSERT_EQ(again[i].t, hits[i].t) << i;
        }
    }
}

TEST_P(CurvesTest, HitsDoNotDependOnTheTree) {
    const Tufts tufts = random_strands(60, 5, basis(), 3);
    const std::vector<Ray> rays = random_rays(3001, 4.f, 1.f, 4);
    const Primitives here = build(tufts);
    const std::vector<Hit> hits = closest_hit(here, rays), every = closest_hit(here, rays, brute_force),
                           other = closest_hit(build(tufts, Builder::high), rays);
    const std::vector<std::uint8_t> occluded = any_hit(here, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i].primitive, every[i].primitive) << i;
        ASSERT_EQ(hits[i].t, every[i].t) << i;
        ASSERT_EQ(hits[i].u, every[i].u) << i;
        ASSERT_EQ(hits[i].primitive, other[i].primitive) << i;
        ASSERT_EQ(occluded[i] != 0, hits[i].primitive != CLARAY_MISS) << i;
    }
}

TEST_P(CurvesTest, MoveWithTheirData) {
    Tufts tufts = random_strands(30, 4, basis(), 9);
    Primitives curves = build(tufts);
    for (glm::vec4& p : tufts.points) p += glm::vec4(0.25f, 0, 0, 0.01f);
    const std::vector<Ray> rays = random_rays(1001, 4.f, 1.f, 10);
    const std::vector<Hit> expected = closest_hit(build(tufts), rays);
    Buffer<float>(curves.data()).write(curve_data(tufts.points, tufts.segments, basis()));
    for (const bool anew : {false, true}) {
        anew ? curves.rebuild() : curves.refit();
        const std::vector<Hit> hits = closest_hit(curves, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(hits[i].primitive, expected[i].primitive) << i;
            ASSERT_EQ(hits[i].t, expected[i].t) << i;
        }
    }
}

/// Rays at the centre line, also exactly at the joints of segments and of their pieces, hit.
TEST_P(CurvesTest, HaveWatertightJoints) {
    const Tufts tufts = random_strands(40, 6, basis(), 5);
    const std::vector<ExactCurve> curves = exact_curves(tufts, basis());
    Random random(6);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < curves.size(); ++i)
        for (const double s : {0., 1. / 8, 0.25, 0.3, 0.5, 5. / 8, 1.})
            for (int k = 0; k < 4; ++k) {
                const glm::vec3 target(glm::dvec3(curves[i].at(s))),
                    origin = 10.f * random.in_cube(1) + glm::vec3(0, 0, 12);
                rays.push_back(make_ray(origin, target - origin));
            }
    const std::vector<std::uint8_t> occluded = any_hit(build(tufts), rays);
    EXPECT_EQ(std::count(occluded.begin(), occluded.end(), 0), 0);
}

TEST_P(CurvesTest, FewNoneAndInvalid) {
    const Tufts none;
    const std::vector<Ray> rays = {make_ray({0, 0, 4}, {0, 0, -1}), make_ray({0, 0, 4}, {0, 0, -3})};
    EXPECT_EQ(closest_hit(build(none), rays)[0].primitive, CLARAY_MISS);
    Tufts one;  // a straight line along x, and segments without radius or place
    for (int i = 0; i < 4; ++i) one.points.emplace_back(i - 1.5f, 0, 0, 0.5f);
    for (int i = 0; i < 4; ++i) one.points.emplace_back(i - 1.5f, 0, 1, -1.f);
    for (int i = 0; i < 4; ++i) one.points.emplace_back(i - 1.5f, 0, nan, 1.f);
    one.segments = {0, 4, 8};
    const Primitives curves = build(one);
    EXPECT_EQ(curves.bvh().statistics().triangles, 1u);
    const std::vector<Hit> hits = closest_hit(curves, rays);
    const float depth = shape() == CurveShape::round ? 3.5f : 4.f;
    EXPECT_EQ(hits[0].primitive, 0u);
    EXPECT_NEAR(hits[0].t, depth, 1e-6f);
    EXPECT_NEAR(hits[0].u, 0.5f, 1e-6f);
    EXPECT_NEAR(hits[1].t, depth / 3, 1e-6f);
    one.segments = {9};
    EXPECT_TRUE(throws_error(ErrorKind::user, "control point 9", [&] { (void)build(one); }));
}

INSTANTIATE_TEST_SUITE_P(Kinds, CurvesTest,
                         testing::Values(std::tuple(CurveBasis::bspline, CurveShape::round, Layout::wide),
                                         std::tuple(CurveBasis::bezier, CurveShape::flat, Layout::wide),
                                         std::tuple(CurveBasis::bezier, CurveShape::round, Layout::binary),
                                         std::tuple(CurveBasis::bspline, CurveShape::flat, Layout::binary)));

}  // namespace
}  // namespace claray::test
