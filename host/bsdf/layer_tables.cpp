#include "host/bsdf/layer_tables.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/in_parallel.hpp"
#include "host/bsdf/microfacets.hpp"

namespace claray {
namespace {

using namespace microfacets;

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
void fill_fibres(float* tables) {
    const auto one = [](double) { return 1.0; };
    in_parallel(size, [&](std::size_t row) {
        const double root = place_of(int(row));  // the albedo changes fastest at low roughness
        const double roughness = CLARAY_LEAST_SHEEN + (1.0 - CLARAY_LEAST_SHEEN) * root * root;
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

using Matrix = std::array<TableRow, size>;

/// What facets reflect once: row i holds the shares of light from cosine_at(i) that arrive around the nodes, so that
/// its product with values at the nodes is their sum over the lobe. `kept` receives the sum of each row.
template <class Reflectance>
Matrix reflection_matrix(double alpha, Reflectance reflectance, TableRow& kept) {
    Matrix matrix{};
    for (int i = 0; i < size; ++i) {
        kept[i] = 0;
        for_reflections(cosine_at(i), alpha, reflectance, [&](double z, double share) {
            const double at = std::cbrt(std::min(z, 1.0)) * (size - 1), cell = std::min(std::floor(at), size - 2.0);
            matrix[i][int(cell)] += share * (1 - (at - cell)), matrix[i][int(cell) + 1] += share * (at - cell);
            kept[i] += share;
        });
    }
    return matrix;
}

/// Reflection of the kernels' metal without absorption, light of multiple scattering included.
Matrix metal_matrix(double alpha, const TableRow& weights) {
    TableRow kept;
    Matrix matrix = reflection_matrix(
        alpha, [](double) { return 1.0; }, kept);
    double average = 0;
    for (int i = 0; i < size; ++i) average += weights[i] * (1 - kept[i]);
    for (int i = 0; i < size && average > 0; ++i)
        for (int k = 0; k < size; ++k) matrix[i][k] += (1 - kept[i]) * (1 - kept[k]) * weights[k] / average;
    return matrix;
}

/// What lobes of a base lose, and how much of light they reflect.
struct Base {
    Matrix metal, dielectric;
    TableRow reflected;  ///< by the dielectric's interface, of index CLARAY_COAT_IOR
    TableRow weights;
};

Base make_base(int node) {
    const double alpha = alpha_at(node, metal_size);
    Base base;
    base.weights = average_weights(root_cosine, alpha);
    base.metal = metal_matrix(alpha, base.weights);
    base.dielectric = reflection_matrix(
        alpha, [](double c) { return fresnel(c, CLARAY_COAT_IOR); }, base.reflected);
    return base;
}

/// Fills the row of a table of CLARAY_SPREAD_TABLE for a layer and a base by what a lobe lacks, times `factor`.
void fill_spread(float* table, int layer, int node, const TableRow& lacks, const TableRow& weights, double factor) {
    const int row = layer * metal_size + node;
    double average = 0;
    for (int i = 0; i < size; ++i) {
        table[row * size + i] = float(factor * lacks[i]);
        average += weights[i] * factor * lacks[i];
    }
    table[CLARAY_COAT_TABLE + row] = float(average);
}

/// One over the rise of Fresnel's curve of CLARAY_COAT_IOR.
const double by_rise = 1 / (1 - fresnel(1, CLARAY_COAT_IOR));

/// The scaling D with D(o) * sum of matrix(o, i) D(i) = passed(o) (Sinkhorn 1964), by damped iteration.
TableRow solve_scaling(const Matrix& matrix, const TableRow& passed) {
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
    return d;
}

/// Of the dielectric's lobe: what it lacks of the light that the coat lets pass if both directions are scaled by D.
TableRow lost_by_scaling(const Base& base, const TableRow& passed, const TableRow& d) {
    TableRow lost{};
    for (int i = 0; i < size; ++i) {
        double sum = 0;
        for (int k = 0; k < size; ++k) sum += base.dielectric[i][k] * d[k];
        lost[i] = passed[i] * base.reflected[i] - d[i] * sum;
    }
    return lost;
}

/// What a lobe loses if the layer above takes the larger share of both directions.
TableRow lost_by_larger(const Matrix& lobe, const float* taken) {
    TableRow lost{};
    for (int i = 0; i < size; ++i)
        for (int k = 0; k < size; ++k)
            lost[i] += lobe[i][k] * std::max(std::min(double(taken[k]), 1.0) - std::min(double(taken[i]), 1.0), 0.0);
    return lost;
}

/// What a coat lets pass at the cosines of the nodes, for each roughness.
std::array<TableRow, size> passed_by_coats(double ior) {
    std::array<TableRow, size> passed;
    in_parallel(size, [&](std::size_t coat) {
        for (int i = 0; i < size; ++i)
            passed[coat][i] = 1 - reflected_once(cosine_at(i), alpha_at(int(coat)),
                                                 [&](double cosine) { return fresnel(cosine, ior); });
    });
    return passed;
}

/// `taken`: the albedos of sheen.
void fill_coat_over_sheen(float* table, const float* taken) {
    const std::array<TableRow, size> passed = passed_by_coats(CLARAY_COAT_IOR);
    const TableRow weights = average_weights(root_cosine, 0);
    for (int fibres = 0; fibres < size; ++fibres)
        for (int coat = 0; coat < size; ++coat) {
            double both = 0, all = 0;
            for (int i = 0; i < size; ++i) {
                const double share = weights[std::size_t(i)] * double(taken[fibres * size + i]);
                both += share * passed[std::size_t(coat)][std::size_t(i)], all += share;
            }
            table[fibres * size + coat] = float(both / all);
        }
}

}  // namespace

void fill_coat(float* scales, double ior) {
    const std::array<TableRow, size> passed = passed_by_coats(ior);
    in_parallel(metal_size, [&](std::size_t node) {
        const Base base = make_base(int(node));
        for (int coat = 0; coat < size; ++coat) {
            const TableRow d = solve_scaling(base.metal, passed[coat]);
            std::transform(d.begin(), d.end(), scales + (coat * metal_size + int(node)) * size,
                           [](double v) { return float(v); });
            fill_spread(scales + CLARAY_COAT_SPREAD - CLARAY_COAT_SCALES, coat, int(node),
                        lost_by_scaling(base, passed[coat], d), base.weights, by_rise);
        }
    });
}

void fill_sheen(float* tables, double) {
    fill_fibres(tables);
    const float* taken = tables + CLARAY_BOUNDED_SHEEN - CLARAY_SHEEN;
    fill_coat_over_sheen(tables + CLARAY_COAT_OVER_SHEEN - CLARAY_SHEEN, taken);
    in_parallel(metal_size, [&](std::size_t node) {
        const Base base = make_base(int(node));
        for (int fibres = 0; fibres < size; ++fibres) {
            fill_spread(tables + CLARAY_SHEEN_OVER_METAL - CLARAY_SHEEN, fibres, int(node),
                        lost_by_larger(base.metal, taken + fibres * size), base.weights, 1);
            fill_spread(tables + CLARAY_SHEEN_OVER_INTERFACE - CLARAY_SHEEN, fibres, int(node),
                        lost_by_larger(base.dielectric, taken + fibres * size), base.weights, by_rise);
        }
    });
}

}  // namespace claray
