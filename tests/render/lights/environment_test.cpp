// Environment maps: host/lights/environment.cpp, lights/environment.clh.
#include "host/lights/environment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "claray/program.hpp"
#include "host/lights/lights.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/statistics.hpp"

namespace claray::test {
namespace {

using std::numbers::pi;

Texture float_image(unsigned width, unsigned height) {
    Texture image;
    image.width = width, image.height = height, image.channels = 3, image.format = TexelFormat::float32;
    image.floats.resize(std::size_t(3) * width * height);
    return image;
}

/// An image of latitudes and longitudes of a function of the direction, by the definition of Environment.
template <class Function>
Texture panorama(unsigned width, unsigned height, Function&& function) {
    Texture image = float_image(width, height);
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x) {
            const double right = 2 * pi * ((x + 0.5) / width - 0.5), down = pi * (y + 0.5) / height;
            const glm::dvec3 value = function(
                glm::dvec3(std::sin(down) * std::sin(right), std::cos(down), -std::sin(down) * std::cos(right)));
            for (int c = 0; c < 3; ++c) image.floats[3 * (std::size_t(y) * width + x) + unsigned(c)] = float(value[c]);
        }
    return image;
}

/// Faces of a cube, seen from within; right and down of each as in OpenGL's table of cube map faces.
template <class Function>
std::vector<Texture> cube(unsigned size, Function&& function) {
    struct Face {
        glm::dvec3 towards, right, down;
    };
    const Face faces[] = {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                          {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                          {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}};
    std::vector<Texture> images;
    for (const Face& face : faces) {
        images.push_back(float_image(size, size));
        for (unsigned y = 0; y < size; ++y)
            for (unsigned x = 0; x < size; ++x) {
                const double s = 2 * (x + 0.5) / size - 1, t = 2 * (y + 0.5) / size - 1;
                const glm::dvec3 value = function(glm::normalize(face.towards + s * face.right + t * face.down));
                for (int c = 0; c < 3; ++c)
                    images.back().floats[3 * (std::size_t(y) * size + x) + unsigned(c)] = float(value[c]);
            }
    }
    return images;
}

/// Smooth, and without any symmetry.
glm::dvec3 gradient(const glm::dvec3& d) {
    return {1 + 0.9 * d.x, 1 + 0.7 * d.y + 0.2 * d.x * d.z, 1 + 0.8 * d.z * d.z - 0.5 * d.y};
}

Scene only(const Environment& environment) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, -1e4f)};
    scene.environment = environment;
    return scene;
}

glm::dvec3 seen_sky(Scene scene, const glm::vec3& direction) {
    scene.camera = narrow_camera({0, 0, 0}, direction);
    return mean(render_image(scene, {.width = 2, .height = 2, .spp = 1}));
}

const glm::vec3 directions[] = {{1, 0.1f, 0},     {-1, 0.2f, 0.3f}, {0.1f, 1, 0.2f}, {0.1f, 0.3f, 1}, {0.2f, -0.1f, -1},
                                {0.5f, 0.6f, -1}, {-1, -0.5f, -1},  {1, 2, 1},       {1, -0.3f, -1}};

TEST(Environment, IsSeenWhereItsDefinitionSays) {
    for (const bool faces : {false, true}) {
        Environment environment;
        environment.images = faces ? cube(64, gradient) : std::vector<Texture>{panorama(256, 128, gradient)};
        environment.strength = 2.f;
        for (const glm::vec3& direction : directions) {
            const glm::dvec3 expected = 2.0 * gradient(glm::normalize(glm::dvec3(direction)));
            const glm::dvec3 radiance = seen_sky(only(environment), direction);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(radiance[c], expected[c], 0.005) << (faces ? "cube " : "panorama ") << c << " "
                                                             << direction.x << " " << direction.y << " " << direction.z;
        }
    }
}

/// Counter-clockwise as seen from above: -z is turned to -x.
TEST(Environment, Turns) {
    Environment environment;
    environment.images = {panorama(256, 128, gradient)};
    environment.rotation = 0.7f;
    for (const glm::vec3& direction : directions) {
        const glm::dvec3 d = glm::normalize(glm::dvec3(direction));
        const double c = std::cos(0.7), s = std::sin(0.7);  // turned back
        const glm::dvec3 expected = gradient({c * d.x - s * d.z, d.y, s * d.x + c * d.z});
        EXPECT_NEAR(seen_sky(only(environment), direction).x, expected.x, 0.005)
            << direction.x << direction.y << direction.z;
    }
}

TEST(Environment, BytesAreDecoded) {
    Texture image;
    image.width = 2, image.height = 1, image.channels = 1, image.bytes = {128, 128};
    Environment environment;
    environment.images = {image};
    EXPECT_NEAR(seen_sky(only(environment), {1, 0, 0}).x, 0.2158605, 1e-5);  // of sRGB's 128
    environment.images[0].format = TexelFormat::linear8;
    EXPECT_NEAR(seen_sky(only(environment), {1, 0, 0}).x, 128 / 255.0, 1e-5);
}

TEST(Environment, TakesThePlaceOfTheSky) {
    Environment environment;
    environment.images = {float_image(4, 2)};  // black
    Scene scene = only(environment);
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    EXPECT_EQ(seen_sky(scene, {1, 0, 0}).x, 0);
}

TEST(Environment, BadTexelsAreRefused) {
    Environment environment;
    environment.images = {float_image(4, 2)};
    environment.images[0].floats[5] = NAN;
    EXPECT_TRUE(throws_error(ErrorKind::user, "column 1, row 0", [&] { (void)environment_image(environment); }));
    environment.images[0].floats[5] = -1.f;
    EXPECT_TRUE(throws_error(ErrorKind::user, "column 1, row 0", [&] { (void)environment_image(environment); }));
    environment.images.resize(2, float_image(4, 2));
    EXPECT_TRUE(throws_error(ErrorKind::user, "", [&] { (void)environment_image(environment); }));
}

/// A surface that absorbs nothing is invisible before it, with both techniques.
TEST(Environment, WhiteFurnace) {
    Scene scene;
    scene.materials = {material(MaterialKind::lambert, 1.f)};
    scene.meshes = {sphere(3)};
    scene.environment.images = {panorama(16, 8, [](const glm::dvec3&) { return glm::dvec3(1.0); })};
    scene.camera = Camera{{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 38.f};
    const glm::dvec3 radiance = mean(render_image(scene, {.width = 32, .height = 32, .spp = 64, .max_depth = 64}));
    EXPECT_NEAR(radiance.x, 1, 0.003);
    EXPECT_NEAR(radiance.z, 1, 0.003);
}

double irradiance_of(Scene scene, double& error, bool shadows = true) {
    scene.camera = narrow_camera({0.2f, 1, 0.1f}, {0, 0, 0});
    RenderConfig config{.width = 16, .height = 16, .spp = 256, .max_depth = 1};
    config.approximate.no_shadows = !shadows;
    Renderer renderer(device(), scene, config);
    error = renderer.render().noise / 16;
    return mean(renderer.image()).x * pi / 0.5;
}

/// One bright texel is a small sun: the radiance is bilinear, its integral that of one texel.
TEST(Environment, OneTexelEqualsADirectionalLight) {
    for (const auto& [column, row] : {std::pair{100u, 20u}, {0u, 40u}, {255u, 1u}}) {
        Scene scene;
        scene.materials = {lambert(0.5f)};
        scene.meshes = {square(1.f, 0.f)};
        scene.environment.images = {float_image(256, 128)};
        for (unsigned c = 0; c < 3; ++c) scene.environment.images[0].floats[3 * (row * 256 + column) + c] = 1e4f;
        double error, none;
        const double sun = irradiance_of(scene, error);
        scene.environment.images.clear();
        const double right = 2 * pi * ((column + 0.5) / 256 - 0.5);
        const auto sine_integral = [&](double v) {  // of the tent over rows, by the midpoint rule
            const double t = std::abs(v - (row + 0.5));
            return std::max(1 - t, 0.0) * std::sin(pi * v / 128) * std::cos(pi * v / 128);
        };
        double expected = 0;
        for (int i = 0; i < 4000; ++i) expected += sine_integral(row - 0.5 + (i + 0.5) / 2000) / 2000;
        expected *= 1e4 * (2 * pi / 256) * (pi / 128);
        EXPECT_LT(error, 0.0015);
        EXPECT_NEAR(sun / expected, 1, std::min(3 * error + 1e-4, 0.005)) << column << " " << row;

        const double down = pi * (row + 0.5) / 128, solid_angle = std::sin(down) * (2 * pi / 256) * (pi / 128);
        Light light;
        light.kind = LightKind::directional;
        light.direction =
            -glm::vec3(std::sin(down) * std::sin(right), std::cos(down), -std::sin(down) * std::cos(right));
        light.intensity = glm::vec3(float(1e4 * solid_angle));
        scene.lights = {light};
        EXPECT_NEAR(sun / irradiance_of(scene, none), 1, row == 1 ? 0.02 : 0.005) << column << " " << row;
    }
}

/// The gradient and a sun.
glm::dvec3 sunny(const glm::dvec3& d) {
    const double toward = std::max(glm::dot(d, glm::normalize(glm::dvec3(0.6, 0.7, -0.2))), 0.0);
    return gradient(d) + glm::dvec3(40 * std::pow(toward, 60));
}

/// Directions below the mean are found by BSDF sampling, where there is any: of a horizontal surface, by the midpoint
/// rule.
TEST(Environment, IrradianceIsTheIntegral) {
    double expected = 0;
    constexpr int side = 800;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const double square = (i + 0.5) / side, turn = 2 * pi * (j + 0.5) / side, level = std::sqrt(1 - square);
            expected += sunny({level * std::cos(turn), std::sqrt(square), level * std::sin(turn)}).x * pi / side / side;
        }
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    scene.environment.images = {panorama(256, 128, sunny)};
    double error;
    for (const bool shadows : {true, false}) {
        const double irradiance = irradiance_of(scene, error, shadows);
        EXPECT_NEAR(irradiance / expected, 1, std::min(3 * error + 3e-4, 0.005)) << shadows;
    }
}

/// Of the luminance, as the sampler sees it.
TEST(Environment, OnlyBrightDirectionsAreSampled) {
    Environment environment;
    environment.images = {panorama(64, 32, sunny)};
    const EnvironmentImage everywhere = environment_image(environment, false), bright = environment_image(environment);
    EXPECT_EQ(everywhere.baseline, 0);
    EXPECT_NEAR(bright.baseline, bright.integral / (4 * pi), 1e-5 * bright.baseline);
    EXPECT_GT(bright.density, 1.5f * everywhere.density);
    const auto constant = [](const glm::dvec3&) { return glm::dvec3(0.7); };
    environment.images = {panorama(64, 32, constant)};
    EXPECT_EQ(environment_image(environment).baseline, 0);  // nothing is brighter than the mean
}

/// No BSDF ray goes below the plane of a triangle, but light from there reaches a surface with vertex normals. Alone,
/// the sky is nowhere brighter than its mean, and its directions are sampled alike; beside a sun they are not.
TEST(Environment, DimLightFromBelowATrianglesPlaneIsNotLost) {
    const auto radiance = [](double of_sky, double of_sun, double& error) {
        Scene scene;
        scene.materials = {lambert(1.f)};
        scene.meshes = {sphere(1)};
        scene.meshes[0].normals = scene.meshes[0].positions;
        scene.environment.images = {panorama(32, 16, [&](const glm::dvec3& d) {
            return glm::dvec3(of_sky + (glm::dot(d, glm::normalize(glm::dvec3(1, 2, 1))) > 0.95 ? of_sun : 0.0));
        })};
        scene.camera = Camera{{0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 38.f};
        Renderer renderer(device(), scene, {.width = 32, .height = 32, .spp = 256, .max_depth = 1});
        error = renderer.render().noise / 32;
        return mean(renderer.image()).x;
    };
    double errors[3];
    const double sky = radiance(1, 0, errors[0]), sun = radiance(0, 5, errors[1]), both = radiance(1, 5, errors[2]);
    const double error = std::hypot(sky * errors[0], sun * errors[1], both * errors[2]);
    EXPECT_NEAR(both, sky + sun, std::min(3 * error, 0.004 * both));
}

TEST(Environment, CubeEqualsItsPanorama) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f)};
    double error_of_cube, error_of_panorama;
    scene.environment.images = cube(48, sunny);
    const double from_cube = irradiance_of(scene, error_of_cube);
    scene.environment.images = {panorama(192, 96, sunny)};
    const double from_panorama = irradiance_of(scene, error_of_panorama);
    EXPECT_NEAR(from_cube / from_panorama, 1, std::min(3 * std::hypot(error_of_cube, error_of_panorama) + 1e-3, 0.005));
}

// ---- the sampler ---------------------------------------------------------------------------------------------------

const char* sampler_kernels = R"(
    #include "verify/environment.cl"
    kernel void sample(EnvironmentData image, global const float* texels, global const float* cdf, global const float* random,
                       uint count, global float* out) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        LightView view;
        view_environment(image, texels, cdf, vload2(i, random), &view);
        float pdf;
        const float3 radiance = environment_radiance(image, texels, environment_place(image, view.direction), &pdf);
        vstore3(view.direction, 2 * i, out);
        vstore3((float3)(view.pdf, pdf, view.radiance.x * view.pdf - radiance.x), 2 * i + 1, out);
    }
    kernel void search(global const float* cdf, uint size, global const float* random, uint count, global uint* out) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        float at = random[i];
        out[i] = invert_cdf(cdf, size, &at);
    })";

class EnvironmentSampler : public testing::TestWithParam<int> {
protected:
    /// 0: smooth; 1: noise over many orders of magnitude with black parts; 2: one row; 3: one texel; 4: black but for
    /// one
    static Texture image() {
        if (GetParam() == 0) return panorama(40, 20, gradient);
        Texture noise = GetParam() == 2 ? float_image(7, 1) : GetParam() == 3 ? float_image(1, 1) : float_image(31, 17);
        std::mt19937 random(5);
        std::normal_distribution<float> exponent(0.f, 3.f);
        for (float& value : noise.floats) value = random() % 4 == 0 ? 0.f : std::exp(exponent(random));
        if (GetParam() == 3) noise.floats = {1, 2, 3};
        if (GetParam() == 4) {
            noise.floats.assign(noise.floats.size(), 0.f);
            noise.floats[3 * 31 + 1] = 5.f;
        }
        return noise;
    }
    void SetUp() override {
        Scene scene = only({});
        scene.environment.images = {image()};
        scene.environment.rotation = 1.f;
        lights = collect_lights(scene);
        texels = Buffer<float>(device(), lights.environment_texels);
        cdf = Buffer<float>(device(), lights.environment_cdf);
    }
    Lights lights;
    Buffer<float> texels, cdf;
};

TEST_P(EnvironmentSampler, DirectionsFollowTheDensity) {
    const std::uint32_t count = 400'000;
    std::mt19937 generator(11);
    std::uniform_real_distribution<float> unit(0.f, 0.9999999f);
    std::vector<float> random(2 * count);
    for (float& value : random) value = unit(generator);
    const Buffer<float> input(device(), random), output(device(), 6 * std::size_t(count));
    compile_kernel(device(), sampler_kernels, "sample")
        .run({count}, lights.data.environment, texels, cdf, input, count, output);
    const std::vector<float> samples = output.read();

    const int rows = 128, columns = 192, fine = 8;
    std::vector<float> grid;
    for (int i = 0; i < rows * fine; ++i)
        for (int j = 0; j < columns * fine; ++j) {
            const double y = 1 - 2 * (i + 0.5) / (rows * fine), turn = 2 * pi * (j + 0.5) / (columns * fine);
            const double level = std::sqrt(1 - y * y);
            for (const double v : {level * std::cos(turn), y, level * std::sin(turn)}) grid.push_back(float(v));
        }
    const auto points = std::uint32_t(grid.size() / 3);
    const Buffer<float> densities(device(), points);
    compile_kernel(device(), sampler_kernels, "density_of_environment")
        .run({points}, lights.data.environment, texels, points, Buffer<float>(device(), grid), densities);
    const std::vector<float> pdfs = densities.read();
    std::vector<double> expected(rows * columns), observed(rows * columns);
    double total = 0;
    for (std::size_t k = 0; k < points; ++k) {
        const std::size_t row = k / (columns * fine) / fine, column = k % (columns * fine) / fine;
        expected[row * columns + column] += count * double(pdfs[k]) * 4 * pi / points;
        total += double(pdfs[k]) * 4 * pi / points;
    }
    EXPECT_NEAR(total, 1, GetParam() == 0 ? 1e-4 : 3e-3);  // the midpoint rule meets the kinks between texels
    for (double& value : expected) value /= total;
    double largest_pdf = 0;
    for (const float pdf : pdfs) largest_pdf = std::max(largest_pdf, double(pdf));
    for (std::size_t i = 0; i < count; ++i) {
        const float* s = &samples[6 * i];
        ASSERT_NEAR(std::sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]), 1, 1e-5);
        const double turn = std::atan2(s[2], s[0]) / (2 * pi);
        const int row = std::clamp(int((1 - s[1]) / 2 * rows), 0, rows - 1);
        const int column = std::clamp(int((turn - std::floor(turn)) * columns), 0, columns - 1);
        ++observed[std::size_t(row * columns + column)];
        // Where radiance rises steeply, roundings of the direction show.
        ASSERT_NEAR(s[3] / lights.data.environment.probability, s[4], 2e-3 * s[4] + 3e-5 * largest_pdf);
    }
    const ChiSquared chi2 = chi_squared(observed, expected);
    EXPECT_GE(chi2.degrees, 80);
    EXPECT_TRUE(chi2.plausible()) << chi2.value << " for " << chi2.degrees << " degrees of freedom";
}

/// The starts of searches change no result, also for random numbers that are equal to one of the distribution.
TEST_P(EnvironmentSampler, SearchesLikeTheStandardLibrary) {
    const std::uint32_t width = lights.data.environment.width, rows = lights.data.environment.height + 1;
    std::size_t at = 0;
    for (std::uint32_t row = 0; row <= rows; ++row) {  // first that of the rows
        const std::uint32_t size = row == 0 ? rows : width;
        const auto begin = lights.environment_cdf.begin() + std::ptrdiff_t(at), end = begin + size;
        std::vector<float> random = {0.f, 0.99999994f};
        for (auto value = begin; value != end; ++value)
            for (const float x : {std::nextafter(*value, 0.f), *value, std::nextafter(*value, 1.f)})
                if (x < 1) random.push_back(x);
        for (std::uint32_t part = 1; part < CLARAY_CDF_PARTS; ++part)
            for (const float x : {0.f, 1.f}) random.push_back(std::nextafter(float(part) / float(CLARAY_CDF_PARTS), x));
        const std::vector<float> cdf_of_row(begin, begin + CLARAY_CDF_WORDS(size));
        const auto count = std::uint32_t(random.size());
        const Buffer<std::uint32_t> output(device(), count);
        compile_kernel(device(), sampler_kernels, "search")
            .run({count}, Buffer<float>(device(), cdf_of_row), size, Buffer<float>(device(), random), count, output);
        const std::vector<std::uint32_t> found = output.read();
        for (std::uint32_t i = 0; i < count; ++i)
            ASSERT_EQ(found[i], std::upper_bound(begin, end, random[i]) - begin) << random[i] << " in row " << row;
        at += CLARAY_CDF_WORDS(size);
    }
    EXPECT_EQ(at, lights.environment_cdf.size());
}

INSTANTIATE_TEST_SUITE_P(Images, EnvironmentSampler, testing::Range(0, 5));

}  // namespace
}  // namespace claray::test
