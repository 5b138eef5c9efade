#include "host/verify/oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "host/base/in_parallel.hpp"
#include "host/verify/exact.hpp"

namespace claray::verify {
namespace {

constexpr std::size_t block = Oracle::block;
constexpr double infinity = std::numeric_limits<double>::infinity();

#if defined(__x86_64__) && !defined(__clang__)
#define CLARAY_WIDEST __attribute__((target_clones("avx512f", "avx2,fma", "default")))
#else
#define CLARAY_WIDEST
#endif

struct Rows {
    const double* v0[3];
    const double* e1[3];
    const double* e2[3];
};

Rows rows_of(const std::vector<double>* v0, const std::vector<double>* e1, const std::vector<double>* e2) {
    return {{v0[0].data(), v0[1].data(), v0[2].data()},
            {e1[0].data(), e1[1].data(), e1[2].data()},
            {e2[0].data(), e2[1].data(), e2[2].data()}};
}

/// For each triangle of a block, the ray's distance inside the nearest edge in units of the determinant; negative for a
/// miss. Uses arithmetic without branches, which compilers vectorise.
CLARAY_WIDEST void block_insides(const Rows& m, std::size_t at, const double* o, const double* d,
                                 double* __restrict insides) {
    for (std::size_t k = 0; k < block; ++k) {
        const std::size_t i = at + k;
        const double e1x = m.e1[0][i], e1y = m.e1[1][i], e1z = m.e1[2][i];
        const double e2x = m.e2[0][i], e2y = m.e2[1][i], e2z = m.e2[2][i];
        const double sx = o[0] - m.v0[0][i], sy = o[1] - m.v0[1][i], sz = o[2] - m.v0[2][i];
        const double px = d[1] * e2z - d[2] * e2y, py = d[2] * e2x - d[0] * e2z, pz = d[0] * e2y - d[1] * e2x;
        const double qx = sy * e1z - sz * e1y, qy = sz * e1x - sx * e1z, qz = sx * e1y - sy * e1x;
        const double det = e1x * px + e1y * py + e1z * pz;
        const double sign = std::copysign(1.0, det);
        const double u = (sx * px + sy * py + sz * pz) * sign, v = (d[0] * qx + d[1] * qy + d[2] * qz) * sign;
        const double w = det * sign - (u + v);
        const double uv = u < v ? u : v;
        insides[k] = uv < w ? uv : w;
    }
}

/// Distance to triangle i, or infinity where its plane holds the ray.
double distance_to(const Rows& m, std::size_t i, const double* o, const double* d) {
    const double e1x = m.e1[0][i], e1y = m.e1[1][i], e1z = m.e1[2][i];
    const double e2x = m.e2[0][i], e2y = m.e2[1][i], e2z = m.e2[2][i];
    const double nx = e1y * e2z - e1z * e2y, ny = e1z * e2x - e1x * e2z, nz = e1x * e2y - e1y * e2x;
    const double along = nx * d[0] + ny * d[1] + nz * d[2];
    if (along == 0) return infinity;
    return (nx * (m.v0[0][i] - o[0]) + ny * (m.v0[1][i] - o[1]) + nz * (m.v0[2][i] - o[2])) / along;
}

}  // namespace

Oracle::Oracle(std::span<const Mesh> meshes) {
    for (const Mesh& mesh : meshes)
        for (const glm::uvec3& t : mesh.triangles) add(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
    pad();
}

Oracle::Oracle(std::span<const glm::dvec3> corners) {
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) add(corners[i], corners[i + 1], corners[i + 2]);
    pad();
}

void Oracle::add(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    for (int axis = 0; axis < 3; ++axis) {
        v0_[axis].push_back(a[axis]);
        e1_[axis].push_back(b[axis] - a[axis]);
        e2_[axis].push_back(c[axis] - a[axis]);
        const double edge = std::max(std::fabs(e1_[axis].back()), std::fabs(e2_[axis].back()));
        if (edge < infinity) longest_edge_ = std::max(longest_edge_, edge);
    }
    for (const glm::dvec3& corner : {a, b, c}) corners_.emplace_back(corner);
    ++count_;
}

void Oracle::pad() {
    const std::size_t padded = (count_ + block - 1) / block * block;
    for (auto* rows : {v0_, e1_, e2_})
        for (int axis = 0; axis < 3; ++axis) rows[axis].resize(padded, 0.0);  // no edges: never hit
}

OracleHit Oracle::closest_hit(const Ray& ray) const {
    OracleHit hit{ray.tmax, CLARAY_MISS};
    for (std::size_t at = 0; at < v0_[0].size(); at += block) test_block(ray, at, hit);
    return hit;
}

double Oracle::distance(const Ray& ray, std::size_t i) const {
    const double o[3] = {ray.ox, ray.oy, ray.oz}, d[3] = {ray.dx, ray.dy, ray.dz};
    return distance_to(rows_of(v0_, e1_, e2_), i, o, d);
}

void Oracle::test_block(const Ray& ray, std::size_t at, OracleHit& hit) const {
    const double o[3] = {ray.ox, ray.oy, ray.oz}, d[3] = {ray.dx, ray.dy, ray.dz};
    const Rows rows = rows_of(v0_, e1_, e2_);
    double insides[block];
    block_insides(rows, at, o, d, insides);
    for (std::size_t k = 0; k < block; ++k) {
        if (!(insides[k] >= 0)) continue;
        const double t = distance_to(rows, at + k, o, d);
        if (!(t > ray.tmin && t <= ray.tmax && t < infinity)) continue;
        if (t < hit.t || (hit.primitive == CLARAY_MISS && t == hit.t)) hit = {t, std::uint32_t(at + k)};
    }
}

std::vector<OracleHit> Oracle::closest_hits(std::span<const Ray> rays) const {
    constexpr std::size_t together = 64;  // rays that share a block of triangles while it is in the cache
    std::vector<OracleHit> hits(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = {rays[i].tmax, CLARAY_MISS};
    in_parallel((rays.size() + together - 1) / together, [&](std::size_t piece) {
        const std::size_t begin = piece * together, end = std::min(begin + together, rays.size());
        for (std::size_t at = 0; at < v0_[0].size(); at += block)
            for (std::size_t i = begin; i < end; ++i) test_block(rays[i], at, hits[i]);
    });
    return hits;
}

const char* to_string(Fault fault) {
    switch (fault) {
        case Fault::none: return "right";
        case Fault::missed: return "missed a triangle that the ray passes through";
        case Fault::invented: return "hit a triangle that the ray does not meet";
        case Fault::not_nearest: return "hit a triangle that is not the nearest";
        case Fault::bad_distance: return "has a distance off by more than 1 ulp";
    }
    return "";
}

Fault Oracle::judge(const Ray& ray, const Hit& hit) const {
    const double o[3] = {ray.ox, ray.oy, ray.oz}, d[3] = {ray.dx, ray.dy, ray.dz};
    const Rows rows = rows_of(v0_, e1_, e2_);
    const auto place = [&](std::size_t i) {
        return place_of(ray, corners_[3 * i], corners_[3 * i + 1], corners_[3 * i + 2]);
    };
    const auto ulp = [](double t) {
        const auto nearest = float(t);
        return double(std::nextafter(std::fabs(nearest), std::numeric_limits<float>::infinity())) - std::fabs(nearest);
    };
    double t_hit = infinity;
    if (hit.primitive != CLARAY_MISS) {
        if (hit.primitive >= count_ || place(hit.primitive) == Place::outside) return Fault::invented;
        t_hit = distance_to(rows, hit.primitive, o, d);
        if (!(std::fabs(double(hit.t) - t_hit) <= ulp(t_hit))) return Fault::bad_distance;
    }
    // Doubtful cases and all hits of float64 are decided exactly.
    const double size = std::max({std::fabs(d[0]), std::fabs(d[1]), std::fabs(d[2])});
    double insides[block];
    for (std::size_t at = 0; at < v0_[0].size(); at += block) {
        block_insides(rows, at, o, d, insides);
        for (std::size_t k = 0; k < block && at + k < count_; ++k) {
            double from = longest_edge_;
            for (int axis = 0; axis < 3; ++axis) from = std::max(from, std::fabs(o[axis] - v0_[axis][at + k]));
            if (!(insides[k] >= -1e-14 * size * from * longest_edge_) || at + k == hit.primitive) continue;
            const double t = distance_to(rows, at + k, o, d), slack = ulp(t);
            if (!(t > ray.tmin + slack && t < ray.tmax - slack && t + slack < t_hit)) continue;
            if (place(at + k) == Place::inside)
                return hit.primitive == CLARAY_MISS ? Fault::missed : Fault::not_nearest;
        }
    }
    return Fault::none;
}

Oracle::Verdict Oracle::judge(std::span<const Ray> rays, std::span<const Hit> hits) const {
    Verdict verdict;
    verdict.rays = rays.size();
    constexpr std::size_t together = 256;
    std::mutex mutex;
    in_parallel((rays.size() + together - 1) / together, [&](std::size_t piece) {
        for (std::size_t i = piece * together; i < std::min((piece + 1) * together, rays.size()); ++i) {
            const Fault fault = judge(rays[i], hits[i]);
            if (fault == Fault::none) continue;
            const std::lock_guard lock(mutex);
            if (verdict.wrong++ == 0 || i < verdict.first_wrong) verdict.first_wrong = i, verdict.first_fault = fault;
        }
    });
    for (const Hit& hit : hits) verdict.hits += hit.primitive != CLARAY_MISS;
    return verdict;
}

HitComparison compare(std::span<const Hit> hits, std::span<const OracleHit> expected) {
    HitComparison result;
    result.rays = hits.size();
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const bool hit = hits[i].primitive != CLARAY_MISS, expects = expected[i].primitive != CLARAY_MISS;
        result.hits += expects;
        bool right = hit == expects;
        if (right && hit) {
            const auto nearest = float(expected[i].t);
            const double ulp = double(std::nextafter(nearest, std::numeric_limits<float>::infinity())) - nearest;
            const double error = std::fabs(double(hits[i].t) - expected[i].t) / ulp;
            right = error <= 1.0;
            if (right && hits[i].primitive != expected[i].primitive) ++result.ties;
            if (right) result.worst_t_ulp = std::max(result.worst_t_ulp, error);
        }
        if (!right && result.wrong++ == 0) result.first_wrong = i;
    }
    return result;
}

}  // namespace claray::verify
