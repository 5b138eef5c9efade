// The oracle: every ray against every triangle in float64 on the host. Shares the structs with the kernels and nothing
// else: another test (Moeller and Trumbore 1997), another precision, another order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/types.h"

namespace claray::verify {

struct OracleHit {
    double t = 0;
    std::uint32_t primitive = CLARAY_MISS;
};

/// The error of a hit.
enum class Fault { none, missed, invented, not_nearest, bad_distance };
[[nodiscard]] const char* to_string(Fault fault);

/// Triangles of all meshes in order, ready for testing.
class Oracle {
public:
    explicit Oracle(std::span<const Mesh> meshes);
    /// Three corners a triangle.
    explicit Oracle(std::span<const glm::dvec3> corners);

    /// The nearest hit at tmin < t <= tmax; of equal ones the first triangle.
    [[nodiscard]] OracleHit closest_hit(const Ray& ray) const;
    [[nodiscard]] std::vector<OracleHit> closest_hits(std::span<const Ray> rays) const;  ///< on all cores
    static constexpr std::size_t block = 64;  ///< triangles that are tested together
    /// Updates the nearest hit by the triangles of the block from `at`, a multiple of `block`, on.
    void test_block(const Ray& ray, std::size_t at, OracleHit& hit) const;
    [[nodiscard]] std::size_t triangles() const { return count_; }
    /// From the ray's origin to the plane of triangle i; infinite where the plane holds the ray.
    [[nodiscard]] double distance(const Ray& ray, std::size_t i) const;

    /// Compares a hit with exact arithmetic. A ray through the inside of a triangle must hit it or something nearer.
    /// For a ray exactly through a border both answers are right. The reported triangle must be hit at its exact
    /// distance to within 1 ulp, and nothing before it. Triangles must have float32 vertices.
    [[nodiscard]] Fault judge(const Ray& ray, const Hit& hit) const;
    struct Verdict {
        std::size_t rays = 0, hits = 0, wrong = 0, first_wrong = 0;
        Fault first_fault = Fault::none;
    };
    [[nodiscard]] Verdict judge(std::span<const Ray> rays, std::span<const Hit> hits) const;  ///< on all cores

private:
    void add(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
    void pad();

    std::size_t count_ = 0;
    double longest_edge_ = 0;
    std::vector<glm::vec3> corners_;             // three a triangle, for exact arithmetic
    std::vector<double> v0_[3], e1_[3], e2_[3];  // padded to whole blocks
};

/// How a device's hits compare with the oracle's.
struct HitComparison {
    std::size_t rays = 0, hits = 0;
    std::size_t ties = 0;         ///< another primitive at a distance within 1 ulp of the nearest: allowed
    std::size_t wrong = 0;        ///< missed, false, or with another primitive or distance
    double worst_t_ulp = 0;       ///< largest error of t over the agreeing hits, in units in the last place
    std::size_t first_wrong = 0;  ///< index of a ray, if any is wrong
};

[[nodiscard]] HitComparison compare(std::span<const Hit> hits, std::span<const OracleHit> expected);

}  // namespace claray::verify
