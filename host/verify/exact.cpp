#include "host/verify/exact.hpp"

#include <cmath>

namespace claray::verify {
namespace {

/// a * b * c of float32 values as two float64: the first product has 48 bits, and so fits.
void add_product(double a, double b, double c, double sign, double* to) {
    const double ab = sign * a * b;
    to[0] = ab * c;
    to[1] = std::fma(ab, c, -to[0]);
}

}  // namespace

int sign_of_sum(std::span<const double> values) {
    double parts[64];  // that do not overlap, from the smallest on
    std::size_t count = 0;
    for (const double value : values) {
        double sum = value;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < count; ++i) {  // Knuth's two-sum: nothing is lost
            const double total = sum + parts[i], part = total - sum;
            const double lost = (sum - (total - part)) + (parts[i] - part);
            if (lost != 0) parts[kept++] = lost;
            sum = total;
        }
        if (sum != 0) parts[kept++] = sum;
        count = kept;
    }
    return count == 0 ? 0 : parts[count - 1] > 0 ? 1 : -1;
}

int side_of(const Ray& r, const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 o(r.ox, r.oy, r.oz), d(r.dx, r.dy, r.dz), p = glm::dvec3(a) - o, q = glm::dvec3(b) - o;
    const double quick = d.x * (p.y * q.z - p.z * q.y) + d.y * (p.z * q.x - p.x * q.z) + d.z * (p.x * q.y - p.y * q.x);
    const double bound = std::abs(d.x) * (std::abs(p.y * q.z) + std::abs(p.z * q.y)) +
                         std::abs(d.y) * (std::abs(p.z * q.x) + std::abs(p.x * q.z)) +
                         std::abs(d.z) * (std::abs(p.x * q.y) + std::abs(p.y * q.x));
    if (std::abs(quick) > 1e-15 * bound) return quick > 0 ? 1 : -1;  // eight roundings of 2^-53
    // d . (a x b - a x o - o x b), term by term
    const glm::dvec3 firsts[3] = {a, a, o}, seconds[3] = {b, o, b};
    double terms[36];
    double* to = terms;
    for (int k = 0; k < 3; ++k) {
        const double sign = k == 0 ? 1 : -1;
        for (int x = 0; x < 3; ++x) {
            const int y = (x + 1) % 3, z = (x + 2) % 3;
            add_product(firsts[k][y], seconds[k][z], d[x], sign, to), to += 2;
            add_product(firsts[k][z], seconds[k][y], d[x], -sign, to), to += 2;
        }
    }
    return sign_of_sum(terms);
}

int side_of_plane(const glm::vec3& point, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    // det(a, b, c) - det(p, b, c) - det(a, p, c) - det(a, b, p), term by term
    const glm::dvec3 p(point), rows[4][3] = {{a, b, c}, {p, b, c}, {a, p, c}, {a, b, p}};
    double terms[48];
    double* to = terms;
    for (const auto& [first, second, third] : rows) {
        const double sign = to == terms ? 1 : -1;
        for (int x = 0; x < 3; ++x) {
            const int y = (x + 1) % 3, z = (x + 2) % 3;
            add_product(first[x], second[y], third[z], sign, to), to += 2;
            add_product(first[x], second[z], third[y], -sign, to), to += 2;
        }
    }
    return sign_of_sum(terms);
}

Place place_of(const Ray& ray, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const int u = side_of(ray, b, c), v = side_of(ray, c, a), w = side_of(ray, a, b);
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return Place::outside;
    if (u == 0 && v == 0 && w == 0) return Place::outside;
    return u != 0 && v != 0 && w != 0 ? Place::inside : Place::border;
}

}  // namespace claray::verify
