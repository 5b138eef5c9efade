// The oracles of nearest points and of overlaps: every triangle, in 80-bit arithmetic.
#pragma once

#include <span>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/types.h"

namespace claray::verify {

class NearestOracle {
public:
    explicit NearestOracle(const Mesh& mesh) : mesh_(mesh) {}

    /// The distance to triangle i. Culled triangles (two equal vertices, not finite) are infinitely far.
    [[nodiscard]] long double distance(const glm::vec3& point, std::size_t i) const;
    /// The bound of claray/query/points.hpp on the error of that distance, before it is rounded to float32.
    [[nodiscard]] long double error(const glm::vec3& point, std::size_t i) const;

    /// Empty if the answer is right, else what is wrong: the distance, the triangle, a lower triangle at the same
    /// distance, or the point.
    [[nodiscard]] const char* judge(const glm::vec3& point, const NearestPoint& answer, float reach) const;

private:
    const Mesh& mesh_;
};

/// Whether triangle i and the box share a point, by clipping in 80-bit arithmetic.
[[nodiscard]] bool overlaps(const Mesh& mesh, std::size_t i, const Bounds& box);

}  // namespace claray::verify
