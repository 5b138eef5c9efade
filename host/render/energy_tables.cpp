#include "host/render/energy_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/compute/in_parallel.hpp"
#include "host/render/material_data.hpp"

namespace claray {
namespace {

constexpr int size = CLARAY_ENERGY_SIZE, metal_size = CLARAY_METAL_SIZE;
constexpr double pi = std::numbers::pi;

struct Vector {
    double x, y, z;
};

/// A place in a row, from 0 to 1, to a cosine: the inverses of cosine_place and loss_place in
/// kernels/shade/bsdf_ggx.clh. The first place's is not quite 0, where nothing is visible.
double root_cosine(double place, double) { return std::max(place * place * place, 1e-5); }
double loss_cosine(double place, double alpha) {
    const double s = std::cos(place * pi / 2) * std::cos(place * pi / 2);
    return std::max(alpha * (1 - s) / (s + alpha), 1e-5 * alpha);
}
double place_of(int node) { return double(node) / (size - 1); }
double cosine_at(int node) { return root_cosine(place_of(node), 0); }
/// GGX's alpha at a node of roughness; a mirror's is not quite 0.
double alpha_at(int node, int nodes = size) {
    const double roughness = double(node) / (nodes - 1);
    return std::max(roughness * roughness, 1e-6);
}

/// Reflectance of a smooth interface; `eta` is the index beyond over the one before.
double fresnel(double cosine, double eta) {
    const double beyond2 = 1 - (1 - cosine * cosine) / (eta * eta);
    if (beyond2 <= 0) return 1;
    const double beyond = std::sqrt(beyond2);
    const double s = (cosine - eta * beyond) / (cosine + eta * beyond);
    const double p = (eta * cosine - beyond) / (eta * cosine + beyond);
    return 0.5 * (s * s + p * p);
}

/// Smith's Lambda.
double lambda(double cosine, double alpha) {
    const double tangent2 = std::max(0.0, 1 - cosine * cosine) / (cosine * cosine);
    return 0.5 * (std::sqrt(1 + alpha * alpha * tangent2) - 1);
}

/// An angle around the normal, and where its points are between those of the angles beside it.
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

/// Calls visit(normal, outgoing, weight) for microfacet normals that are seen equally often: those of
/// sample_visible_normal in kernels/shade/bsdf_ggx.clh, at Hammersley's points. Narrow lobes vary along the rings
/// least. Symmetry spares half of them.
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

/// Of light that GGX with Fresnel's term `reflectance(cosine)` reflects once, to the direction incoming_z: calls
/// visit(incoming_z, share).
template <class Reflectance, class Visit>
void for_reflections(double cosine, double alpha, Reflectance reflectance, Visit visit) {
    const double masked = 1 + lambda(cosine, alpha);
    for_visible_normals(cosine, alpha, [&](Vector n, Vector o, double weight) {
        const double to_normal = o.x * n.x + o.z * n.z, z = 2 * to_normal * n.z - o.z;
        if (z > 0) visit(z, weight * reflectance(to_normal) * masked / (masked + lambda(z, alpha)));
    });
}

template <class Reflectance>
double reflected_once(double cosine, double alpha, Reflectance reflectance) {
    double sum = 0;
    for_reflections(cosine, alpha, reflectance, [&](double, double share) { sum += share; });
    return sum;
}

double transmitted_once(double cosine, double alpha, double eta) {
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

using Row = std::array<double, size>;
using CosineOf = double (*)(double place, double alpha);

/// Weights of a row's values in its average over the hemisphere, 2 integral of value * cosine, for what is linear
/// between the nodes.
Row average_weights(CosineOf cosine_of, double alpha) {
    constexpr int steps = 32;
    Row weights{};
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

/// Fills one table with value(cosine, alpha).
template <class Value>
void fill_table(float* table, CosineOf cosine_of, Value value) {
    in_parallel(size, [&](std::size_t row) {
        const double alpha = alpha_at(int(row));
        const Row weights = average_weights(cosine_of, alpha);
        double average = 0;
        for (int i = 0; i < size; ++i) {
            const double v = std::clamp(value(cosine_of(place_of(i), alpha), alpha), 0.0, 1.0);
            table[row * size + i] = float(v);
            average += weights[i] * v;
        }
        table[size * size + row] = float(cosine_of == loss_cosine ? average / (alpha * alpha) : average);
    });
}

void fill_conductor(float* table) {
    const auto all = [](double) { return 1.0; };
    fill_table(table, loss_cosine, [&](double cosine, double alpha) { return 1 - reflected_once(cosine, alpha, all); });
}

void fill_opaque(float* block, double ior) {
    const auto reflectance = [&](double cosine) { return fresnel(cosine, ior); };
    fill_table(block + CLARAY_UNREFLECTED, root_cosine,
               [&](double cosine, double alpha) { return 1 - reflected_once(cosine, alpha, reflectance); });
}

void fill_transparent(float* block, double ior) {
    for (const bool inside : {false, true}) {
        const double eta = inside ? 1 / ior : ior;
        const auto reflectance = [&](double cosine) { return fresnel(cosine, eta); };
        fill_table(block + (inside ? CLARAY_LOST_INSIDE : CLARAY_LOST_OUTSIDE), loss_cosine,
                   [&](double cosine, double alpha) {
                       return 1 - reflected_once(cosine, alpha, reflectance) - transmitted_once(cosine, alpha, eta);
                   });
    }
    double transmittance = 0;
    const int steps = 1000;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        transmittance += 2 * cosine * (1 - fresnel(cosine, ior)) / steps;
    }
    block[CLARAY_TRANSMITTANCE] = float(transmittance);
}

/// How the kernels' metal that absorbs nothing reflects: row i has the shares of light from cosine_at(i) that arrive
/// around the nodes, so that its product with values at the nodes is their average over the lobe.
std::array<Row, size> metal_matrix(double alpha) {
    std::array<Row, size> matrix{};
    const Row weights = average_weights(root_cosine, alpha);
    double lost[size], average = 0;
    for (int i = 0; i < size; ++i) {
        double kept = 0;
        for_reflections(
            cosine_at(i), alpha, [](double) { return 1.0; },
            [&](double z, double share) {
                const double at = std::cbrt(std::min(z, 1.0)) * (size - 1), cell = std::min(std::floor(at), size - 2.0);
                matrix[i][int(cell)] += share * (1 - (at - cell)), matrix[i][int(cell) + 1] += share * (at - cell);
                kept += share;
            });
        lost[i] = 1 - kept;
        average += weights[i] * lost[i];
    }
    for (int i = 0; i < size && average > 0; ++i)
        for (int k = 0; k < size; ++k) matrix[i][k] += lost[i] * lost[k] * weights[k] / average;
    return matrix;
}

/// The scaling D with D(o) * sum of matrix(o, i) D(i) = passed(o) (Sinkhorn 1964), by damped iteration.
void solve_scaling(const std::array<Row, size>& matrix, const Row& passed, float* scale) {
    Row d{};
    for (int i = 0; i < size; ++i) d[i] = std::sqrt(passed[i]);
    for (int iteration = 0; iteration < 24; ++iteration) {
        Row next{};
        for (int i = 0; i < size; ++i) {
            double sum = 1e-300;
            for (int k = 0; k < size; ++k) sum += matrix[i][k] * d[k];
            next[i] = std::sqrt(d[i] * passed[i] / sum);
        }
        d = next;
    }
    std::transform(d.begin(), d.end(), scale, [](double v) { return float(v); });
}

void fill_coat_scales(float* scales, double ior) {
    std::array<Row, size> passed;
    in_parallel(size, [&](std::size_t coat) {
        for (int i = 0; i < size; ++i)
            passed[coat][i] = 1 - reflected_once(cosine_at(i), alpha_at(int(coat)),
                                                 [&](double cosine) { return fresnel(cosine, ior); });
    });
    in_parallel(metal_size, [&](std::size_t metal) {
        const auto matrix = metal_matrix(alpha_at(int(metal), metal_size));
        for (int coat = 0; coat < size; ++coat)
            solve_scaling(matrix, passed[coat], scales + (coat * metal_size + int(metal)) * size);
    });
}

}  // namespace

EnergyTables::EnergyTables(std::span<const Material> materials) {
    for (const Material& material : materials) add_needs(material);
    if (!conductor_ && needs_.empty()) return;
    data_.resize(CLARAY_ENERGY_TABLE);
    if (conductor_) fill_conductor(data_.data());
    for (const auto& [ior, needs] : needs_) {
        blocks_[ior] = std::uint32_t(data_.size());
        data_.resize(data_.size() + CLARAY_ENERGY_BLOCK + (needs.coat ? CLARAY_COAT_TABLE : 0));
        float* block = data_.data() + blocks_[ior];
        if (needs.opaque) fill_opaque(block, double(ior));
        if (needs.transparent) fill_transparent(block, double(ior));
        if (needs.coat) fill_coat_scales(block + CLARAY_COAT_SCALES, double(ior));
    }
}

void EnergyTables::add_needs(const Material& m) {
    const bool rough = m.roughness > 0, rough_wall = rough || (has_clearcoat(m) && m.clearcoat_roughness > 0);
    conductor_ = conductor_ || (has_metal(m) && rough) || (has_thin_walls(m) && rough_wall);
    if (has_rough_glass(m)) needs_[m.ior].transparent = true;
    if (has_diffuse_dielectric(m)) needs_[m.ior].opaque = true;
    if (has_clearcoat(m)) needs_[CLARAY_COAT_IOR].opaque = true;
    if (has_coated_metal(m)) needs_[CLARAY_COAT_IOR].coat = true;
}

std::uint32_t EnergyTables::block_of(float ior) const {
    const auto block = blocks_.find(ior);
    return block == blocks_.end() ? 0 : block->second;
}

}  // namespace claray
