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
#include "tests/support/process.hpp"
#include "tests/support/tuning.hpp"

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
    camera.projection = Projection::orthographic, camera.orthographic_height = 3.f;
    scene.camera = camera;
    scene.lights = {point_light({2.f, 3.f, 6.f}, {40.f, 40.f, 40.f})};
    scene.sky = {glm::vec3(0.3f), glm::vec3(0.5f)};
    return scene;
}

/// The same scene with all kinds: those that it lacks are out of sight, so that one set of kernels serves several
/// tests.
Scene with_all_kinds(Scene scene) {
    for (PrimitiveSet other : all_kinds().primitives) {
        const auto same = [&](const PrimitiveSet& set) { return set.kind == other.kind; };
        if (std::any_of(scene.primitives.begin(), scene.primitives.end(), same)) continue;
        for (std::size_t i = 0; i < other.points.size(); ++i)
            if (other.kind != Kind::discs || i % 2 == 0) other.points[i].y -= 30;
        scene.primitives.push_back(other);
    }
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
        // The ray's origin is rounded, which counts the more the more the surface is turned away.
        const double slope = 1 / seen.normal.z;
        EXPECT_NEAR(aovs.depth[i], 10 - seen.z, 1e-6 + 2e-7 * slope) << seen.number;
        EXPECT_LT(glm::length(glm::dvec3(aovs.normal[i]) - seen.normal), 1e-7 + 1e-6 * slope) << seen.number;
        EXPECT_EQ(aovs.albedo[i].x, albedo_of[seen.number]);
    }
    for (unsigned number = 2; number < 7; ++number) EXPECT_GT(pixels[number], 100u) << number;
}

TEST(ScenePrimitives, AreHiddenByTrianglesBeforeThem) {
    Scene scene = all_kinds();
    const Aovs open = Renderer(device(), scene, {.width = 64, .height = 64}).aovs();
    Mesh& curtain = scene.meshes.emplace_back();  // before the left half
    curtain.positions = {{-3, -3, 5}, {0, -3, 5}, {0, 3, 5}, {-3, 3, 5}};
    curtain.triangles = {{0, 1, 2}, {0, 2, 3}};
    const Aovs half = Renderer(device(), scene, {.width = 64, .height = 64}).aovs();
    for (unsigned i = 0; i < 64 * 64; ++i) {
        if (i % 64 < 32) {
            ASSERT_TRUE(half.primitive[i] == 2 || half.primitive[i] == 3) << i;
            ASSERT_EQ(half.depth[i], 5.f);
        } else if (open.primitive[i] != CLARAY_MISS) {
            ASSERT_EQ(half.primitive[i], open.primitive[i] + 2) << i;
        }
    }
}

/// The normal of a thick bent curve points away from the nearest point of its centre line, but for the bend of a piece.
TEST(ScenePrimitives, BentCurvesHaveTheNormalsOfTheirPieces) {
    Scene scene = all_kinds();
    const glm::dvec2 p[] = {{-1, -1}, {-1, 0.6}, {1, 0.6}, {1, -1}};
    scene.meshes.clear(), scene.primitives.resize(1);
    for (int i = 0; i < 4; ++i) scene.primitives[0].points[i] = glm::vec4(p[i], 0, 0.25f);
    scene = with_all_kinds(scene);
    constexpr unsigned side = 64;
    const Aovs aovs = Renderer(device(), scene, {.width = side, .height = side}).aovs();
    double most = 0, sum = 0;
    unsigned seen = 0;
    for (unsigned i = 0; i < side * side; ++i) {
        if (aovs.primitive[i] == CLARAY_MISS) continue;
        const glm::dvec3 at(3 * ((i % side + 0.5) / side - 0.5), 3 * (0.5 - (i / side + 0.5) / side),
                            10 - aovs.depth[i]);
        glm::dvec3 nearest(1e30);
        for (int k = 0; k <= 1000; ++k) {
            const double s = k * 1e-3, r = 1 - s;
            const glm::dvec2 c = r * r * r * p[0] + 3 * r * r * s * p[1] + 3 * r * s * s * p[2] + s * s * s * p[3];
            const glm::dvec3 from = at - glm::dvec3(c, 0);
            if (glm::dot(from, from) < glm::dot(nearest, nearest)) nearest = from;
        }
        const double difference = glm::length(glm::normalize(nearest) - glm::dvec3(aovs.normal[i]));
        most = std::max(most, difference), sum += difference, ++seen;
    }
    EXPECT_GT(seen, 500u);
    EXPECT_LT(most, 0.16);
    EXPECT_LT(sum / seen, 0.04) << most;
}

/// The balls and tubes of a scene as triangles so fine that no pixel shows their edges.
Scene as_triangles(Scene scene) {
    for (const PrimitiveSet& set : scene.primitives)
        for (const glm::vec4& ball : set.points)
            if (set.kind == Kind::spheres)
                scene.meshes.push_back(scenes::make_sphere(glm::vec3(ball), ball.w, 5, set.materials[0]));
    scene.primitives.clear();
    return scene;
}

std::vector<glm::vec3> rendered(const Scene& scene, const RenderConfig& config) {
    Renderer renderer(device(), scene, config);
    (void)renderer.render();
    return renderer.image();
}

/// A straight ribbon of flat curves alone, before the camera of all_kinds().
Scene ribbon() {
    Scene scene = all_kinds();
    scene.primitives.resize(1);
    scene.primitives[0].kind = Kind::flat_bezier_curves;
    scene.meshes.clear();
    return scene;
}

/// It faces every ray: to the next one, too, it turns, which must not meet it again.
TEST(ScenePrimitives, FlatCurvesFaceTheRay) {
    Scene scene = ribbon();
    scene.sky = {};
    constexpr unsigned side = 96;
    const RenderConfig config{.width = side, .height = side, .spp = 16, .max_depth = 1};
    const Aovs aovs = Renderer(device(), scene, config).aovs();
    const std::vector<glm::vec3> image = rendered(scene, config);
    const glm::dvec3 a(scene.primitives[0].points[0]), b(scene.primitives[0].points[3]), axis = glm::normalize(b - a);
    const glm::dvec3 normal = glm::normalize(glm::dvec3(0, 0, 1) - axis.z * axis), light(2, 3, 6);
    unsigned seen = 0;
    for (unsigned i = 0; i < side * side; ++i) {
        const double x = 3 * ((i % side + 0.5) / side - 0.5), y = 3 * (0.5 - (i / side + 0.5) / side);
        const double s = (x - a.x) / (b.x - a.x), off = std::abs(y - a.y);
        if (aovs.primitive[i] != CLARAY_MISS) {
            EXPECT_LT(off, 0.2 + 1e-6);
            EXPECT_TRUE(s > -0.14 && s < 1.14) << s;
        }
        if (s < 0.02 || s > 0.98 || off > 0.17) continue;  // the middle, without the half circles
        ASSERT_EQ(aovs.primitive[i], 0u) << x << ' ' << y;
        EXPECT_NEAR(aovs.depth[i], 10 - (a.z + s * (b.z - a.z)), 2e-6);
        EXPECT_LT(glm::length(glm::dvec3(aovs.normal[i]) - normal), 2e-6);
        const glm::dvec3 to = light - (glm::dvec3(x, y, 10 - aovs.depth[i]) + 0.2 * normal);
        const double expected = 0.75 / std::numbers::pi * 40 * glm::dot(normal, to) / std::pow(glm::length(to), 3);
        EXPECT_NEAR(image[i].x, expected, 0.01 * expected) << x << ' ' << y;
        ++seen;
    }
    EXPECT_GT(seen, 300u);
}

/// Balls on a floor, before a wall of triangles that shades some of them, under a lamp and a sky.
Scene balls_on_a_floor() {
    Scene scene = all_kinds();
    scene.primitives = {set_of(Kind::spheres, {{-0.8f, -0.9f, 0.3f, 0.6f}, {0.5f, -1.1f, 0.8f, 0.4f}}, 1)};
    Mesh roof = square(0.5f, 1.2f, 2);
    for (glm::vec3& p : roof.positions) p += glm::vec3(1.f, 0.f, 1.5f);
    scene.meshes.push_back(roof);
    scene.camera = Camera{{0.f, 1.f, 6.f}, {0.f, -0.6f, 0.f}, {0.f, 1.f, 0.f}, 35.f};
    return with_all_kinds(scene);
}

double largest_difference(const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b, unsigned width) {
    constexpr unsigned block = 8;
    double most = 0;
    for (std::size_t y = 0; y + block <= a.size() / width; y += block)
        for (std::size_t x = 0; x + block <= width; x += block) {
            double sum = 0, of_a = 0;
            for (std::size_t i = 0; i < block * block; ++i) {
                const std::size_t at = (y + i / block) * width + x + i % block;
                sum += a[at].x - b[at].x, of_a += a[at].x;
            }
            most = std::max(most, std::abs(sum) / of_a);
        }
    return most;
}

TEST(ScenePrimitives, LookLikeFineTriangles) {
    const Scene scene = balls_on_a_floor();
    const RenderConfig config{.width = 64, .height = 64, .spp = 64, .max_depth = 4};
    const std::vector<glm::vec3> exact = rendered(scene, config), fine = rendered(as_triangles(scene), config);
    EXPECT_NEAR(mean(exact).x / mean(fine).x, 1, 2e-3);
    EXPECT_LT(largest_difference(exact, fine, 64), 0.05);
}

/// Radiance at the middle of the image.
float light_at(const Scene& scene, const glm::vec3& point) {
    Scene seen = scene;
    seen.camera = narrow_camera(point + glm::vec3(0.2f, 0.5f, 3.f), point);
    return rendered(seen, {.width = 1, .height = 1, .spp = 4, .max_depth = 1})[0].x;
}

TEST(ScenePrimitives, ShadeTrianglesAndAreShadedByThem) {
    Scene scene = all_kinds();
    scene.sky = {};
    scene.lights = {point_light({0.f, 8.f, 0.f}, glm::vec3(100.f))};
    for (const Kind kind : {Kind::spheres, Kind::discs, Kind::cylinders, Kind::bezier_curves}) {
        const auto at = [&](float x, float y, float z) { return glm::vec4(x, y, z, 0.3f); };
        std::vector<glm::vec4> points = {at(0, 0, 0)};
        if (kind == Kind::discs) points.emplace_back(0, 1, 0, 0);
        if (kind == Kind::cylinders) points.emplace_back(0, 0.3f, 0, 1);
        if (kind == Kind::bezier_curves) points = {at(-1, 0, 0), at(-0.3f, 0, 0), at(0.3f, 0, 0), at(1, 0, 0)};
        scene.primitives = {set_of(kind, points, 1)};
        scene = with_all_kinds(scene);
        const float top = kind == Kind::discs ? 0.f : 0.3f;
        EXPECT_EQ(light_at(scene, {0, -1.5f, 0}), 0.f) << "below " << int(kind);
        EXPECT_GT(light_at(scene, {2.4f, -1.5f, 0}), 0.05f);
        const double expected = 0.5 / std::numbers::pi * 100 / ((8 - top) * (8 - top));
        EXPECT_NEAR(light_at(scene, {0, top, 0}), expected, 1e-3 * expected) << "on " << int(kind);
        Scene roofed = scene;
        roofed.meshes.push_back(square(0.5f, 2.f));
        EXPECT_EQ(light_at(roofed, {0, top, 0}), 0.f) << "under a roof " << int(kind);
    }
}

/// Strands as curves, and as tubes of 8 sides in 16 pieces per segment.
TEST(ScenePrimitives, CurvesLookLikeTubes) {
    Scene scene = *builtin_scene("curves:2000");
    for (glm::vec4& p : scene.primitives[0].points) p.w *= 2;
    Scene tubes = scene;
    tubes.primitives.clear();
    constexpr unsigned pieces = 16, sides = 8;
    const PrimitiveSet& set = scene.primitives[0];
    Mesh& mesh = tubes.meshes.emplace_back();
    for (std::size_t segment = 0; segment < set.segments.size(); ++segment) {
        const glm::vec4* p = &set.points[set.segments[segment]];
        const auto first = std::uint32_t(mesh.positions.size());
        for (unsigned i = 0; i <= pieces; ++i) {
            const float s = float(i) / pieces, r = 1 - s;
            const glm::vec4 at = (r * r * r * p[0] + (3 * s * s * s - 6 * s * s + 4) * p[1] +
                                  (3 * r * r * r - 6 * r * r + 4) * p[2] + s * s * s * p[3]) /
                                 6.f;
            const glm::vec3 along = glm::normalize(
                glm::vec3(-r * r * p[0] + (3 * s * s - 4 * s) * p[1] + (-3 * r * r + 4 * r) * p[2] + s * s * p[3]));
            const glm::vec3 u = glm::normalize(glm::cross(along, glm::vec3(0.31f, 0.2f, 0.93f))),
                            v = glm::cross(along, u);
            for (unsigned k = 0; k < sides; ++k) {
                const float angle = 2 * std::numbers::pi_v<float> * float(k) / sides;
                // As wide as the round tube looks in the mean.
                const float radius = at.w / std::cos(0.5f * std::numbers::pi_v<float> / sides);
                mesh.positions.push_back(glm::vec3(at) + radius * (std::cos(angle) * u + std::sin(angle) * v));
                mesh.normals.push_back(std::cos(angle) * u + std::sin(angle) * v);
                if (i == pieces) continue;
                const std::uint32_t a = first + i * sides + k, b = first + i * sides + (k + 1) % sides;
                mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + sides}, {a, b + sides, a + sides}});
                mesh.materials.insert(mesh.materials.end(), 2, set.materials[segment]);
            }
        }
    }
    const RenderConfig config{.width = 64, .height = 64, .spp = 64, .max_depth = 6};
    Renderer of_curves(device(), scene, config), of_tubes(device(), tubes, config);
    (void)of_curves.render(), (void)of_tubes.render();
    const glm::dvec3 a = mean(of_curves.image()), b = mean(of_tubes.image());
    EXPECT_NEAR(a.x / b.x, 1, 3e-3);
    EXPECT_NEAR(a.z / b.z, 1, 3e-3);
    Scene bald = scene;
    bald.primitives.clear();
    const double hair = mean(rendered(bald, config)).z - a.z;  // light that the hair takes away
    EXPECT_GT(hair, 0.02);
    EXPECT_NEAR(hair / (mean(rendered(bald, config)).z - b.z), 1, 0.02);
    EXPECT_LT(of_curves.statistics().bvh.bytes, of_tubes.statistics().bvh.bytes / 10);
    EXPECT_EQ(of_curves.statistics().primitives, set.segments.size());
}

/// White surfaces in white light can't be seen, unless rays that leave them meet them at once.
TEST(ScenePrimitives, VanishInAFurnace) {
    Scene scene = all_kinds();
    scene.meshes.clear(), scene.lights.clear();
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    for (Material& m : scene.materials) m.albedo = glm::vec3(1.f);
    RenderConfig config{.width = 48, .height = 48, .spp = 16, .max_depth = 200};
    for (const glm::vec3& pixel : rendered(scene, config)) EXPECT_NEAR(pixel.x, 1, 0.5);
    EXPECT_NEAR(mean(rendered(scene, config)).x, 1, 1e-3);
    // Far from the origin, and small: distances are rounded to a tenth of the thinnest radius.
    for (PrimitiveSet& set : scene.primitives)
        for (std::size_t i = 0; i < set.points.size(); ++i) {
            const bool place = set.kind != Kind::discs || i % 2 == 0;
            const bool closed = set.kind == Kind::cylinders && i % 2 == 1;
            glm::vec4& p = set.points[i];
            p = place ? glm::vec4(glm::vec3(p) * 1e-4f + 10.f, closed ? p.w : p.w * 1e-4f)
                      : p * glm::vec4(1, 1, 1, 1e-4f);
        }
    scene.camera->position = scene.camera->position * 1e-4f + 10.f;
    scene.camera->target = scene.camera->target * 1e-4f + 10.f;
    scene.camera->orthographic_height *= 1e-4f;
    EXPECT_NEAR(mean(rendered(scene, config)).x, 1, 2e-3) << "far away";
    scene = ribbon();
    scene.primitives.push_back(set_of(Kind::flat_bezier_curves,
                                      {{-1, -1, 0, 0.1f}, {-1, 0, 0.5f, 0.2f}, {1, 0, 0.5f, 0.2f}, {1, -1, 0, 0.3f}}));
    scene.lights.clear(), scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    for (Material& m : scene.materials) m.albedo = glm::vec3(1.f);
    EXPECT_NEAR(mean(rendered(scene, config)).x, 1, 1e-3) << "ribbons";
    // Glass, from inside, too.
    scene = all_kinds();
    scene.primitives.erase(scene.primitives.begin());
    scene.primitives.erase(scene.primitives.begin() + 1);  // a disc encloses nothing
    scene.meshes.clear(), scene.lights.clear();
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    for (Material& m : scene.materials) m = material(MaterialKind::glass, 1.f), m.ior = 1.5f;
    EXPECT_NEAR(mean(rendered(scene, config)).x, 1, 2e-3) << "glass";
}

/// Colours of a curve blend from its begin to its end; a lamp shines; what a material emits is seen and found.
TEST(ScenePrimitives, HaveColoursAndShine) {
    Scene scene = all_kinds();
    scene.primitives[0].colors = {{1, 0, 0}, {0, 1, 0}};
    const RenderConfig config{.width = 96, .height = 96, .spp = 16, .max_depth = 4};
    const Aovs aovs = Renderer(device(), scene, config).aovs();
    const auto at = [](double x, double y) { return std::size_t(48 - 32 * y) * 96 + std::size_t(48 + 32 * x); };
    EXPECT_NEAR(aovs.albedo[at(-0.95, 1)].r, 0.75f, 0.1);
    EXPECT_NEAR(aovs.albedo[at(0.45, 1)].g, 0.75f, 0.1);
    EXPECT_NEAR(aovs.albedo[at(-0.25, 1)].r, 0.375f, 0.1);
    EXPECT_EQ(aovs.albedo[at(-0.9, -0.5)], glm::vec3(0.5f)) << "others stay";
    // A ball that emits 1 sends pi r^2 / d^2 of it to a surface that faces it from the distance d.
    scene.primitives = {set_of(Kind::spheres, {{0, 1.5f, 0, 1}}, 1)};
    scene.materials[1] = emitter(1.f);
    scene.sky = {}, scene.lights.clear();
    Scene below = scene;
    below.camera = narrow_camera({0.1f, -1.4f, 0.1f}, {0, -1.5f, 0});
    const double light = mean(rendered(below, {.width = 8, .height = 8, .spp = 256, .max_depth = 2})).x;
    EXPECT_NEAR(light, 0.25 / 9, 0.001);
}

TEST(ScenePrimitives, StandBesideInstancesAndParts) {
    Scene scene = balls_on_a_floor();
    const RenderConfig config{.width = 64, .height = 64, .spp = 16, .max_depth = 4};
    const std::vector<glm::vec3> expected = rendered(scene, config);
    RenderConfig in_parts = config;
    in_parts.parts = 2;
    EXPECT_TRUE(same_bits(rendered(scene, in_parts), expected)) << "in parts";
    Scene twice = scene;
    twice.meshes = {scene.meshes[1]}, scene.meshes.push_back(scene.meshes[1]);
    for (glm::vec3& p : scene.meshes.back().positions) p.x -= 2.f;
    twice.meshes.push_back(scene.meshes[0]);
    twice.instances = {MeshInstance{0}, MeshInstance{0}, MeshInstance{1}};
    twice.instances[1].transform[3].x = -2.f;
    const Aovs a = Renderer(device(), scene, config).aovs(), b = Renderer(device(), twice, config).aovs();
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
        ASSERT_NEAR(std::min(a.depth[i], 99.f), std::min(b.depth[i], 99.f), 1e-4f) << i;
        if (a.primitive[i] == CLARAY_MISS || a.primitive[i] < 6) continue;
        ASSERT_EQ(b.primitive[i], a.primitive[i] - 2) << i;  // two triangles fewer
    }
    EXPECT_NEAR(mean(rendered(twice, config)).x / mean(rendered(scene, config)).x, 1, 2e-3);
}

TEST(ScenePrimitives, GoOnFromCheckpoints) {
    const TemporaryFolder folder;
    Scene scene = balls_on_a_floor();
    RenderConfig config{.width = 33, .height = 31, .spp = 9, .max_depth = 4};
    const std::vector<glm::vec3> whole = rendered(scene, config);
    config.checkpoint = folder / "c";
    int reports = 1;
    {
        const ScopedTuning tuning("render/wavefront", "FIRST_PATHS", 1000);
        Renderer(device(), scene, config).render([&](const RenderProgress&) { return --reports > 0; });
    }
    config.resume = config.checkpoint;
    EXPECT_TRUE(same_bits(rendered(scene, config), whole));
    scene.primitives[0].points[0].x += 1e-3f;
    EXPECT_TRUE(throws_error(ErrorKind::user, "scene", [&] { Renderer(device(), scene, config); }));
}

TEST(ScenePrimitives, AreValidated) {
    const auto refused = [](const auto& damage, const std::string& words) {
        Scene scene = all_kinds();
        damage(scene);
        return throws_error(ErrorKind::user, words, [&] { validate(scene); });
    };
    validate(all_kinds());
    using S = Scene;
    EXPECT_TRUE(refused([](S& s) { s.primitives[3].points.pop_back(); }, "primitive set 3: 1 points"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[1].segments = {0}; }, "is not of curves"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[0].segments = {1}; }, "control point 1 of 4"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[1].materials = {9, 9}; }, "material 9 of 3"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[1].materials = {0}; }, "1 materials for 2 primitives"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[1].colors.resize(2); }, "2 colours for 4"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[1].colors.assign(4, glm::vec3(2)); }, "colour 0 is not in 0..1"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[1].kind = Kind(9); }, "unknown kind"));
    EXPECT_TRUE(refused([](S& s) { s.primitives[1].kind = Kind::flat_curves; }, "materials for 0 primitives"));
    EXPECT_TRUE(refused([](S& s) { s.materials[2].kind = MaterialKind::glass; }, "curves have no inside"));
    const auto transparent = [](S& s) { s.materials[1].alpha_mode = AlphaMode::blend, s.materials[1].opacity = 0.5f; };
    EXPECT_TRUE(refused(transparent, "lets rays through"));
    const auto textured = [](S& s) {
        Texture& texture = s.textures.emplace_back();
        texture.width = texture.height = 1, texture.bytes = {1, 2, 3, 4};
        s.materials[1].albedo_map.texture = 0;
    };
    EXPECT_TRUE(refused(textured, "has a texture"));
    Scene scene = all_kinds();
    Renderer renderer(device(), scene, {.width = 8, .height = 8});
    scene.primitives.pop_back();
    EXPECT_TRUE(
        throws_error(ErrorKind::usage, "4 primitives instead of 5", [&] { renderer.update(scene, {.camera = true}); }));
}

/// Those that are not finite are left out.
TEST(ScenePrimitives, MayBeBroken) {
    Scene scene = all_kinds();
    const Bounds bounds = bounds_of(scene);
    scene.primitives[1].points.push_back({NAN, 0, 0, 1});
    scene.primitives[1].points.push_back({0, 0, 0, -1});
    scene.primitives[1].materials.resize(4);
    EXPECT_EQ(bounds_of(scene).lo, bounds.lo);
    const RenderConfig config{.width = 32, .height = 32, .spp = 2, .max_depth = 3};
    EXPECT_TRUE(same_bits(rendered(scene, config), rendered(all_kinds(), config)));
}

}  // namespace
}  // namespace claray::test
