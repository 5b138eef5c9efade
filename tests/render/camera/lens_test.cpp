// Fisheyes, cubes, two eyes, shift and tilt (claray/shared/camera/lens.h): closed forms, on the host and on the device.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claray/renderer.hpp"
#include "host/scene/camera.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

const float aspect = 1.5f;

Camera looking_ahead(Projection projection = Projection::perspective) {
    return {.position = {0, 0, 0}, .target = {0, 0, -4}, .vertical_fov = 60.f, .projection = projection};
}
CameraRay ray_of(const Camera& camera, double x, double y) {
    CameraRay ray = camera_ray(camera_data(camera, aspect), x, y);
    ray.direction = glm::normalize(ray.direction);
    return ray;
}
double angle_to(const glm::dvec3& direction, const glm::dvec3& axis) {
    return std::acos(std::clamp(glm::dot(glm::normalize(direction), axis), -1.0, 1.0));
}

TEST(Fisheyes, HaveTheirAngles) {
    for (const float degrees : {30.f, 180.f, 300.f, 360.f})
        for (const double y : {-1.0, -0.5, 0.0, 0.25, 1.0}) {
            const double half = 0.5 * double(degrees) * pi / 180;
            Camera camera = looking_ahead(Projection::fisheye);
            camera.vertical_fov = degrees;
            EXPECT_NEAR(angle_to(ray_of(camera, 0, y).direction, {0, 0, -1}), std::abs(y) * half, 1e-6);
            camera.projection = Projection::equisolid;
            const double expected = 2 * std::asin(std::abs(y) * std::sin(half / 2));
            EXPECT_NEAR(angle_to(ray_of(camera, 0, y).direction, {0, 0, -1}), expected, 2e-4);
            EXPECT_GE(ray_of(camera, 0, y).direction.y * y, -1e-6) << "up in the image is up";
            EXPECT_GE(ray_of(camera, 0.5, y).direction.x, -1e-6) << "right is right";
        }
}

/// The image of a cube of surroundings is the cube: a pixel is its texel within two. Environments are kept in latitude
/// and longitude, which moves texels next to the edges of faces.
TEST(Cubes, OfAnEnvironmentAreItsFaces) {
    const unsigned side = 16;
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(0.001f, -900)};
    for (unsigned face = 0; face < 6; ++face) {
        Texture image{.width = side, .height = side};
        image.format = TexelFormat::float32, image.channels = 3;
        for (unsigned i = 0; i < side * side; ++i)
            image.floats.insert(image.floats.end(), {1.f + float(i % side), 1.f + float(i / side), 1.f + float(face)});
        scene.environment.images.push_back(image);
    }
    scene.camera = Camera{.position = {0, 0, 0}, .target = {0, 0, -1}, .projection = Projection::cube};
    const unsigned width = 6 * side;
    const std::vector<glm::vec3> pixels = render_image(scene, {.width = width, .height = side, .spp = 64});
    for (unsigned y = 1; y + 1 < side; ++y)
        for (unsigned x = 0; x < width; ++x) {
            if (x % side == 0 || x % side + 1 == side) continue;  // the filter takes texels of other faces there
            EXPECT_NEAR(pixels[y * width + x].x, 1.f + float(x % side), 2.f) << x << ' ' << y;
            EXPECT_NEAR(pixels[y * width + x].y, 1.f + float(y), 2.f) << x << ' ' << y;
            EXPECT_NEAR(pixels[y * width + x].z, 1.f + float(x / side), 0.3f) << x << ' ' << y;
        }
}

TEST(LensShift, MovesTheImage) {
    Camera shifted = looking_ahead();
    shifted.shift = {0.25f, -0.1f};
    for (const double x : {-0.7, 0.0, 0.4})
        for (const double y : {-0.5, 0.3})
            EXPECT_LT(
                glm::length(ray_of(shifted, x, y).direction - ray_of(looking_ahead(), x + 0.5, y - 0.2).direction),
                1e-6);
}

/// Points of the image that both eyes have in common meet at the target's distance.
TEST(Stereo, MeetsAtTheTarget) {
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
        for (const Stereo layout : {Stereo::side_by_side, Stereo::top_bottom}) {
            Camera camera = looking_ahead(projection);
            camera.stereo = layout, camera.eye_distance = 0.3f;
            const bool beside = layout == Stereo::side_by_side;
            const CameraData data = camera_data(camera, aspect);
            for (const double x : {-0.8, 0.1}) {
                const double y = 0.35;
                const CameraRay left = beside ? camera_ray(data, (x - 1) / 2, y) : camera_ray(data, x, (y + 1) / 2);
                const CameraRay right = beside ? camera_ray(data, (x + 1) / 2, y) : camera_ray(data, x, (y - 1) / 2);
                EXPECT_NEAR(glm::length(right.origin - left.origin), 0.3, 1e-6);
                EXPECT_GT(right.origin.x, left.origin.x);
                const auto at = [](const CameraRay& ray) {
                    return ray.origin + ray.direction * (-4 / ray.direction.z);
                };
                EXPECT_LT(glm::length(at(left) - at(right)), 1e-6);
            }
        }
}

/// The image of an eye is that of a camera at its place, turned by a shift.
TEST(Stereo, EyesSeeTheScene) {
    Scene scene = *builtin_scene("spheres");
    scene.camera = Camera{.position = {0, 1, 6}, .target = {0, 0.5f, 0}};
    scene.camera->stereo = Stereo::side_by_side, scene.camera->eye_distance = 0.2f;
    const Aovs both = Renderer(device(), scene, {.width = 48, .height = 24, .spp = 1}).aovs();
    const CameraData data = camera_data(*scene.camera, 2.f);
    for (unsigned i = 0; i < 48 * 24; ++i) {
        const CameraRay ray = camera_ray(data, 2 * (i % 48 + 0.5) / 48 - 1, 1 - 2 * (i / 48 + 0.5) / 24);
        Scene eye = scene;
        eye.camera = Camera{.position = glm::vec3(ray.origin), .target = glm::vec3(ray.origin + ray.direction)};
        if (i % 97 != 0) continue;
        const Aovs one = Renderer(device(), eye, {.width = 1, .height = 1, .spp = 1}).aovs();
        if (!std::isfinite(one.depth[0])) continue;
        EXPECT_NEAR(both.depth[i], one.depth[0], 1e-3f * one.depth[0]) << i;
    }
}

TEST(Stereo, OfPanoramasTurnsItsEyes) {
    Camera camera = looking_ahead(Projection::panorama);
    camera.stereo = Stereo::top_bottom, camera.eye_distance = 0.2f;
    for (const double x : {-0.9, -0.3, 0.0, 0.6}) {
        const CameraRay left = ray_of(camera, x, 0.5), right = ray_of(camera, x, -0.5);
        EXPECT_LT(glm::length(left.direction - right.direction), 1e-6);
        EXPECT_NEAR(glm::length(left.origin), 0.1, 1e-6);
        EXPECT_NEAR(glm::dot(left.origin, left.direction), 0, 1e-6) << "tangent to the circle";
        EXPECT_LT(glm::length(left.origin + right.origin), 1e-6);
        EXPECT_NEAR(glm::dot(glm::cross(left.direction, glm::dvec3(0, 1, 0)), right.origin), 0.1, 1e-6)
            << "the right eye is on the right";
    }
}

/// Small emitters on a tilted plane are as sharp as through a pinhole; by an upright plane they are not.
TEST(Tilt, TurnsTheSharpPlane) {
    const double slope = std::tan(40 * pi / 180);
    const auto lit = [&](float aperture, float tilt) {
        Scene scene;
        scene.materials = {emitter(1)};
        for (const float y : {-0.8f, 0.9f}) {  // z = -4 - y * slope
            Mesh mesh = square(0.02f, 0);
            for (glm::vec3& p : mesh.positions) p = glm::vec3(p.x, y + p.z, -4 - double(y) * slope);
            scene.meshes.push_back(mesh);
        }
        scene.camera = looking_ahead();
        scene.camera->aperture_radius = aperture, scene.camera->focus_distance = 4.f;
        scene.camera->tilt = {tilt, 0.f};
        const std::vector<glm::vec3> image = render_image(scene, {.width = 96, .height = 96, .spp = 64});
        return std::count_if(image.begin(), image.end(), [](const glm::vec3& p) { return p.x > 0; });
    };
    const auto sharp = lit(0.f, 0.f);
    ASSERT_GT(sharp, 0);
    EXPECT_LE(lit(0.8f, 40.f), sharp + 4);
    EXPECT_GT(lit(0.8f, 0.f), 4 * sharp);
}

TEST(Lenses, AreRefusedWhereTheyMakeNoSense) {
    const auto refused = [](const auto& change) {
        Camera camera = looking_ahead();
        change(camera);
        EXPECT_THROW(static_cast<void>(camera_data(camera, aspect)), Error);
    };
    refused([](Camera& c) { c.projection = Projection::fisheye, c.vertical_fov = 361.f; });
    refused([](Camera& c) { c.projection = Projection::fisheye, c.shift.x = 0.1f; });
    refused([](Camera& c) { c.projection = Projection::cube, c.stereo = Stereo::side_by_side; });
    refused([](Camera& c) { c.projection = Projection::panorama, c.tilt.x = 5.f; });
    refused([](Camera& c) { c.tilt.y = 90.f; });
    refused([](Camera& c) { c.shift.y = 0.1f, c.position_end = glm::vec3(1, 0, 0); });
    refused([](Camera& c) { c.eye_distance = NAN; });
    Scene scene = *builtin_scene("cornell");
    scene.camera->shift.x = 0.2f;
    EXPECT_THROW(static_cast<void>(Renderer(device(), scene, {.width = 8, .height = 8, .spp = 1}).gbuffer()), Error);
}

/// Kernels of scenes without these cameras have no text of them, so that they are the same programs as before.
TEST(Lenses, AreNoTextOfOtherKernels) {
    const auto text = [](const std::string& projections) {
        const std::string root = CLARAY_SOURCE_DIR;
        return run_process({"cpp", "-P", "-undef", "-D__OPENCL_C_VERSION__=120", "-DCLARAY_CPU=1",
                            "-DPROJECTIONS=" + projections, "-I" + root + "/kernels", "-I" + root + "/include",
                            root + "/kernels/render/generate_rays.cl"});
    };
    const ProcessResult with = text("8u");
    if (with.exit_code != 0) GTEST_SKIP() << "no preprocessor: " << with.errors;
    EXPECT_NE(with.output.find("aim_lens"), std::string::npos);
    for (const char* projections : {"0u", "2u", "4u", "6u"}) {
        const std::string without = text(projections).output;
        EXPECT_NE(without.find("aim_panorama"), std::string::npos);
        for (const char* word : {"aim_lens", "lens_ray", "aim_cube", "fisheye", "equisolid"})
            EXPECT_EQ(without.find(word), std::string::npos) << word;
    }
}

}  // namespace
}  // namespace claray::test
