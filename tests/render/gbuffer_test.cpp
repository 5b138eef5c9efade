// The G-buffer and its packed formats: deferred/write_gbuffer.cl, claray/shared/gbuffer.h.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

using Pack = std::uint32_t (*)(UnitVector);
using Unpack = UnitVector (*)(std::uint32_t);

/// The largest angle between a unit vector and its code, in degrees.
double largest_error(Pack pack, Unpack unpack) {
    Random random(1);
    double largest = 0;
    for (int i = 0; i < 200'000; ++i) {
        const double z = random.uniform(-1.f, 1.f), a = 2 * std::numbers::pi * random.uniform();
        const double near_pole = i % 2 == 0 ? z : std::copysign(1 - 1e-4 * std::abs(z), z),
                     r = std::sqrt(1 - near_pole * near_pole);
        const glm::vec3 n(glm::normalize(glm::dvec3(r * std::cos(a), r * std::sin(a), near_pole)));
        const UnitVector got = unpack(pack({n.x, n.y, n.z}));
        const glm::dvec3 off = glm::cross(glm::dvec3(n), glm::dvec3(got.x, got.y, got.z));
        EXPECT_GT(glm::dot(glm::dvec3(n), glm::dvec3(got.x, got.y, got.z)), 0.99);
        largest = std::max(largest, glm::degrees(std::asin(glm::length(off))));
    }
    return largest;
}

TEST(PackedNormals, AreWrongByAsLittleAsTheirBitsAllow) {
    EXPECT_NEAR(largest_error(claray_pack_octahedral, claray_unpack_octahedral), 0.0037, 0.0001);
    EXPECT_NEAR(largest_error(claray_pack_spherical, claray_unpack_spherical), 0.0031, 0.0001);
}

TEST(PackedNormals, OfAxesAreExact) {
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.f, 1.f}) {
            glm::vec3 n(0.f);
            n[axis] = sign;
            const UnitVector got = claray_unpack_octahedral(claray_pack_octahedral({n.x, n.y, n.z}));
            EXPECT_EQ(glm::vec3(got.x, got.y, got.z), n);
            EXPECT_NE(claray_pack_octahedral({n.x, n.y, n.z}), CLARAY_NO_SURFACE);
            EXPECT_NE(claray_pack_spherical({n.x, n.y, n.z}), CLARAY_NO_SURFACE);
        }
}

/// A floor at height -1 and a ball of radius 1, which has the last of 300 materials.
Scene floor_and_ball() {
    Scene scene;
    scene.materials.assign(300, lambert(0.5f));
    scene.materials[0].albedo = {0.2f, 0.5f, 0.9f};
    Mesh ball = sphere(3);
    ball.normals = ball.positions;
    ball.materials.assign(ball.triangles.size(), 299);
    scene.meshes = {square(4.f, -1.f), ball};
    scene.camera = Camera{{1, 3, 6}, {0, 0, 0}, {0, 1, 0}, 50.f};
    return scene;
}

const RenderConfig small_image = {.width = 33, .height = 25, .spp = 1};

TEST(GBuffer, GivesPositionsAndNormals) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
        for (const NormalPacking packing : {NormalPacking::octahedral, NormalPacking::spherical}) {
            Scene scene = floor_and_ball();
            scene.camera->projection = projection, scene.camera->orthographic_height = 5.f;
            const Renderer renderer(device(), scene, small_image);
            const GBuffer buffer = renderer.gbuffer(packing);
            const Aovs aovs = renderer.aovs();
            ASSERT_EQ(buffer.pixels.size(), aovs.depth.size());
            int floors = 0, balls = 0, none = 0;
            for (std::size_t i = 0; i < buffer.pixels.size(); ++i) {
                if (std::isinf(aovs.depth[i])) {
                    EXPECT_EQ(buffer.pixels[i].normal, CLARAY_NO_SURFACE);
                    EXPECT_EQ(buffer.pixels[i].depth, 0.f);
                    ++none;
                    continue;
                }
                const glm::dvec3 position(position_of(buffer, i)), normal(normal_of(buffer, i));
                EXPECT_LT(glm::length(normal - glm::dvec3(aovs.normal[i])), 1e-4);
                if (projection == Projection::perspective) {
                    EXPECT_NEAR(glm::length(position - glm::dvec3(scene.camera->position)), aovs.depth[i], 2e-5);
                }
                const bool is_floor = aovs.primitive[i] < 2;
                is_floor ? ++floors : ++balls;
                if (is_floor) {
                    EXPECT_NEAR(position.y, -1, 2e-5) << i;
                } else {
                    EXPECT_NEAR(glm::length(position), 1, 0.02) << "flat triangles";
                }
            }
            EXPECT_TRUE(floors > 100 && balls > 30 && none > 10);
        }
}

TEST(GBuffer, HasAlbedoAndMaterialInBytes) {
    const Renderer renderer(device(), floor_and_ball(), small_image);
    const GBuffer buffer = renderer.gbuffer();
    const std::vector<std::uint32_t> primitive = renderer.aovs().primitive;
    for (std::size_t i = 0; i < primitive.size(); ++i) {
        if (primitive[i] == CLARAY_MISS) continue;
        const bool is_floor = primitive[i] < 2;
        const glm::vec3 albedo = is_floor ? glm::vec3(0.2f, 0.5f, 0.9f) : glm::vec3(0.5f);
        for (int k = 0; k < 3; ++k)
            EXPECT_EQ(buffer.pixels[i].albedo_material >> 8 * k & 255, srgb_from_linear(albedo[k])) << i;
        EXPECT_EQ(buffer.pixels[i].albedo_material >> 24, is_floor ? 0u : 255u) << "the largest that fits";
    }
}

}  // namespace
}  // namespace claray::test
