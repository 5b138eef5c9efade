#include "host/bsdf/energy_tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

#include "host/base/in_parallel.hpp"
#include "host/bsdf/custom_bsdfs.hpp"
#include "host/bsdf/material_data.hpp"

namespace claray {
namespace {

constexpr int size = CLARAY_ENERGY_SIZE, metal_size = CLARAY_METAL_SIZE;
using std::numbers::pi;

struct Vector {
    double x, y, z;
};

/// Converts a position in a row, 0 to 1, to a cosine: the inverses of cosine_place and loss_place in
/// kernels/bsdf/ggx.clh. The first cosine is slightly above 0, because nothing is visible at 0.
double root_cosine(double place, double) { return std::max(place * place * place, 1e-5); }
double loss_cosine(double place, double alpha) {
    const double s = std::cos(place * pi / 2) * std::cos(place * pi / 2);
    return std::max(alpha * (1 - s) / (s + alpha), 1e-5 * alpha);
}
double place_of(int node) { return double(node) / (size - 1); }
double cosine_at(int node) { return root_cosine(place_of(node), 0); }
/// GGX's alpha at a node of roughness; that of a mirror is slightly above 0.
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

using TableRow = std::array<double, size>;
using CosineOf = double (*)(double place, double alpha);

/// Weights of a row's values in the average over the hemisphere, 2 integral of value * cosine, for values that are
/// linear between the nodes.
TableRow average_weights(CosineOf cosine_of, double alpha) {
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

// ---- sheen

/// Charlie's Lambda (Estevez and Kulla 2017, "Production friendly microfacet sheen BRDF", section 2.2).
double sheen_lambda(double cosine, double alpha) {
    const double t = (1 - alpha) * (1 - alpha);
    const auto fitted = [&](double x) {
        const auto between = [&](double rough, double smooth) { return rough + t * (smooth - rough); };
        return between(21.5473, 25.3245) / (1 + between(3.82987, 3.32435) * std::pow(x, between(0.19823, 0.16801))) +
               between(-1.97760, -1.27393) * x + between(-4.32054, -4.85967);
    };
    return std::exp(cosine < 0.5 ? fitted(cosine) : 2 * fitted(0.5) - fitted(1 - cosine));
}

/// A row's value at a position from 0 to 1.
double interpolated(const float* row, double place) {
    const double at = place * (size - 1);
    const int cell = std::min(int(at), size - 2);
    return row[cell] + (at - cell) * (double(row[cell + 1]) - row[cell]);
}

/// The albedo of white sheen: eval_sheen in kernels/bsdf/layers/sheen.clh divided by `bound(incoming cosine)`,
/// integrated by the midpoint rule over the cube root of the incoming cosine and the angle between both directions.
template <class Bound>
double sheen_albedo(double cosine, double alpha, Bound bound) {
    constexpr int rings = 64, turns = 32;
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), masked = 1 + sheen_lambda(cosine, alpha);
    double sum = 0;
    for (int ring = 0; ring < rings; ++ring) {
        const double u = (ring + 0.5) / rings, z = u * u * u, side = std::sqrt(1 - z * z);
        const double visible = 3 * u * u / (4 * cosine * (masked + sheen_lambda(z, alpha)) * bound(z));
        for (int turn = 0; turn < turns; ++turn) {
            const double between = sine * side * std::cos(pi * (turn + 0.5) / turns) + cosine * z;
            const double up = cosine + z, half2 = up * up / (2 + 2 * between);  // cosine^2 of the half vector
            sum += visible * std::pow(std::max(0.0, 1 - half2), 0.5 / alpha);
        }
    }
    return sum * (2 + 1 / alpha) / (rings * turns);
}

/// Both tables. Where the bound sets in, the albedo bends downwards, so that values between nodes would be too small
/// and sheen would add light: nodes are raised.
void fill_sheen(float* tables, double) {
    const auto one = [](double) { return 1.0; };
    in_parallel(size, [&](std::size_t row) {
        const double roughness = CLARAY_LEAST_SHEEN + (1.0 - CLARAY_LEAST_SHEEN) * place_of(int(row));
        const double alpha = roughness * roughness;
        float *published = tables + row * size, *bounded = published + CLARAY_BOUNDED_SHEEN - CLARAY_SHEEN;
        for (int i = 0; i < size; ++i) published[i] = float(sheen_albedo(cosine_at(i), alpha, one));
        const auto albedo_at = [&](double place) {
            const double here = interpolated(published, place);
            return sheen_albedo(root_cosine(place, 0), alpha, [&](double z) {
                return std::max({1.0, here, interpolated(published, std::cbrt(z))});
            });
        };
        for (int i = 0; i < size; ++i) bounded[i] = float(albedo_at(place_of(i)));
        for (int i = 0; i + 1 < size; ++i) {
            const double middle = (i + 0.5) / (size - 1);
            const double missing = albedo_at(middle) - interpolated(bounded, middle);
            if (missing > 0) bounded[i] += float(missing), bounded[i + 1] += float(missing);
        }
    });
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

// ---- thin films

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

/// Reflection of the kernels' metal without absorption: row i holds the shares of light from cosine_at(i) that arrive
/// around the nodes, so that its product with values at the nodes is their average over the lobe.
std::array<TableRow, size> metal_matrix(double alpha) {
    std::array<TableRow, size> matrix{};
    const TableRow weights = average_weights(root_cosine, alpha);
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
void solve_scaling(const std::array<TableRow, size>& matrix, const TableRow& passed, float* scale) {
    TableRow d{};
    for (int i = 0; i < size; ++i) d[i] = std::sqrt(passed[i]);
    for (int iteration = 0; iteration < 24; ++iteration) {
        TableRow next{};
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
    std::array<TableRow, size> passed;
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
                 : sheen_     ? CLARAY_BOUNDED_SHEEN + CLARAY_ENERGY_TABLE
                              : CLARAY_ENERGY_TABLE);
    constexpr int transparent = CLARAY_TRANSMITTANCE + 1 - CLARAY_LOST_OUTSIDE;
    if (conductor_) copy_table<fill_conductor, CLARAY_ENERGY_TABLE>(data_.data());
    if (sheen_) copy_table<fill_sheen, 2 * CLARAY_ENERGY_TABLE>(data_.data() + CLARAY_SHEEN);
    if (stretched_) copy_table<fill_stretched, CLARAY_STRETCH_TABLE>(data_.data() + CLARAY_STRETCH);
    if (film_) copy_table<fill_facets, CLARAY_FACET_TABLE>(data_.data() + CLARAY_FACETS);
    for (const auto& [ior, needs] : needs_) {
        blocks_[ior] = std::uint32_t(data_.size());
        data_.resize(data_.size() + (needs.stretched ? CLARAY_STRETCHED_UNREFLECTED + CLARAY_STRETCH_TABLE
                                     : needs.coat    ? CLARAY_COAT_SCALES + CLARAY_COAT_TABLE
                                                     : CLARAY_ENERGY_BLOCK));
        float* block = data_.data() + blocks_[ior];
        if (needs.opaque) copy_table<fill_opaque, CLARAY_ENERGY_TABLE>(block + CLARAY_UNREFLECTED, ior);
        if (needs.transparent) copy_table<fill_transparent, transparent>(block + CLARAY_LOST_OUTSIDE, ior);
        if (needs.coat) copy_table<fill_coat_scales, CLARAY_COAT_TABLE>(block + CLARAY_COAT_SCALES, ior);
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
    film_ = film_ || (has_film(m) && has_diffuse_dielectric(m));
    if (has_diffuse_dielectric(m)) needs_[ior_of_tables(m)].opaque = true;
    if (has_diffuse_dielectric(m) && is_anisotropic(m)) needs_[ior_of_tables(m)].stretched = true;
    if (has_clearcoat(m)) needs_[CLARAY_COAT_IOR].opaque = true;
    if (has_coated_metal(m) || has_coated_dielectric(m) || (has_layered_coat(m) && has_metal(m)))
        needs_[CLARAY_COAT_IOR].coat = true;
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
