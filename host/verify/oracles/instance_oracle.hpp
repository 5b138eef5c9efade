// The oracle of instances: transforms all triangles into the world in float64 and tests them one by one.
#pragma once

#include "claray/shared/instance.h"
#include "host/verify/oracle.hpp"

namespace claray::verify {

/// How a device's hits of instances compare with the oracle's. A ray that a device traces in an object has been
/// rounded: its hits may differ where it passes an edge, or two surfaces, closer than the bound of docs/numerics.md.
struct InstanceComparison {
    std::size_t rays = 0, hits = 0;
    std::size_t marginal = 0;     ///< other hits than the oracle's, within the bound
    std::size_t wrong = 0;        ///< beyond it
    std::size_t first_wrong = 0;  ///< index of a ray, where any is wrong
};

class InstanceOracle {
public:
    /// `bottoms[i]` is the mesh of bottom level i.
    InstanceOracle(std::span<const Mesh> bottoms, std::span<const Instance> instances);

    /// At a time between 0 and 1, on the way from `begins` to `ends`.
    InstanceOracle(std::span<const Mesh> bottoms, std::span<const Instance> begins, std::span<const Instance> ends,
                   double time);

    [[nodiscard]] InstanceComparison compare(std::span<const Ray> rays, std::span<const InstanceHit> hits) const;

private:
    [[nodiscard]] bool agrees(const Ray& ray, const InstanceHit& hit, const OracleHit& expected, bool& marginal) const;
    [[nodiscard]] bool near_edge(const Ray& ray, std::size_t triangle) const;
    [[nodiscard]] double tolerance(const Ray& ray, std::size_t triangle, double t) const;

    std::vector<glm::dvec3> corners_;
    std::vector<std::size_t> first_;   // triangle of each instance
    std::vector<double> error_;        // of each triangle: of a ray in the object, relative to its distances
    std::vector<glm::dvec3> origins_;  // of each triangle's object, in the world
    Oracle oracle_;
};

/// All triangles in the world, instance by instance.
[[nodiscard]] std::vector<glm::dvec3> world_corners(std::span<const Mesh> bottoms, std::span<const Instance> instances);
[[nodiscard]] std::vector<glm::dvec3> world_corners(std::span<const Mesh> bottoms, std::span<const Instance> begins,
                                                    std::span<const Instance> ends, double time);

}  // namespace claray::verify
