#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "claray/shared/spherical_harmonics.h"
#include "host/verify/cases/cases.hpp"

namespace claray::verify {
namespace {

constexpr std::size_t harmonics = CLARAY_HARMONICS, icosahedron_vertices = 12;

/// The vertices of an icosahedron in a random orientation. Their mean is the mean over the sphere for polynomials up to
/// degree 5 (Delsarte, Goethals and Seidel 1977, "Spherical codes and designs"); products of two harmonics have 4.
std::array<glm::dvec3, icosahedron_vertices> icosahedron(std::mt19937& random) {
    std::normal_distribution<double> normal;
    const auto direction = [&] { return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))); };
    const glm::dvec3 z = direction(), x = glm::normalize(glm::cross(z, direction())), y = glm::cross(z, x);
    std::array<glm::dvec3, icosahedron_vertices> all{};
    all[0] = z, all[1] = -z;
    for (int i = 0; i < 5; ++i) {
        const double turn = 2 * 3.141592653589793 * i / 5;
        all[std::size_t(2 + i)] = (z + 2.0 * (std::cos(turn) * x + std::sin(turn) * y)) / std::sqrt(5.0);
        all[std::size_t(7 + i)] = -all[std::size_t(2 + i)];
    }
    return all;
}

/// Twice the integral of z P(z) from 0 to 1 for the Legendre polynomial of a band, by Simpson's rule.
double clamped_cosine(int band) {
    const auto legendre = [&](double z) { return band == 0 ? 1.0 : band == 1 ? z : 1.5 * z * z - 0.5; };
    constexpr int steps = 64;
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
        const double z = double(i) / steps, weight = i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * z * legendre(z);
    }
    return 2 * sum / (3 * steps);
}

void spherical_harmonics(Run& run) {
    std::mt19937 random(std::uint32_t(run.seed()));
    const auto bodies = run.count(200u, 10'000u);
    std::vector<float> directions;
    for (unsigned b = 0; b < bodies; ++b)
        for (const glm::dvec3& d : icosahedron(random))
            directions.insert(directions.end(), {float(d.x), float(d.y), float(d.z)});
    const auto count = std::uint32_t(directions.size() / 3);
    const Buffer<float> values(run.device(), harmonics * count);
    load_kernel(run.device(), "verify/harmonics.cl", "harmonics_of_directions")
        .run({count, 64}, count, arg("directions", Buffer<float>(run.device(), directions)), arg("values", values));
    const std::vector<float> found = values.read();

    const double share = 4 * 3.141592653589793 / icosahedron_vertices;
    double off_orthonormal = 0, off_sky = 0;
    for (unsigned b = 0; b < bodies; ++b) {
        const float* of_body = &found[b * icosahedron_vertices * harmonics];
        std::array<double, harmonics> sky{};
        for (std::size_t i = 0; i < harmonics; ++i)
            for (std::size_t k = 0; k < harmonics; ++k) {
                double product = 0;
                for (std::size_t v = 0; v < icosahedron_vertices; ++v)
                    product += share * of_body[v * harmonics + i] * of_body[v * harmonics + k];
                off_orthonormal = std::max(off_orthonormal, std::abs(product - (i == k ? 1 : 0)));
            }
        for (std::size_t i = 0; i < harmonics; ++i)
            for (std::size_t v = 0; v < icosahedron_vertices; ++v)
                sky[i] += share * of_body[v * harmonics + i] * claray_harmonic_of_cosine(std::uint32_t(i));
        for (std::size_t v = 0; v < icosahedron_vertices; ++v) {
            double irradiance = 0;
            for (std::size_t i = 0; i < harmonics; ++i) irradiance += sky[i] * of_body[v * harmonics + i];
            off_sky = std::max(off_sky, std::abs(irradiance - 1));
        }
    }
    double off_cosine = 0;
    for (std::uint32_t i = 0; i < harmonics; ++i)
        off_cosine = std::max(off_cosine, std::abs(clamped_cosine(i == 0  ? 0
                                                                  : i < 4 ? 1
                                                                          : 2) -
                                                   claray_harmonic_of_cosine(i)));
    run.check("products of two harmonics over the sphere off 0 or 1", bodies, off_orthonormal, 1e-6, "");
    run.check("irradiance of a constant sky of radiance 1, over pi, off 1", count, off_sky, 1e-6, "");
    run.check("bands of the clamped cosine over pi, off 1, 2/3 and 1/4", harmonics, off_cosine, 1e-6, "");
}

}  // namespace

Cases harmonics_cases() {
    return {
        {{"spherical-harmonics", "images",
          "Spherical harmonics are orthonormal and keep the irradiance of a constant sky"},
         spherical_harmonics},
    };
}

}  // namespace claray::verify
