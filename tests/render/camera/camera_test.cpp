// The thin lens and the moving camera: shade/camera.clh, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "claray/program.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

/// A regular polygon that faces +z at height z, of the area of a disc of `radius`.
Mesh disc(float radius, float z, std::uint32_t sides = 64) {
    Mesh mesh;
    const double turn = 2 * pi / sides, corner = radius * std::sqrt(turn / std::sin(turn));
    mesh.positions.emplace_back(0, 0, z);
    for (std::uint32_t i = 0; i < sides; ++i) {
        mesh.positions.emplace_back(corner * std::cos(i * turn), corner * std::sin(i * turn), z);
        mesh.triangles.emplace_back(0, 1 + i, 1 + (i + 1) % sides);
    }
    return mesh;
}

/// A rectangle that faces +z.
Mesh rectangle(float x0, float y0, float x1, float y1, float z) {
    Mesh mesh;
    mesh.positions = {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// At the origin, looking along -z; the image reaches from -0.2 to 0.2 at distance 1.
Camera small_camera() {
    Camera camera;
    camera.position = {0, 0, 0};
    camera.target = {0, 0, -1};
    camera.vertical_fov = float(2 * std::atan(0.2) * 180 / pi);
    return camera;
}

/// The image of a point at distance z is an evenly bright disc of radius aperture * |1/focus - 1/z| at distance 1; that
/// of an emissive disc is its convolution with this disc, with the energy of the sharp image.
TEST(ThinLens, CircleOfConfusionHasItsRadiusAndEnergy) {
    constexpr double aperture = 0.5, source = 0.05, radiance = 7;
    struct Place {
        double z, focus;
    };
    for (const Place place : {Place{2, 4}, {4, 2}, {3, 3}}) {
        Scene scene;
        scene.materials = {emitter(float(radiance))};
        scene.meshes = {disc(float(source * place.z), float(-place.z))};
        scene.camera = small_camera();
        scene.camera->aperture_radius = aperture;
        scene.camera->focus_distance = float(place.focus);
        const unsigned width = 96, height = 64;
        const std::vector<glm::vec3> image =
            render_image(scene, {.width = width, .height = height, .spp = 256, .max_depth = 1});
        const double radius = aperture * std::abs(1 / place.focus - 1 / place.z), pixel = 0.4 / height;
        double energy = 0, moment = 0, core = 0, beyond = 0;
        unsigned core_pixels = 0;
        for (unsigned i = 0; i < width * height; ++i) {
            const double x = (i % width + 0.5) * pixel - 0.3, y = (i / width + 0.5) * pixel - 0.2, r = std::hypot(x, y);
            energy += image[i].x * pixel * pixel;
            moment += image[i].x * pixel * pixel * r * r;
            if (r > radius + source * 1.01 + pixel) beyond += image[i].x;
            if (r < std::abs(radius - source) - pixel) core += image[i].x, ++core_pixels;
        }
        SCOPED_TRACE(testing::Message() << "distance " << place.z << ", focus " << place.focus);
        EXPECT_NEAR(energy / (radiance * pi * source * source), 1, 0.005);
        // Mean squared distances of discs from their centres, r^2 / 2, add up; a pixel's own is side^2 / 6.
        EXPECT_NEAR(std::sqrt(2 * (moment / energy - pixel * pixel / 6)), std::hypot(radius, source), 0.0005);
        EXPECT_EQ(beyond, 0);
        const double expected = radius > source ? radiance * source * source / (radius * radius) : radiance;
        EXPECT_NEAR(core / core_pixels / expected, 1, 0.01);
    }
}

/// The point on the lens and the point in the pixel are independent: a circle of confusion of one pixel's radius is
/// spread over pixels accordingly.
TEST(ThinLens, IsSampledBesideThePixel) {
    constexpr double source = 0.01, pixel = 0.4 / 64, z = 2, focus = 4;
    Scene scene;
    scene.materials = {emitter(1.f)};
    scene.meshes = {disc(float(source * z), float(-z))};
    scene.camera = small_camera();
    scene.camera->aperture_radius = float(pixel / (1 / z - 1 / focus));
    scene.camera->focus_distance = float(focus);
    const std::vector<glm::vec3> image = render_image(scene, {.width = 64, .height = 64, .spp = 1024, .max_depth = 1});
    double energy = 0, moment = 0;
    for (unsigned i = 0; i < 64 * 64; ++i) {
        const double x = (i % 64 + 0.5) * pixel - 0.2, y = (i / 64 + 0.5) * pixel - 0.2;
        energy += image[i].x, moment += image[i].x * (x * x + y * y);
    }
    EXPECT_NEAR(std::sqrt(2 * (moment / energy - pixel * pixel / 6)) / std::hypot(pixel, source), 1, 0.02);
}

/// AOVs are those of a pinhole camera.
TEST(ThinLens, IsNotInAuxiliaryImages) {
    Scene scene;
    scene.materials = {emitter(1.f)};
    scene.meshes = {disc(0.3f, -2.f)};
    scene.camera = small_camera();
    const auto depth = [&] { return Renderer(device(), scene, {.width = 32, .height = 32}).aovs().depth; };
    const std::vector<float> sharp = depth();
    scene.camera->aperture_radius = 0.5f, scene.camera->focus_distance = 5.f;
    EXPECT_EQ(depth(), sharp);
}

/// Objects in the plane of focus are as sharp as through a pinhole: all rays of one film position meet there.
TEST(ThinLens, PlaneInFocusIsThePinholes) {
    Scene scene;
    scene.materials = {emitter(1.f)};
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j)
            if ((i + j) % 2 == 0)
                scene.meshes.push_back(rectangle(float(i - 4) * 0.15f, float(j - 4) * 0.15f, float(i - 3) * 0.15f,
                                                 float(j - 3) * 0.15f, -3.f));
    scene.camera = small_camera();
    scene.camera->target = {0, 0, -3};  // the default focus
    const RenderConfig config{.width = 48, .height = 48, .spp = 64, .max_depth = 1};
    const std::vector<glm::vec3> sharp = render_image(scene, config);
    for (const float focus : {0.f, 3.f, 2.f}) {
        scene.camera->aperture_radius = 0.3f;
        scene.camera->focus_distance = focus;
        const std::vector<glm::vec3> image = render_image(scene, config);
        std::size_t samples_differ = 0;
        for (std::size_t i = 0; i < image.size(); ++i)
            samples_differ += std::size_t(std::lround(64 * std::abs(image[i].x - sharp[i].x)));
        // Of 147,456 samples only those may differ that rounding moves over an edge.
        if (focus != 2.f) {
            EXPECT_LE(samples_differ, 8u) << focus;
        } else {
            EXPECT_GE(samples_differ, 10'000u);  // out of focus: checks that the comparison can fail
        }
    }
}

/// An image 4 high of 16 pixels: the rectangle's edges are those of pixels, at any distance.
TEST(Orthographic, ShowsSizesAtAnyDistance) {
    for (const float z : {-1.f, -700.f}) {
        Scene scene;
        scene.materials = {emitter(3.f)};
        scene.meshes = {rectangle(-1.f, -0.5f, 0.5f, 1.f, z)};
        scene.camera = small_camera();
        scene.camera->projection = Projection::orthographic, scene.camera->orthographic_height = 4.f;
        const RenderConfig config{.width = 24, .height = 16, .spp = 4, .max_depth = 1};
        const std::vector<glm::vec3> image = render_image(scene, config);
        const Aovs aovs = Renderer(device(), scene, config).aovs();
        for (unsigned y = 0; y < 16; ++y)
            for (unsigned x = 0; x < 24; ++x) {
                const bool inside = x >= 8 && x < 14 && y >= 4 && y < 10;
                ASSERT_EQ(image[24 * y + x].x, inside ? 3.f : 0.f) << x << ' ' << y;
                if (inside) {
                    ASSERT_EQ(aovs.depth[24 * y + x], -z);
                }
            }
    }
}

/// A point at distance z becomes a disc of radius aperture * |1 - z/focus|, evenly bright and of the same energy.
TEST(Orthographic, CircleOfConfusionHasItsRadiusAndEnergy) {
    constexpr double aperture = 0.5, source = 0.1, radiance = 7;
    struct Place {
        double z, focus;
    };
    for (const Place place : {Place{2, 4}, {5, 4}, {3, 3}}) {
        Scene scene;
        scene.materials = {emitter(float(radiance))};
        scene.meshes = {disc(float(source), float(-place.z))};
        scene.camera = small_camera();
        scene.camera->projection = Projection::orthographic, scene.camera->orthographic_height = 1.f;
        scene.camera->aperture_radius = aperture;
        scene.camera->focus_distance = float(place.focus);
        const unsigned side = 64;
        const std::vector<glm::vec3> image =
            render_image(scene, {.width = side, .height = side, .spp = 256, .max_depth = 1});
        const double radius = aperture * std::abs(1 - place.z / place.focus), pixel = 1.0 / side;
        double energy = 0, moment = 0;
        for (unsigned i = 0; i < side * side; ++i) {
            const double r = std::hypot((i % side + 0.5) * pixel - 0.5, (i / side + 0.5) * pixel - 0.5);
            energy += image[i].x * pixel * pixel;
            moment += image[i].x * pixel * pixel * r * r;
        }
        SCOPED_TRACE(testing::Message() << "distance " << place.z << ", focus " << place.focus);
        EXPECT_NEAR(energy / (radiance * pi * source * source), 1, 0.005);
        EXPECT_NEAR(std::sqrt(2 * (moment / energy - pixel * pixel / 6)), std::hypot(radius, source), 0.001);
    }
}

/// The mean over [a, b] of a ramp that rises from 0 at x0 to 1 at x1.
double mean_of_ramp(double a, double b, double x0, double x1) {
    const auto integral = [&](double x) {
        const double s = std::clamp((x - x0) / (x1 - x0), 0.0, 1.0);
        return 0.5 * s * s * (x1 - x0) + std::max(0.0, x - x1);
    };
    return (integral(b) - integral(a)) / (b - a);
}

/// Expects the means of columns between -0.4 and 0.4 to be those of a ramp from -0.15 to 0. Returns the root mean
/// square of their errors over the ramp, in standard errors of this many independent samples.
double off_the_ramp(const std::vector<double>& means, unsigned samples) {
    const double width = double(means.size());
    double squares = 0, blurred = 0;
    for (std::size_t i = 0; i < means.size(); ++i) {
        const double a = (double(i) * 2 / width - 1) * 0.4, b = (double(i + 1) * 2 / width - 1) * 0.4;
        const double expected = mean_of_ramp(a, b, -0.15, 0);
        const double sigma = std::sqrt(std::max(0.0, expected * (1 - expected)) / samples);
        EXPECT_NEAR(means[i], expected, 3 * sigma + 1e-6) << "column " << i;
        if (sigma > 0) squares += std::pow((means[i] - expected) / sigma, 2), ++blurred;
    }
    return std::sqrt(squares / blurred);
}

TEST(CameraMotion, AnEdgeBecomesALinearRamp) {
    Scene scene;
    scene.materials = {emitter(1.f)};
    scene.meshes = {rectangle(0.f, -5.f, 5.f, 5.f, -2.f)};
    scene.camera = small_camera();
    scene.camera->position_end = glm::vec3(0.3f, 0, 0);  // the edge runs to the left, by 0.15 at distance 1
    scene.camera->target_end = glm::vec3(0.3f, 0, -1);
    const unsigned width = 40, height = 20, spp = 64;
    const auto columns = [&](Sampler sampler) {
        return column_means(
            render_by_own_kernels(scene,
                                  {.width = width, .height = height, .spp = spp, .max_depth = 1, .sampler = sampler}),
            width);
    };
    for (const Sampler sampler : {Sampler::independent, Sampler::sobol}) {
        const std::vector<double> means = columns(sampler);
        const double off = off_the_ramp(means, height * spp);
        if (sampler == Sampler::sobol) {
            EXPECT_LT(off, 0.85) << "less than independent samples";
        }
    }
}

/// Its rays are parallel to the view and start on the plane through its position, for any view and motion.
TEST(Orthographic, MovesLikeAnyOther) {
    Scene scene;
    scene.materials = {emitter(1.f)};
    scene.meshes = {rectangle(0.f, -5.f, 5.f, 5.f, -2.f)};
    scene.camera = small_camera();
    scene.camera->projection = Projection::orthographic, scene.camera->orthographic_height = 0.4f;
    scene.camera->position_end = glm::vec3(0.15f, 0, 0);  // the edge runs to the left by 0.15
    scene.camera->target_end = glm::vec3(0.15f, 0, -1);
    const unsigned width = 40, height = 20, spp = 64;
    const std::vector<double> means =
        column_means(render_image(scene, {.width = width, .height = height, .spp = spp, .max_depth = 1}), width);
    EXPECT_LT(off_the_ramp(means, height * spp), 0.85) << "less than independent samples";
}

/// At any time the camera equals one at rest at the interpolated position and target.
TEST(CameraMotion, IsTheStillCameraOfEveryTime) {
    Camera camera{{1, 2, 3}, {0, 0.5f, -4}, {0.1f, 1, 0}, 35.f};
    camera.position_end = glm::vec3(2, 1.5f, 2);
    camera.target_end = glm::vec3(-3, 0, -5);
    Kernel move = compile_kernel(device(), R"(
        #include "shade/camera.clh"
        kernel void at(CameraData camera, global const float* times, global CameraData* cameras) {
            const uint i = get_global_id(0);
            cameras[i] = move_camera(camera, times[i]);
        })",
                                 "at", {{"CAMERA_MOTION", "1"}, {"DEPTH_OF_FIELD", "1"}});
    std::vector<float> times;
    for (int i = 0; i <= 16; ++i) times.push_back(float(i) / 16);
    const Buffer<CameraData> cameras(device(), times.size());
    move.run({times.size()}, camera_data(camera, 1.5f), Buffer<float>(device(), times), cameras);
    const std::vector<CameraData> found = cameras.read();
    for (std::size_t i = 0; i < times.size(); ++i) {
        Camera still = camera;
        still.position = glm::mix(camera.position, *camera.position_end, times[i]);
        still.target = glm::mix(camera.target, *camera.target_end, times[i]);
        still.position_end.reset(), still.target_end.reset();
        const CameraData expected = camera_data(still, 1.5f);
        const auto *a = &found[i].x, *b = &expected.x;
        for (int k = 0; k < 14; ++k) EXPECT_NEAR(a[k], b[k], 2e-6) << "time " << times[i] << ", value " << k;
    }
}

}  // namespace
}  // namespace claray::test
