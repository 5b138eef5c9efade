#include "host/bsdf/energy_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

#include "host/base/in_parallel.hpp"
#include "host/bsdf/custom_bsdfs.hpp"
#include "host/bsdf/layer_tables.hpp"
#include "host/bsdf/material_data.hpp"
#include "host/bsdf/microfacets.hpp"

namespace claray {
namespace {

using namespace microfacets;

/// Fills one table with value(cosine, alpha).
template <class Value>
void fill_table(float* table, CosineOf cosine_of, Value value) {
    in_parallel(size, [&](std::size_t row) {
        const double alpha = alpha_at(int(row));
        const TableRow weights = average_weights(cosine_of, alpha);
        double average = 0;
        for (int i = 0; i < size; ++i) {
            const double v = std::clamp(value(cosine_of(place_of(i), alpha), alpha), 0.0, 1.0);
            table[row * size + i] = float(v);
            average += weights[i] * v;
        }
        table[size * size + row] = float(cosine_of == loss_cosine ? average / (alpha * alpha) : average);
    });
}

void fill_conductor(float* table, double) {
    const auto all = [](double) { return 1.0; };
    fill_table(table, loss_cosine, [&](double cosine, double alpha) { return 1 - reflected_once(cosine, alpha, all); });
}

// ---- anisotropy

/// Albedo of single scattering by facets with this reflectance and an alpha along x and one along y, for light from
/// `o`.
template <class Reflectance>
double stretched_reflection(Vector o, double along, double across, Reflectance reflectance) {
    constexpr int rings = 32, turns = 64;
    static const auto angles = make_turns<turns>();
    const auto shadow = [&](Vector v) {
        const double slope2 = (along * along * v.x * v.x + across * across * v.y * v.y) / (v.z * v.z);
        return 0.5 * (std::sqrt(1 + slope2) - 1);
    };
    const double length = std::sqrt(along * along * o.x * o.x + across * across * o.y * o.y + o.z * o.z);
    const Vector view{along * o.x / length, across * o.y / length, o.z / length};
    const double masked = 1 + shadow(o);
    double sum = 0;
    for (int turn = 0; turn < turns; ++turn) {
        const double angle = 2 * pi * (turn + 0.5) / turns, c = std::cos(angle), s = std::sin(angle);
        for (int ring = 0; ring < rings; ++ring) {
            const double z = 1 - (ring + angles[std::size_t(turn)].shift) / rings * (1 + view.z);
            const double radius = std::sqrt(std::max(0.0, 1 - z * z));
            const Vector n{along * (radius * c + view.x), across * (radius * s + view.y), z + view.z};
            const double scale = 1 / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            const double to_normal = (o.x * n.x + o.y * n.y + o.z * n.z) * scale;
            const Vector i{2 * to_normal * n.x * scale - o.x, 2 * to_normal * n.y * scale - o.y,
                           2 * to_normal * n.z * scale - o.z};
            if (i.z > 0) sum += reflectance(to_normal) * masked / (masked + shadow(i));
        }
    }
    return sum / (rings * turns);
}

/// One pair of alphas: a row for each of three angles to the tangent, and their average over the hemisphere.
template <class Reflectance>
void fill_stretched_rows(float* rows, float* average, CosineOf cosine_of, double along, double across,
                         Reflectance reflectance) {
    *average = 0.f;
    for (int k = 0; k < 3; ++k) {
        const double sine2 = 0.5 * k, alpha = std::sqrt(along * along * (1 - sine2) + across * across * sine2);
        const TableRow weights = average_weights(cosine_of, alpha);
        for (int i = 0; i < size; ++i) {
            const double cosine = cosine_of(place_of(i), alpha), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
            const Vector o{sine * std::sqrt(1 - sine2), sine * std::sqrt(sine2), cosine};
            const double lost = std::clamp(1 - stretched_reflection(o, along, across, reflectance), 0.0, 1.0);
            rows[k * size + i] = float(lost);
            *average += float((k == 1 ? 0.5 : 0.25) * weights[std::size_t(i)] * lost);
        }
    }
}

/// Kernels look up only alphas along the tangent that are at least those across it: cells on and above the diagonal.
template <class Reflectance>
void fill_stretched_table(float* table, CosineOf cosine_of, Reflectance reflectance) {
    constexpr int steps = CLARAY_STRETCH_SIZE;
    in_parallel(steps * steps, [&](std::size_t cell) {
        const int along = int(cell) / steps, across = int(cell) % steps;
        if (across > along + 1) return;
        fill_stretched_rows(table + cell * CLARAY_STRETCH_ROW, table + CLARAY_STRETCH_AVERAGES + cell, cosine_of,
                            alpha_at(along, steps), alpha_at(across, steps), reflectance);
    });
}

void fill_stretched(float* table, double) {
    fill_stretched_table(table, loss_cosine, [](double) { return 1.0; });
}
void fill_stretched_opaque(float* table, double ior) {
    fill_stretched_table(table, root_cosine, [=](double cosine) { return fresnel(cosine, ior); });
}

// ---- films and changed reflectances

/// Adds a share of light at facets of this cosine to the shares at the tabulated cosines: Lagrange's cubic weights over
/// the root of the cosine, of which the tabulated ones are multiples.
void add_facet(double* shares, double cosine, double share) {
    const double at = std::sqrt(std::clamp(cosine, 0.0, 1.0)) * (CLARAY_FACET_COSINES - 1);
    const int first = std::clamp(int(at) - 1, 0, CLARAY_FACET_COSINES - 4);
    for (int k = first; k < first + 4; ++k) {
        double weight = share;
        for (int other = first; other < first + 4; ++other)
            if (other != k) weight *= (at - other) / (k - other);
        shares[k] += weight;
    }
}

void fill_facets(float* table, double) {
    constexpr int count = CLARAY_FACET_COSINES;
    in_parallel(size, [&](std::size_t row) {
        const double alpha = alpha_at(int(row));
        const TableRow weights = average_weights(root_cosine, alpha);
        double averages[count] = {};
        for (int i = 0; i < size; ++i) {
            const double cosine = cosine_at(i), masked = 1 + lambda(cosine, alpha);
            double shares[count] = {};
            for_visible_normals(cosine, alpha, [&](Vector n, Vector o, double weight) {
                const double to_normal = o.x * n.x + o.z * n.z, z = 2 * to_normal * n.z - o.z;
                if (z > 0) add_facet(shares, to_normal, weight * masked / (masked + lambda(z, alpha)));
            });
            for (int k = 0; k < count; ++k) {
                table[(row * size + i) * count + k] = float(shares[k]);
                averages[k] += weights[i] * shares[k];
            }
        }
        for (int k = 0; k < count; ++k) table[CLARAY_FACET_AVERAGES + row * count + k] = float(averages[k]);
    });
}

/// Of glass: what each facet's transmission passes on more than its reflection does.
void fill_glass_facets(float* tables, double ior) {
    constexpr int count = CLARAY_FACET_COSINES;
    in_parallel(2 * size, [&](std::size_t piece) {
        const bool inside = piece >= size;
        const std::size_t row = piece % size;
        const double alpha = alpha_at(int(row)), eta = inside ? 1 / ior : ior;
        float* table = tables + (inside ? CLARAY_FACET_TABLE : 0);
        const TableRow weights = average_weights(loss_cosine, alpha);
        double averages[count] = {};
        for (int i = 0; i < size; ++i) {
            const double cosine = loss_cosine(place_of(i), alpha), masked = 1 + lambda(cosine, alpha);
            double gains[count] = {};
            for_visible_normals(cosine, alpha, [&](Vector n, Vector o, double weight) {
                const double to_normal = o.x * n.x + o.z * n.z, up = 2 * to_normal * n.z - o.z;
                const double beyond2 = 1 - (1 - to_normal * to_normal) / (eta * eta);
                if (beyond2 <= 0) return;
                const double beyond = std::sqrt(beyond2), down = o.z / eta - (to_normal / eta - beyond) * n.z;
                const double reflected = up > 0 ? masked / (masked + lambda(up, alpha)) : 0;
                const double transmitted = down > 0 ? 1 / (1 + lambda(down, alpha)) : 0;
                add_facet(gains, inside ? beyond : to_normal, weight * (transmitted - reflected));
            });
            for (int k = 0; k < count; ++k) {
                table[(row * size + i) * count + k] = float(gains[k]);
                averages[k] += weights[i] * gains[k];
            }
        }
        for (int k = 0; k < count; ++k)
            table[CLARAY_FACET_AVERAGES + row * count + k] = float(averages[k] / (alpha * alpha));
    });
}

void fill_opaque(float* table, double ior) {
    const auto reflectance = [&](double cosine) { return fresnel(cosine, ior); };
    fill_table(table, root_cosine,
               [&](double cosine, double alpha) { return 1 - reflected_once(cosine, alpha, reflectance); });
}

/// The tables of light lost outside and inside, and the transmittance after them.
void fill_transparent(float* tables, double ior) {
    for (const bool inside : {false, true}) {
        const double eta = inside ? 1 / ior : ior;
        const auto reflectance = [&](double cosine) { return fresnel(cosine, eta); };
        fill_table(tables + (inside ? CLARAY_LOST_INSIDE - CLARAY_LOST_OUTSIDE : 0), loss_cosine,
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
    tables[CLARAY_TRANSMITTANCE - CLARAY_LOST_OUTSIDE] = float(transmittance);
}

/// Copies what `fill` computes for an index of refraction. Renderers of the same materials share the result. Animated
/// materials can have any number of indices: when 64 are kept, all are forgotten.
template <auto fill, int length>
void copy_table(float* to, double ior = 1) {
    static std::mutex mutex;
    static std::map<double, std::vector<float>> made;
    const std::scoped_lock lock(mutex);
    if (made.size() == 64 && !made.contains(ior)) made.clear();
    std::vector<float>& values = made[ior];
    if (values.empty()) {
        values.resize(length);
        fill(values.data(), ior);
    }
    std::copy(values.begin(), values.end(), to);
}

}  // namespace

EnergyTables::EnergyTables(std::span<const Material> materials) {
    for (const Material& material : materials) add_needs(material);
    fill_tables();
    for (const Material& material : materials) {
        check_custom(material);
        if (material.kind != MaterialKind::custom || parameters_.contains(material.parameters)) continue;
        parameters_[material.parameters] = std::uint32_t(data_.size());
        data_.insert(data_.end(), material.parameters.begin(), material.parameters.end());
    }
}

void EnergyTables::fill_tables() {
    if (!conductor_ && !sheen_ && !stretched_ && !film_ && needs_.empty()) return;
    data_.resize(film_        ? CLARAY_FACETS + CLARAY_FACET_TABLE
                 : stretched_ ? CLARAY_STRETCH + CLARAY_STRETCH_TABLE
                 : sheen_     ? CLARAY_STRETCH
                              : CLARAY_ENERGY_TABLE);
    constexpr int transparent = CLARAY_TRANSMITTANCE + 1 - CLARAY_LOST_OUTSIDE;
    if (conductor_) copy_table<fill_conductor, CLARAY_ENERGY_TABLE>(data_.data());
    if (sheen_) copy_table<fill_sheen, CLARAY_STRETCH - CLARAY_SHEEN>(data_.data() + CLARAY_SHEEN);
    if (stretched_) copy_table<fill_stretched, CLARAY_STRETCH_TABLE>(data_.data() + CLARAY_STRETCH);
    if (film_) copy_table<fill_facets, CLARAY_FACET_TABLE>(data_.data() + CLARAY_FACETS);
    for (const auto& [ior, needs] : needs_) {
        blocks_[ior] = std::uint32_t(data_.size());
        data_.resize(data_.size() + (needs.changed     ? CLARAY_GLASS_FACETS + 2 * CLARAY_FACET_TABLE
                                     : needs.stretched ? CLARAY_STRETCHED_UNREFLECTED + CLARAY_STRETCH_TABLE
                                     : needs.coat      ? CLARAY_STRETCHED_UNREFLECTED
                                                       : CLARAY_ENERGY_BLOCK));
        float* block = data_.data() + blocks_[ior];
        if (needs.opaque) copy_table<fill_opaque, CLARAY_ENERGY_TABLE>(block + CLARAY_UNREFLECTED, ior);
        if (needs.transparent) copy_table<fill_transparent, transparent>(block + CLARAY_LOST_OUTSIDE, ior);
        if (needs.coat)
            copy_table<fill_coat, CLARAY_STRETCHED_UNREFLECTED - CLARAY_COAT_SCALES>(block + CLARAY_COAT_SCALES, ior);
        if (needs.changed) copy_table<fill_glass_facets, 2 * CLARAY_FACET_TABLE>(block + CLARAY_GLASS_FACETS, ior);
        if (needs.stretched)
            copy_table<fill_stretched_opaque, CLARAY_STRETCH_TABLE>(block + CLARAY_STRETCHED_UNREFLECTED, ior);
    }
}

void EnergyTables::add_needs(const Material& m) {
    const bool rough = m.roughness > 0, rough_wall = rough || (has_clearcoat(m) && m.clearcoat_roughness > 0);
    conductor_ = conductor_ || (has_metal(m) && rough) || (has_thin_walls(m) && rough_wall);
    conductor_ = conductor_ || (has_specular_layer(m) && rough);
    sheen_ = sheen_ || has_sheen(m);
    stretched_ = stretched_ || is_anisotropic(m);
    if (has_rough_glass(m)) needs_[ior_of_tables(m)].transparent = true;
    if (has_rough_glass(m) && (has_film(m) || has_specular_layer(m))) needs_[ior_of_tables(m)].changed = true;
    film_ = film_ || (has_film(m) && has_diffuse_dielectric(m));
    if (has_diffuse_dielectric(m)) needs_[ior_of_tables(m)].opaque = true;
    if (has_diffuse_dielectric(m) && is_anisotropic(m)) needs_[ior_of_tables(m)].stretched = true;
    if (has_clearcoat(m)) needs_[CLARAY_COAT_IOR].opaque = true;
    if (has_clearcoat(m) && (has_metal(m) || has_diffuse_dielectric(m))) needs_[CLARAY_COAT_IOR].coat = true;
}

std::uint32_t EnergyTables::block_of(float ior) const {
    const auto block = blocks_.find(ior);
    return block == blocks_.end() ? 0 : block->second;
}

std::uint32_t EnergyTables::parameters_of(const Material& material) const {
    const auto begin = parameters_.find(material.parameters);
    return begin == parameters_.end() ? 0 : begin->second;
}

}  // namespace claray
