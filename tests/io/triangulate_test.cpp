// Polygons of many corners: whole, and in a time that grows like their number.
#include "host/io/obj/triangulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace claray {
namespace {

using Polygon = std::vector<glm::vec3>;

double area_of(const Polygon& p) {
    double sum = 0;
    for (std::size_t i = 0, k = p.size() - 1; i < p.size(); k = i++)
        sum += 0.5 * (double(p[k].x) * double(p[i].y) - double(p[i].x) * double(p[k].y));
    return sum;
}

Polygon circle(std::size_t corners, float depth) {
    Polygon p;
    for (std::size_t i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * double(i) / double(corners), r = i % 2 ? 1 : 1 - double(depth);
        p.emplace_back(std::round(1e6 * r * std::cos(angle)) / 1e6, std::round(1e6 * r * std::sin(angle)) / 1e6, 0.f);
    }
    return p;
}

/// Teeth on a bar.
Polygon comb(std::size_t corners) {
    Polygon p = {{0, 0, 0}, {1, 0, 0}};
    for (std::size_t i = corners - 2; i-- > 0;) p.emplace_back(float(i) / float(corners - 3), i % 2 ? 1.f : 0.5f, 0.f);
    return p;
}

/// A strip that is rolled up, whose ears are at its ends only.
Polygon spiral(std::size_t corners) {
    Polygon p;
    const std::size_t half = corners / 2;
    const auto at = [&](std::size_t i, double width) {
        const double turns = 0.01 * double(half), angle = 2 * std::numbers::pi * turns * double(i) / double(half);
        return glm::vec3((1 + angle + width) * std::cos(angle), (1 + angle + width) * std::sin(angle), 0);
    };
    for (std::size_t i = 0; i < half; ++i) p.push_back(at(i, 2));
    for (std::size_t i = half; i-- > 0;) p.push_back(at(i, 0));
    return p;
}

/// Random corners: it crosses itself everywhere.
Polygon tangle(std::size_t corners) {
    Polygon p;
    std::uint32_t state = 1;
    const auto random = [&] { return float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f; };
    for (std::size_t i = 0; i < corners; ++i) p.emplace_back(random(), random(), 0.f);
    return p;
}

Polygon plain_circle(std::size_t corners) { return circle(corners, 0.f); }
Polygon star(std::size_t corners) { return circle(corners, 0.5f); }

struct Shape {
    const char* name;
    Polygon (*make)(std::size_t corners);
};

class Polygons : public testing::TestWithParam<Shape> {};

TEST_P(Polygons, AreWholeAndLookAtFewPoints) {
    for (const std::size_t corners : {200u, 2000u, 20000u}) {
        const Polygon p = GetParam().make(corners);
        std::vector<glm::uvec3> triangles;
        const std::size_t looks = triangulate(p, triangles);
        ASSERT_EQ(triangles.size(), p.size() - 2);
        double sum = 0;
        for (const glm::uvec3& t : triangles) sum += area_of({p[t.x], p[t.y], p[t.z]});
        EXPECT_NEAR(sum, area_of(p), 1e-4 * std::max(1.0, std::abs(sum))) << corners;
        EXPECT_LT(looks, 200 * corners);
    }
}

INSTANTIATE_TEST_SUITE_P(Of, Polygons,
                         testing::Values(Shape{"circle", plain_circle}, Shape{"star", star}, Shape{"comb", comb},
                                         Shape{"spiral", spiral}, Shape{"tangle", tangle}),
                         [](const auto& shape) { return std::string(shape.param.name); });

}  // namespace
}  // namespace claray
