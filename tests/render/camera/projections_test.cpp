// Projections of cameras (claray/shared/lists/projections.h, kernels/shade/camera.clh): every row of the list, on the
// host and in kernels.
#include <gtest/gtest.h>

#include "claray/renderer.hpp"
#include "claray/shared/camera/lens.h"
#include "host/scene/camera.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

class Projections : public testing::TestWithParam<ProjectionTraits> {};

std::string name_of_row(const testing::TestParamInfo<ProjectionTraits>& row) { return row.param.name; }
INSTANTIATE_TEST_SUITE_P(All, Projections, testing::ValuesIn(projections), name_of_row);

constexpr float wall = 3.f;  // distance of the room's walls from the origin

/// A room round the origin.
Scene room() {
    Scene scene;
    scene.materials = {Material{}};
    Mesh mesh;
    for (int corner = 0; corner < 8; ++corner)
        mesh.positions.push_back(wall * glm::vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1));
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
    mesh.materials.assign(12, 0);
    scene.meshes = {mesh};
    scene.camera = Camera{{0.3f, -0.2f, 0.4f}, {-1, 0.5f, -2}, {0, 1, 0}, 70.f};
    return scene;
}

TEST_P(Projections, PlacePointsWhereTheyAim) {
    for (double x = -0.94; x < 1; x += 0.19)  // not at the edges of faces, which two have in common
        for (double y = -0.9; y < 1; y += 0.2) {
            const auto kind = std::uint32_t(GetParam().kind);
            const double half_width = 1.3, half_height = 0.8, distance = 2.5;
            const ProjectionRay ray = aim_any(kind, x, y, half_width, half_height);
            const ProjectionPlace place =
                place_in_any(kind, ray.from_right + distance * ray.right, ray.from_up + distance * ray.up,
                             distance * ray.forward, half_width, half_height);
            EXPECT_EQ(place.seen, 1u);
            EXPECT_NEAR(place.x, x, 1e-12);
            EXPECT_NEAR(place.y, y, 1e-12);
        }
}

/// The depths of the device, along the rays of the host, end in the walls.
TEST_P(Projections, TraceTheRaysOfTheHost) {
    Scene scene = room();
    scene.camera->projection = GetParam().kind;
    const unsigned width = 24, height = 16;
    const Aovs aovs = Renderer(device(), scene, {.width = width, .height = height, .spp = 1}).aovs();
    const CameraData camera = camera_data(*scene.camera, float(width) / float(height));
    for (unsigned i = 0; i < width * height; ++i) {
        const CameraRay ray = camera_ray(camera, 2 * (i % width + 0.5) / width - 1, 1 - 2 * (i / width + 0.5) / height);
        const glm::dvec3 point = glm::abs(ray.origin + double(aovs.depth[i]) * glm::normalize(ray.direction));
        ASSERT_NEAR(std::max({point.x, point.y, point.z}), wall, 2e-6) << i;
    }
}

/// A panorama of surroundings is the image of the surroundings: a pixel is a texel.
TEST(Panorama, OfAnEnvironmentIsItsImage) {
    const unsigned width = 16, height = 8;
    Texture image{.width = width, .height = height};
    image.format = TexelFormat::float32, image.channels = 3;
    for (unsigned i = 0; i < width * height; ++i)
        image.floats.insert(image.floats.end(), {0.1f + float(i % width), float(i / width), 1.f});
    Scene scene = room();
    for (glm::vec3& position : scene.meshes[0].positions) position = 1e-3f * position + glm::vec3(0, 0, 900);
    scene.environment.images = {image};
    scene.camera = Camera{.position = {0, 0, 0}, .target = {0, 0, -1}, .projection = Projection::panorama};
    Renderer renderer(device(), scene, {.width = width, .height = height, .spp = 256});
    renderer.render();
    const std::vector<glm::vec3> pixels = renderer.image();
    // A filter of the image takes means of neighbours, which a mean over the pixel does not change where they are
    // linear.
    for (unsigned y = 1; y + 1 < height; ++y)
        for (unsigned x = 1; x + 1 < width; ++x) {
            const unsigned i = y * width + x;
            EXPECT_NEAR(pixels[i].x, 0.1f + float(x), 0.02f) << x << ' ' << y;
            EXPECT_NEAR(pixels[i].y, float(y), 0.02f) << x << ' ' << y;
        }
}

TEST(Panorama, HasNoLensAndNoMatrix) {
    Scene scene = room();
    scene.camera->projection = Projection::panorama;
    const Renderer renderer(device(), scene, {.width = 8, .height = 4, .spp = 1});
    EXPECT_THROW(static_cast<void>(renderer.gbuffer()), Error);
    scene.camera->aperture_radius = 0.1f;
    EXPECT_THROW(static_cast<void>(camera_data(*scene.camera, 2.f)), Error);
}

}  // namespace
}  // namespace claray::test
