// Rays traced by the host, and the estimates of a scene's light by them.
#include "host/trace/host_rays.hpp"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>

#include "host/base/random.hpp"
#include "host/lights/light_probe.hpp"
#include "host/verify/oracle.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;
constexpr double endless = std::numeric_limits<double>::infinity();

Mesh triangles_at_random(std::size_t count, std::uint64_t seed) {
    Mesh mesh;
    scenes::Random random(seed);
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 center = random.in_cube();
        for (int k = 0; k < 3; ++k) mesh.positions.push_back(center + 0.8f * random.in_cube());
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

/// The number of a hit's triangle among all; of instances, whose meshes may be there twice, only that it is one of its
/// mesh.
std::uint32_t primitive_of(const Scene& scene, const HostHit& hit, std::uint32_t expected) {
    EXPECT_LT(hit.triangle, scene.meshes[hit.mesh].triangles.size());
    if (!scene.instances.empty()) return expected;
    std::uint32_t primitive = hit.triangle;
    for (std::uint32_t i = 0; i < hit.mesh; ++i) primitive += std::uint32_t(scene.meshes[i].triangles.size());
    return primitive;
}

/// Every ray against every triangle, by another test.
void expect_as_oracle(const Scene& scene, std::span<const glm::dvec3> corners) {
    const HostRays rays(scene);
    const verify::Oracle oracle(corners);
    scenes::Random random(7);
    std::size_t hits = 0;
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 from = 2.f * random.in_cube(), way = random.in_ball();
        const auto expected = oracle.closest_hit({from.x, from.y, from.z, 0, way.x, way.y, way.z, 1e30f});
        const auto hit = rays.closest(from, way, endless);
        ASSERT_EQ(hit.has_value(), expected.primitive != CLARAY_MISS) << i;
        if (!hit) continue;
        ++hits;
        EXPECT_NEAR(hit->distance, expected.t, 1e-5 * expected.t);
        const glm::dvec3* c = &corners[3 * expected.primitive];
        const glm::dvec3 normal = glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0]));
        EXPECT_NEAR(glm::dot(hit->normal, normal), 1, 1e-4) << i;
        const glm::dvec3 at = (1 - hit->u - hit->v) * c[0] + hit->u * c[1] + hit->v * c[2];
        EXPECT_LT(glm::length(at - (glm::dvec3(from) + hit->distance * glm::dvec3(way))), 1e-4);
        EXPECT_FALSE(rays.closest(from, way, 0.999 * hit->distance));
        EXPECT_EQ(primitive_of(scene, *hit, expected.primitive), expected.primitive) << i;
    }
    EXPECT_GT(hits, 100u);
}

std::vector<glm::dvec3> corners_of(const Mesh& mesh, const glm::dmat4& transform) {
    std::vector<glm::dvec3> corners;
    for (const glm::uvec3& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) corners.emplace_back(transform * glm::dvec4(mesh.positions[t[k]], 1.0));
    return corners;
}

TEST(HostRays, HitWhatTheOracleHits) {
    Scene scene;
    scene.meshes = {triangles_at_random(70, 1), triangles_at_random(30, 2)};
    std::vector<glm::dvec3> corners = corners_of(scene.meshes[0], glm::dmat4(1.0));
    const auto more = corners_of(scene.meshes[1], glm::dmat4(1.0));
    corners.insert(corners.end(), more.begin(), more.end());
    expect_as_oracle(scene, corners);
}

TEST(HostRays, HitInstances) {
    Scene scene;
    scene.meshes = {Mesh{}, triangles_at_random(40, 3), triangles_at_random(1, 4)};
    const glm::mat4 turned = glm::rotate(glm::translate(glm::mat4(1.f), {0.4f, -0.2f, 0.3f}), 1.f, {1.f, 2.f, 3.f});
    const glm::mat4 stretched = glm::scale(glm::mat4(1.f), {1.5f, 0.5f, 2.f});
    scene.instances = {{0, glm::mat4(1.f), {}}, {1, turned, {}}, {2, stretched, {}}, {1, stretched, {}}};
    std::vector<glm::dvec3> corners;
    for (const MeshInstance& instance : scene.instances) {
        const auto more = corners_of(scene.meshes[instance.mesh], glm::dmat4(instance.transform));
        corners.insert(corners.end(), more.begin(), more.end());
    }
    expect_as_oracle(scene, corners);
}

TEST(HostRays, OfNothingHitNothing) {
    Scene scene;
    EXPECT_FALSE(HostRays(scene).closest({0, 0, 5}, {0, 0, -1}, endless));
    scene.meshes = {Mesh{}};
    EXPECT_FALSE(HostRays(scene).closest({0, 0, 5}, {0, 0, -1}, endless));
}

/// Rays along an axis: in the planes of boxes, and at the end of an instance's, whose coordinates are rounded.
TEST(HostRays, AlongAxesMeetBoxes) {
    Scene scene;
    scene.meshes = {Mesh{}};
    scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    scene.meshes[0].triangles = {{0, 1, 2}, {0, 2, 3}};
    const HostRays rays(scene);
    for (const double x : {0.0, 0.5, 1.0})
        for (const double y : {0.0, 0.25, 1.0})
            EXPECT_TRUE(rays.closest({x, y, 5}, {0, 0, -1}, endless)) << x << ", " << y;
    for (const float way : {1 / 3.f, 1 / 6.f, 1 / 14.f, 1 / 20.f}) {
        Scene moved = scene;
        moved.instances = {{0, glm::translate(glm::mat4(1.f), {way, 0.f, 0.f}), {}},
                           {0, glm::translate(glm::mat4(1.f), {-7.f, 0.f, 0.f}), {}}};  // a tree of two boxes
        const double end = 1 + double(way);
        EXPECT_TRUE(HostRays(moved).closest({end - 1e-9, 0.25, 5}, {0, 0, -1}, endless)) << way;
        EXPECT_FALSE(HostRays(moved).closest({end + 1e-9, 0.25, 5}, {0, 0, -1}, endless)) << way;
    }
}

/// A square of side 2 in the plane z = 0 that fills the view of a camera before it.
struct TracedSquare {
    Scene scene;
    Camera camera;
    TracedSquare() {
        scene.materials.emplace_back();
        add_wall({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
        camera.position = {0, 0, 10}, camera.vertical_fov = float(glm::degrees(2 * std::atan(0.1)));
    }
    void add_wall(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b, std::uint32_t material = 0) {
        Mesh mesh;
        mesh.positions = {corner, corner + a, corner + a + b, corner + b};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        mesh.materials = {material, material};
        scene.meshes.push_back(mesh);
    }
    [[nodiscard]] LightProbe probe() const { return probe_light(scene, camera, 1.f); }
};

TEST(LightProbe, OfWhatHasNoLight) {
    const LightProbe probe = TracedSquare().probe();
    EXPECT_EQ(probe.lights, 0u);
    EXPECT_EQ(probe.seen, 1);
    EXPECT_EQ(probe.lit, 0);
    EXPECT_EQ(probe.visible, 0);
    EXPECT_EQ(probe.open, 1);
    TracedSquare away;
    away.camera.target = {0, 0, 20};
    EXPECT_EQ(away.probe().seen, 0);
}

/// A point at height h makes grey as bright as `visible_luminance` at a distance r: I h / (h^2 + r^2)^1.5 0.5 / pi.
TEST(LightProbe, LitIsTheDiscThatAPointMakesVisible) {
    TracedSquare square;
    const double h = 0.5, r = 0.7;
    const double intensity = visible_luminance * 2 * pi * std::pow(h * h + r * r, 1.5) / h;
    square.scene.lights = {point_light({0, 0, float(h)}, glm::vec3(float(intensity)))};
    EXPECT_NEAR(square.probe().lit, pi * r * r / 4, 0.03);
    square.scene.lights[0].position.z = -float(h);
    EXPECT_EQ(square.probe().lit, 0) << "from behind";
    square.scene.lights[0].position.z = float(h);
    square.scene.lights[0].range = 0.4f;
    EXPECT_EQ(square.probe().lit, 0) << "out of range";
}

TEST(LightProbe, SpotsSunsAndLampsCountWithTheirShadows) {
    TracedSquare square;
    Light spot = point_light({0, 0, 1}, glm::vec3(100.f));
    spot.kind = LightKind::spot, spot.direction = {0, 0, -1};
    spot.outer_angle = float(std::atan(0.5)), spot.inner_angle = spot.outer_angle - 1e-3f;
    square.scene.lights = {spot};
    EXPECT_NEAR(square.probe().lit, 3.14159 * 0.25 / 4, 0.03);
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {0, 0, -1}, sun.intensity = glm::vec3(3.f);
    square.scene.lights = {sun};
    EXPECT_EQ(square.probe().lit, 1);
    square.scene.lights[0].intensity = glm::vec3(0.01f);
    EXPECT_EQ(square.probe().lit, 0) << "too weak";
    square.scene.lights[0].intensity = glm::vec3(3.f);
    square.add_wall({-1, -1, 11}, {1, 0, 0}, {0, 2, 0});  // behind the camera, before the left half
    EXPECT_NEAR(square.probe().lit, 0.5, 0.03);
    square.scene.lights.clear();
    square.scene.meshes.pop_back();
    square.scene.materials.push_back(square.scene.materials[0]);
    square.scene.materials[1].emission = glm::vec3(50.f);
    square.add_wall({-1, -1, 10.5}, {2, 0, 0}, {0, 2, 0}, 1);
    EXPECT_EQ(square.probe().lights, 2u);
    EXPECT_EQ(square.probe().lit, 1);
    square.scene.materials[1].cull_back = true;  // its front is away from the square
    EXPECT_EQ(square.probe().lit, 0);
}

/// The visible share is the share of the emission map that is not black.
TEST(LightProbe, EmissionIsLookedUpInItsImage) {
    TracedSquare square;
    Texture texture;
    texture.width = 4, texture.height = 1, texture.channels = 3;
    texture.bytes.resize(12);
    square.scene.textures = {texture};
    square.scene.textures[0].bytes[3] = 255;
    square.scene.textures[0].filter = Filter::nearest;
    Material& material = square.scene.materials[0];
    material.emission = glm::vec3(1.f), material.emission_map.texture = 0;
    square.scene.meshes[0].uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    EXPECT_NEAR(square.probe().visible, 0.25, 0.03);
}

TEST(LightProbe, RaysPassThroughWhatLetsLightPass) {
    TracedSquare square;
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {0, 0, -1}, sun.intensity = glm::vec3(3.f);
    square.scene.lights = {sun};
    square.scene.materials.push_back(square.scene.materials[0]);
    square.add_wall({-1, -1, 5}, {2, 0, 0}, {0, 2, 0}, 1);
    square.scene.lights[0].direction = {0, 0, 1};  // on the square's back, and on the wall's
    EXPECT_EQ(square.probe().lit, 0);
    Material& wall = square.scene.materials[1];
    square.scene.lights[0].direction = {0, 0, -1};
    wall.alpha_mode = AlphaMode::blend, wall.opacity = 0.2f;
    EXPECT_EQ(square.probe().lit, 1) << "nearly clear";
    wall = square.scene.materials[0], wall.kind = MaterialKind::glass;
    EXPECT_EQ(square.probe().seen, 1);
    EXPECT_EQ(square.probe().lit, 0) << "no shadow ray passes glass";
    wall = square.scene.materials[0];
    for (glm::vec3& position : square.scene.meshes[1].positions) position.z = 11;  // behind the camera
    EXPECT_EQ(square.probe().lit, 0);
    wall.cull_back = true;
    EXPECT_EQ(square.probe().lit, 1) << "its back lets the sun pass";
}

TEST(LightProbe, WhiteIsExposedByAllLight) {
    TracedSquare square;
    const auto white = [&](const Scene& lit) { return log_average_of_white(square.scene, lit, square.camera, 1.f); };
    EXPECT_EQ(white(square.scene), 0) << "no light arrives";
    Scene lit = square.scene;
    lit.sky.horizon = lit.sky.zenith = glm::vec3(2.f);
    EXPECT_NEAR(white(lit), 2, 1e-5) << "the same light from all sides";
    Texture image;
    image.format = TexelFormat::float32, image.width = 4, image.height = 2, image.channels = 1;
    image.floats = {0, 5, 5, 0, 0, 5, 5, 0};  // where -z is, to which the square turns its back
    lit.environment.images = {image};
    EXPECT_EQ(white(lit), 0);
    image.floats = {5, 0, 0, 5, 5, 0, 0, 5};
    lit.environment.images = {image}, lit.environment.strength = 3;
    EXPECT_NEAR(white(lit), 15, 1e-4);
    lit = square.scene;
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {0, 0, -1}, sun.intensity = glm::vec3(3.f);
    lit.lights = {sun};
    EXPECT_NEAR(white(lit), 3 / pi, 1e-6);
}

TEST(LightProbe, InAClosedRoomNothingIsOpen) {
    TracedSquare square;
    square.add_wall({-1, -1, 20}, {2, 0, 0}, {0, 2, 0});
    for (const float side : {-1.f, 1.f}) {
        square.add_wall({side, -1, 0}, {0, 2, 0}, {0, 0, 20});
        square.add_wall({-1, side, 0}, {2, 0, 0}, {0, 0, 20});
    }
    EXPECT_EQ(square.probe().open, 0);
    square.scene.lights = {point_light({0, 0, 19}, glm::vec3(1.f))};
    EXPECT_EQ(square.probe().lit, 0) << "too far away";
    square.scene.lights[0].intensity = glm::vec3(100.f);
    EXPECT_EQ(square.probe().lit, 1);
}

}  // namespace
}  // namespace claray::test
