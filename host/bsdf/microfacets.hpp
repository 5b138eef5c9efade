// Single scattering by microfacets in float64, from which the energy tables are integrated.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "claray/shared/energy.h"

namespace claray::microfacets {

inline constexpr int size = CLARAY_ENERGY_SIZE, metal_size = CLARAY_METAL_SIZE;
using std::numbers::pi;

struct Vector {
    double x, y, z;
};

/// Converts a position in a row, 0 to 1, to a cosine: the inverses of cosine_place and loss_place in
/// kernels/bsdf/ggx.clh. The first cosine is slightly above 0, because nothing is visible at 0.
inline double root_cosine(double place, double) { return std::max(place * place * place, 1e-5); }
inline double loss_cosine(double place, double alpha) {
    const double s = std::cos(place * pi / 2) * std::cos(place * pi / 2);
    return std::max(alpha * (1 - s) / (s + alpha), 1e-5 * alpha);
}
inline double place_of(int node) { return double(node) / (size - 1); }
inline double cosine_at(int node) { return root_cosine(place_of(node), 0); }
/// GGX's alpha at a node of roughness; that of a mirror is slightly above 0.
inline double alpha_at(int node, int nodes = size) {
    const double roughness = double(node) / (nodes - 1);
    return std::max(roughness * roughness, 1e-6);
}

/// Reflectance of a smooth interface; `eta` is the index beyond over the one before.
inline double fresnel(double cosine, double eta) {
    const double beyond2 = 1 - (1 - cosine * cosine) / (eta * eta);
    if (beyond2 <= 0) return 1;
    const double beyond = std::sqrt(beyond2);
    const double s = (cosine - eta * beyond) / (cosine + eta * beyond);
    const double p = (eta * cosine - beyond) / (eta * cosine + beyond);
    return 0.5 * (s * s + p * p);
}

/// Smith's Lambda.
inline double lambda(double cosine, double alpha) {
    const double tangent2 = std::max(0.0, 1 - cosine * cosine) / (cosine * cosine);
    return 0.5 * (std::sqrt(1 + alpha * alpha * tangent2) - 1);
}

/// An angle around the normal, and the offset of its points between those of neighbouring angles.
struct Turn {
    double cosine, sine, shift;
};
template <int turns>
std::array<Turn, turns> make_turns() {
    std::array<Turn, turns> t{};
    for (int i = 0; i < turns; ++i) {
        int reversed = 0;
        for (int bit = 1; bit < turns; bit *= 2) reversed = 2 * reversed + ((i & bit) != 0);
        t[i] = {std::cos(pi * (i + 0.5) / turns), std::sin(pi * (i + 0.5) / turns), (reversed + 0.5) / turns};
    }
    return t;
}

/// Calls visit(normal, outgoing, weight) for visible microfacet normals: those of sample_visible_normal in
/// kernels/bsdf/ggx.clh at Hammersley points. Narrow lobes vary least along the rings. Symmetry halves the work.
template <class Visit>
void for_visible_normals(double cosine, double alpha, Visit visit) {
    constexpr int points = 1024;
    static const auto few = make_turns<16>();
    static const auto many = make_turns<32>();
    const std::span<const Turn> turns = alpha < 0.4 ? std::span<const Turn>(few) : std::span<const Turn>(many);
    const int rings = points / int(turns.size());
    const Vector outgoing{std::sqrt(std::max(0.0, 1 - cosine * cosine)), 0, cosine};
    const double length = std::hypot(alpha * outgoing.x, outgoing.z);
    const double view_x = alpha * outgoing.x / length, view_z = outgoing.z / length;
    for (const Turn& turn : turns)
        for (int ring = 0; ring < rings; ++ring) {
            const double z = 1 - (ring + turn.shift) / rings * (1 + view_z);
            const double radius = std::sqrt(std::max(0.0, 1 - z * z));
            const Vector n{alpha * (radius * turn.cosine + view_x), alpha * radius * turn.sine, z + view_z};
            const double scale = 1 / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            visit(Vector{n.x * scale, n.y * scale, n.z * scale}, outgoing, 1.0 / points);
        }
}

/// Calls visit(incoming_z, share) for light that GGX with Fresnel's term `reflectance(cosine)` reflects once into
/// directions with that incoming_z.
template <class Reflectance, class Visit>
void for_reflections(double cosine, double alpha, Reflectance reflectance, Visit visit) {
    const double masked = 1 + lambda(cosine, alpha);
    for_visible_normals(cosine, alpha, [&](Vector n, Vector o, double weight) {
        const double to_normal = o.x * n.x + o.z * n.z, z = 2 * to_normal * n.z - o.z;
        if (z > 0) visit(z, weight * reflectance(to_normal) * masked / (masked + lambda(z, alpha)));
    });
}

template <class Reflectance>
inline double reflected_once(double cosine, double alpha, Reflectance reflectance) {
    double sum = 0;
    for_reflections(cosine, alpha, reflectance, [&](double, double share) { sum += share; });
    return sum;
}

inline double transmitted_once(double cosine, double alpha, double eta) {
    double sum = 0;
    for_visible_normals(cosine, alpha, [&](Vector n, Vector o, double weight) {
        const double to_normal = o.x * n.x + o.z * n.z;
        const double beyond2 = 1 - (1 - to_normal * to_normal) / (eta * eta);
        if (beyond2 <= 0) return;
        const double z = (to_normal / eta - std::sqrt(beyond2)) * n.z - o.z / eta;
        if (z < 0) sum += weight * (1 - fresnel(to_normal, eta)) / (1 + lambda(-z, alpha));
    });
    return sum;
}

using TableRow = std::array<double, size>;
using CosineOf = double (*)(double place, double alpha);

/// Weights of a row's values in the average over the hemisphere, 2 integral of value * cosine, for values that are
/// linear between the nodes.
inline TableRow average_weights(CosineOf cosine_of, double alpha) {
    constexpr int steps = 32;
    TableRow weights{};
    double before = 0;  // cosine^2, whose difference is the integral of 2 cosine
    for (int k = 1; k <= steps * (size - 1); ++k) {
        const double cosine = k == steps * (size - 1) ? 1 : cosine_of(double(k) / steps / (size - 1), alpha);
        const int node = (k - 1) / steps;
        const double within = (k - 0.5) / steps - node, share = cosine * cosine - before;
        weights[node] += share * (1 - within), weights[node + 1] += share * within;
        before = cosine * cosine;
    }
    return weights;
}

}  // namespace claray::microfacets
