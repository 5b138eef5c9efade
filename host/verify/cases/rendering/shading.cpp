// What light does at surfaces, as images show it: environments, heights, masks, lamps that are too close, normals that
// are not the surface's, and the noise of samplers.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "claray/renderer.hpp"
#include "host/base/format.hpp"
#include "host/lights/environment.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/rendering/bsdf.hpp"
#include "host/verify/scenes.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Bright at both poles, and in a texel at the seam.
Texture uneven_sky() {
    Texture sky;
    sky.width = 32, sky.height = 16, sky.channels = 3, sky.format = TexelFormat::float32;
    for (unsigned y = 0; y < sky.height; ++y)
        for (unsigned x = 0; x < sky.width; ++x) {
            const float value = y == 0 ? 50.f : y == 15 ? 20.f + float(x) : x == 31 && y == 8 ? 80.f : 0.3f;
            sky.floats.insert(sky.floats.end(), 3, value);
        }
    return sky;
}
/// Chi-squared of the counts `seen` in cells with these expected numbers; `cells` receives the number of cells that are
/// used.
double chi_squared(const std::vector<double>& expected, const std::vector<double>& seen, double* cells) {
    double sum = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i] < 20) continue;
        sum += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
        ++*cells;
    }
    return sum;
}

/// Images that are black in part, and random numbers at the ends of their range.
void extreme_samples(Run& run, Tally& sound) {
    for (const unsigned lit : {0u, 5u, 7u, 15u}) {
        Environment environment;
        Texture sky;
        sky.width = 8, sky.height = 4, sky.channels = 3, sky.format = TexelFormat::float32;
        for (unsigned i = 0; i < 32; ++i) sky.floats.insert(sky.floats.end(), 3, i == lit || i == 16 + lit ? 1.f : 0.f);
        environment.images = {sky};
        const EnvironmentImage image = environment_image(environment);
        const EnvironmentData data{image.width, image.height, 0.f, image.baseline, image.density, 1.f};
        const Buffer<float> drawn(run.device(), 4 * 16);
        load_kernel(run.device(), "verify/environment.cl", "sample_environment")
            .run({16, 16}, data, arg("texels", Buffer<float>(run.device(), image.texels)),
                 arg("cdf", Buffer<float>(run.device(), image.cdf)), 16u, 0xffffffffu, arg("samples", drawn));
        const auto found = drawn.read();
        for (std::size_t i = 0; i < 16; ++i) {
            const float *d = &found[4 * i], pdf = found[4 * i + 3];
            sound.add(std::abs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-4f && pdf >= 0 && std::isfinite(pdf));
        }
    }
}

/// A bright spot at the pole, where rows of the image shrink to a point, and another beside the seam.
void environment_poles(Run& run) {
    Environment environment;
    environment.images = {uneven_sky()};
    const EnvironmentImage image = environment_image(environment);
    const EnvironmentData data{image.width, image.height, 0.f, image.baseline, image.density, 1.f};
    const Buffer<float> texels(run.device(), image.texels), cdf(run.device(), image.cdf);

    // The density's integral, by the midpoint rule in the angles, and per bin.
    const int rows = 24, columns = 24, fine = run.count(16, 64);
    std::vector<float> directions;
    std::vector<double> areas;
    for (int r = 0; r < rows * fine; ++r)
        for (int c = 0; c < columns * fine; ++c) {
            const double theta = (r + 0.5) * pi / (rows * fine), phi = (c + 0.5) * 2 * pi / (columns * fine);
            directions.insert(directions.end(), {float(std::sin(theta) * std::cos(phi)), float(std::cos(theta)),
                                                 float(std::sin(theta) * std::sin(phi))});
            areas.push_back((std::cos(theta - 0.5 * pi / (rows * fine)) - std::cos(theta + 0.5 * pi / (rows * fine))) *
                            2 * pi / (columns * fine));
        }
    const auto count = std::uint32_t(areas.size());
    const Buffer<float> densities(run.device(), count);
    load_kernel(run.device(), "verify/environment.cl", "density_of_environment")
        .run({count, 64}, data, arg("texels", texels), count,
             arg("directions", Buffer<float>(run.device(), directions)), arg("densities", densities));
    std::vector<double> shares(std::size_t(rows) * columns);
    double integral = 0;
    const auto pdfs = densities.read();
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t row = i / (std::size_t(columns) * fine) / std::size_t(fine),
                          column = i % (std::size_t(columns) * fine) / std::size_t(fine);
        shares[row * columns + column] += pdfs[i] * areas[i], integral += pdfs[i] * areas[i];
    }
    run.check("integral of the density off 1", count, std::abs(integral - 1), 1e-4, "");

    const auto samples = run.count(300'000u, 4'000'000u);
    const Buffer<float> drawn(run.device(), 4 * std::size_t(samples));
    load_kernel(run.device(), "verify/environment.cl", "sample_environment")
        .run({samples, 64}, data, arg("texels", texels), arg("cdf", cdf), samples, std::uint32_t(run.seed()),
             arg("samples", drawn));
    const auto found = drawn.read();
    std::vector<double> seen(shares.size());
    Tally sound;
    for (std::size_t i = 0; i < samples; ++i) {
        const float *d = &found[4 * i], pdf = found[4 * i + 3];
        sound.add(std::abs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-4f && pdf > 0 && std::isfinite(pdf));
        const int row = std::min(rows - 1, int(std::acos(std::clamp(double(d[1]), -1.0, 1.0)) / pi * rows));
        const double turn = std::atan2(double(d[2]), double(d[0])) / (2 * pi);
        ++seen[std::size_t(row) * columns +
               std::size_t(std::min(columns - 1, int((turn < 0 ? turn + 1 : turn) * columns)))];
    }
    for (double& share : shares) share *= samples / integral;
    double degrees = 0;
    const double chi2 = chi_squared(shares, seen, &degrees);
    extreme_samples(run, sound);
    run.check("invalid directions", sound, "samples");
    const double chance = chance_of_chi_squared(chi2, degrees - 1);
    run.check("1 - chance of the directions, chi-squared", samples, 1 - chance, 0.99, "");
    if (chance < 0.01)
        run.failure("chi-squared is " + std::to_string(chi2) + " at " + std::to_string(degrees) + " degrees");
}

/// Largest error of the normal of a plane wave over a square, from a height map of so many texels a side.
double height_error(const Run& run, unsigned texels) {
    Scene scene;
    Texture wave;
    wave.width = wave.height = texels, wave.channels = 1, wave.format = TexelFormat::float32,
    wave.filter = Filter::bilinear;
    for (unsigned y = 0; y < texels; ++y)
        for (unsigned x = 0; x < texels; ++x)
            wave.floats.push_back(float(0.5 + 0.5 * std::sin(2 * pi * ((x + 0.5) / texels + 2 * (y + 0.5) / texels))));
    scene.textures = {wave}, scene.materials = {grey(0.8f)}, scene.meshes = {square(1.f, 0.f, 0)};
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    scene.materials[0].height_map.texture = 0, scene.materials[0].height_scale = 0.1f;
    double worst = 0;
    for (int i = 0; i < run.count(5, 40); ++i) {
        const double u = (std::floor(std::fmod(0.13 + 0.17 * i, 1.0) * texels) + 0.5) / texels,
                     v = (std::floor(0.31 * texels) + 0.5) / texels;
        const glm::vec3 at(float(2 * u - 1), 0.f, float(2 * v - 1));
        scene.camera = narrow_camera(at + glm::vec3(0, 1, 0), at);
        const glm::dvec3 normal(Renderer(run.device(), scene, {.width = 1, .height = 1}).aovs().normal[0]);
        const double slope = 0.05 * 2 * pi * std::cos(2 * pi * (u + 2 * v));
        worst = std::max(worst, glm::length(normal - glm::normalize(glm::dvec3(-slope / 2, 1, -slope))));
    }
    return worst;
}

void height_fields(Run& run) {
    const double coarse = height_error(run, 32), fine = height_error(run, 128), order = std::log2(coarse / fine) / 2;
    run.check("largest error of the normal, 32 texels", 1, coarse, 0.03, "");
    run.fact("largest error of the normal, 128 texels", printed("%.3g", fine));
    run.check("order of convergence off 2", 2, std::abs(order - 2), 0.1, "");
}

/// A leaf's alpha mask seen from growing distances: the covered share of the card must stay the same.
void alpha_coverage(Run& run) {
    Scene scene;
    Texture leaf;
    leaf.width = leaf.height = 64, leaf.channels = 4, leaf.format = TexelFormat::srgb8;
    for (unsigned y = 0; y < 64; ++y)
        for (unsigned x = 0; x < 64; ++x) {
            const double distance = std::hypot((x + 0.5) / 64 - 0.5, (y + 0.5) / 64 - 0.5);
            leaf.bytes.insert(
                leaf.bytes.end(),
                {0, 0, 0, std::uint8_t(std::lround(255 * std::clamp(0.5 + (0.35 - distance) * 8, 0.0, 1.0)))});
        }
    scene.textures = {leaf}, scene.materials = {grey(0.f)}, scene.meshes = {square(1.f, 0.f, 0)};
    scene.materials[0].albedo_map.texture = 0, scene.materials[0].alpha_mode = AlphaMode::mask;
    scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
    double worst = 0;
    for (const double pixels : {32.0, 8.0, 2.0}) {  // that the card covers across
        const unsigned size = 16;
        scene.camera = Camera{{0, 10, 0},
                              {0, 0, 0},
                              {0, 0, -1},
                              float(2 * std::atan(0.1 * std::max(1.0, size / pixels)) * 180 / std::numbers::pi)};
        const unsigned spp = run.count(256u, 4096u) * unsigned(std::max(1.0, 16 / pixels));
        const double seen = 1 - mean_of(render(run, scene, {.width = size, .height = size, .spp = spp}));
        const double share = seen * std::pow(std::max(1.0, size / pixels), 2),
                     drift = std::abs(share / (pi * 0.35 * 0.35) - 1);
        run.fact(printed("coverage at %g pixels", pixels), printed("%.4f", share));
        worst = std::max(worst, drift);
    }
    run.check("drift of the coverage", 3, worst, 0.02, "");
}

/// A lamp of radiance L nearly on the floor gives it at most the radiance albedo * L; a point light gives that of the
/// formula.
void light_distance_zero(Run& run) {
    double most = 0;
    Tally finite;
    for (const float height : {1e-1f, 1e-3f, 1e-5f, 1e-7f}) {
        Scene scene;
        scene.materials = {grey(0.6f), grey(0.f, 3.f)};
        scene.meshes = {square(6.f, 0.f, 0), square(1.f, height, 1)};
        scene.camera = narrow_camera({2.f, 0.5f * height, 0.f}, {0.25f, 0.f, 0.5f});
        Renderer renderer(run.device(), scene,
                          {.width = 4, .height = 4, .spp = run.count(256u, 16'384u), .max_depth = 1});
        renderer.render();
        const double radiance = mean_of(renderer.image());
        finite.add(std::isfinite(radiance) && renderer.statistics().dropped_samples == 0);
        most = std::max(most, radiance / (0.6 * 3));
    }
    run.check("light from a lamp on the surface over a full hemisphere's", 4, most, 1.01, "");
    for (const float distance : {1e-2f, 1e-6f, 1e-12f, 0.f}) {
        Scene scene;
        scene.materials = {grey(0.6f)};
        scene.meshes = {square(1.f, 0.f, 0)};
        scene.lights = {point_light({0, distance, 0}, glm::vec3(5.f))};
        scene.camera = narrow_camera({0.f, 1.f, 1.f}, {0.f, 0.f, 0.f});
        for (const glm::vec3& p : render(run, scene, {.width = 4, .height = 4, .spp = 16, .max_depth = 1}))
            finite.add(std::isfinite(p.x + p.y + p.z) && p.x >= 0);
    }
    run.check("images that are not finite", finite, "pixels");
}

/// A coarse sphere with smooth normals, lit from the side: black facets near the terminator are the artifact.
void shadow_terminator(Run& run) {
    Scene scene;
    scene.materials = {grey(1.f)};
    scene.meshes = {sphere(2)};
    scene.meshes[0].normals = scene.meshes[0].positions;
    Light sun;
    const glm::vec3 to_sun = glm::normalize(glm::vec3(1.f, 0.3f, 0.2f));  // no plane of the mesh's symmetry
    sun.kind = LightKind::directional, sun.direction = -to_sun, sun.intensity = glm::vec3(float(pi));
    scene.lights = {sun};
    scene.camera = Camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 28.f};
    const unsigned size = run.count(96u, 512u);
    const RenderConfig config{.width = size, .height = size, .spp = run.count(4u, 64u), .max_depth = 1};
    Renderer renderer(run.device(), scene, config);
    renderer.render();
    const auto image = renderer.image();
    const Aovs aovs = renderer.aovs();
    double sum = 0, error = 0, largest = 0;
    std::uint64_t pixels = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        if (aovs.primitive[i] == CLARAY_MISS) continue;
        const double cosine = std::max(0.0, double(glm::dot(aovs.normal[i], to_sun)));
        sum += cosine, error += std::abs(image[i].x - cosine), ++pixels;
        if (aovs.normal[i].z > 0.5f) largest = std::max(largest, std::abs(image[i].x - cosine));
    }
    run.check("mean error over the mean of the analytic cosine", pixels, error / sum, 0.05, "");
    run.check("largest error, away from the outline", pixels, largest, 0.02, "of the light");
}

/// Images by two samplers agree in every pixel within their noise: a z-test, Sidak-corrected for all pixels.
void image_statistics(Run& run) {
    const unsigned size = run.count(20u, 64u);
    const int seeds = run.count(12, 64);
    for (const char* const name : {"cornell", "spheres"}) {
        const Scene scene = *builtin_scene(name);
        const std::size_t pixels = std::size_t(size) * size;
        std::vector<std::array<double, 4>> sums(pixels);  // of either sampler and of its squares
        for (int seed = 0; seed < seeds; ++seed)
            for (const Sampler sampler : {Sampler::sobol, Sampler::independent}) {
                const auto image = render(run, scene,
                                          {.width = size,
                                           .height = size,
                                           .spp = 32,
                                           .max_depth = 4,
                                           .seed = std::uint32_t(seed + 100 * run.seed()),
                                           .sampler = sampler});
                const std::size_t k = sampler == Sampler::sobol ? 0 : 2;
                for (std::size_t i = 0; i < pixels; ++i)
                    sums[i][k] += image[i].y, sums[i][k + 1] += double(image[i].y) * image[i].y;
            }
        const double significance = 1 - std::pow(1 - 0.01, 1.0 / double(pixels));
        std::size_t passed = 0;
        for (const auto& s : sums) {
            const double a = s[0] / seeds, b = s[2] / seeds, n = seeds;
            const double variance = (std::max(0.0, s[1] / n - a * a) + std::max(0.0, s[3] / n - b * b)) / (n - 1);
            const double z = variance > 0 ? std::abs(a - b) / std::sqrt(variance) : a == b ? 0 : 1e9;
            // Student's t with about 2 n - 2 degrees, to its normal (Wallace 1959).
            const double nu = 2 * n - 2, normal = (8 * nu + 1) / (8 * nu + 3) * std::sqrt(nu * std::log1p(z * z / nu));
            passed += std::erfc(normal / std::numbers::sqrt2) >= significance;
        }
        run.check(std::string("pixels that two samplers disagree about, ") + name, pixels,
                  double(pixels - passed) / double(pixels), 0.0025, "of all");
    }
}

}  // namespace

Cases shading_cases() {
    return {
        {{"environment-poles", "images", "Directions of an environment image, with its poles and its seam"},
         environment_poles},
        {{"height-fields", "images", "Normals from heights converge with the square of the texel size"}, height_fields},
        {{"alpha-coverage", "images", "Alpha masks cover the same area from far away"}, alpha_coverage},
        {{"light-at-distance-0", "images", "Lamps on a surface: finite, and no more than a hemisphere of light"},
         light_distance_zero},
        {{"shadow-terminator", "images", "A coarse sphere with smooth normals is lit according to its normals"},
         shadow_terminator},
        {{"image-statistics", "images", "Two samplers agree in every pixel within their noise"}, image_statistics},
    };
}

}  // namespace claray::verify
