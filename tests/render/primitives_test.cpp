// Scenes that hold primitives: what is seen of them, their light and their shadows;
// host/primitives/scene_primitives.cpp, kernels/shade/primitive_surface.clh.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claray/renderer.hpp"
#include "host/scene/builtin/shapes.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"

namespace claray::test {
namespace {

using Kind = PrimitiveSet::Kind;

PrimitiveSet set_of(Kind kind, std::vector<glm::vec4> points, std::uint32_t material = 0) {
    PrimitiveSet set;
    set.kind = kind, set.points = std::move(points);
    if (are_curves(set))
        for (std::uint32_t i = 0; i + 4 <= set.points.size(); i += 4) set.segments.push_back(i);
    set.materials.assign(primitive_count(set), material);
    return set;
}

/// Seen along -z by parallel rays, one of every kind: balls, a disc, a closed cylinder, and a straight curve, which is
/// a tube with round ends.
Scene all_kinds() {
    Scene scene;
    scene.materials = {lambert(0.25f), lambert(0.5f), lambert(0.75f)};
    scene.meshes = {square(3.f, -1.5f)};
    scene.primitives = {
        set_of(Kind::bezier_curves,
               {{-1.f, 1.f, 0.f, 0.2f}, {-0.5f, 1.f, 0.25f, 0.2f}, {0.f, 1.f, 0.5f, 0.2f}, {0.5f, 1.f, 0.75f, 0.2f}},
               2),
        set_of(Kind::spheres, {{-0.9f, -0.5f, 0.3f, 0.5f}, {-0.5f, -0.4f, 0.1f, 0.45f}}, 1),
        set_of(Kind::discs, {{0.4f, 0.3f, 0.f, 0.4f}, {0.3f, 0.2f, 2.f, 0.1f}}),
        set_of(Kind::cylinders, {{0.6f, -0.6f, 0.f, 0.3f}, {1.f, -0.3f, 0.8f, 1.f}}, 2),
    };
    Camera camera{{0.f, 0.f, 10.f}, {0.f, 0.f, 0.f}, {0.f, 1.f, 0.f}};
    camera.orthographic_height = 3.f;
    scene.camera = camera;
    scene.lights = {point_light({2.f, 3.f, 6.f}, {40.f, 40.f, 40.f})};
    scene.sky = {glm::vec3(0.3f), glm::vec3(0.5f)};
    return scene;
}

/// What a ray along -z from z = 10 meets.
struct Seen {
    double z = -1e30;
    glm::dvec3 normal{0};
    unsigned number = CLARAY_MISS;
    void meet(double at, const glm::dvec3& n, unsigned i) {
        if (at > z) z = at, normal = n, number = i;
    }
};

void meet_ball(Seen& seen, const glm::dvec3& p, const glm::dvec4& ball, unsigned number) {
    const double dx = p.x - ball.x, dy = p.y - ball.y, inside = ball.w * ball.w - dx * dx - dy * dy;
    if (inside >= 0) seen.meet(ball.z + std::sqrt(inside), glm::dvec3(dx, dy, std::sqrt(inside)) / ball.w, number);
}

/// The round side of a tube from a to b.
void meet_side(Seen& seen, const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, double r, unsigned number) {
    const glm::dvec3 axis = glm::normalize(b - a), d(0, 0, -1);
    const glm::dvec3 from = p - a - glm::dot(p - a, axis) * axis, along = d - glm::dot(d, axis) * axis;
    const double aa = glm::dot(along, along), bb = glm::dot(from, along), cc = glm::dot(from, from) - r * r;
    if (bb * bb < aa * cc) return;
    const double t = (-bb - std::sqrt(bb * bb - aa * cc)) / aa, s = glm::dot(p + t * d - a, axis);
    if (s >= 0 && s <= glm::length(b - a)) seen.meet((p + t * d).z, (from + t * along) / r, number);
}

void meet_disc(Seen& seen, const glm::dvec3& p, const glm::dvec3& center, const glm::dvec3& n, double least, double r,
               unsigned number) {
    const double t = glm::dot(center - p, n) / -n.z;
    const glm::dvec3 at = p - glm::dvec3(0, 0, t);
    const double distance = glm::length(at - center);
    if (distance >= least && distance <= r) seen.meet(at.z, glm::normalize(n.z < 0 ? -n : n), number);
}

/// Numbers of primitives go by kind: spheres, discs, cylinders, curves; the two triangles come first.
Seen look_at(const Scene& scene, const glm::dvec3& p) {
    Seen seen;
    const auto point = [&](int set, int i) { return glm::dvec4(scene.primitives[set].points[i]); };
    meet_ball(seen, p, point(1, 0), 2), meet_ball(seen, p, point(1, 1), 3);
    meet_disc(seen, p, point(2, 0), point(2, 1), point(2, 1).w, point(2, 0).w, 4);
    const glm::dvec3 a(point(3, 0)), b(point(3, 1));
    meet_side(seen, p, a, b, point(3, 0).w, 5);
    for (const glm::dvec3& end : {a, b}) meet_disc(seen, p, end, b - a, 0, point(3, 0).w, 5);
    meet_side(seen, p, point(0, 0), point(0, 3), point(0, 0).w, 6);
    meet_ball(seen, p, point(0, 0), 6), meet_ball(seen, p, point(0, 3), 6);
    return seen;
}

TEST(ScenePrimitives, AreSeenExactly) {
    const Scene scene = all_kinds();
    constexpr unsigned side = 96;
    const Aovs aovs = Renderer(device(), scene, {.width = side, .height = side}).aovs();
    const float albedo_of[] = {0.25f, 0.25f, 0.5f, 0.5f, 0.25f, 0.75f, 0.75f};
    std::vector<unsigned> pixels(7);
    for (unsigned i = 0; i < side * side; ++i) {
        const double x = 3 * ((i % side + 0.5) / side - 0.5), y = 3 * (0.5 - (i / side + 0.5) / side);
        const Seen seen = look_at(scene, {x, y, 10});
        ASSERT_EQ(aovs.primitive[i], seen.number) << x << ' ' << y;
        if (seen.number == CLARAY_MISS) continue;
        ++pixels[seen.number];
        EXPECT_NEAR(aovs.depth[i], 10 - seen.z, 2e-6) << seen.number;
        EXPECT_LT(glm::length(glm::dvec3(aovs.normal[i]) - seen.normal), 1e-6)
            << seen.number << " at " << x << ' ' << y;
        EXPECT_EQ(aovs.albedo[i].x, albedo_of[seen.number]);
    }
    for (unsigned number = 2; number < 7; ++number) EXPECT_GT(pixels[number], 100u) << number;
}

}  // namespace
}  // namespace claray::test
