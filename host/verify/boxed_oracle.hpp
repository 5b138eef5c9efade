// The oracle for many rays: blocks of triangles are skipped by boxes that are larger than needed. It shares nothing
// with claray's own trees: halves of equal counts, padded boxes in float64. `Oracle` remains the reference, which tests
// every triangle.
#pragma once

#include <optional>

#include "host/verify/oracle.hpp"

namespace claray::verify {

class BoxedOracle {
public:
    explicit BoxedOracle(std::span<const Mesh> meshes);

    /// As Oracle::closest_hits, on all cores; of equal hits any.
    [[nodiscard]] std::vector<OracleHit> closest_hits(std::span<const Ray> rays) const;

private:
    /// A range of triangles; its halves follow, the first one directly.
    struct Node {
        glm::dvec3 lo, hi;
        std::uint32_t begin, end, second_half;  // second_half: 0 for a single block
    };
    struct Corners {
        glm::dvec3 at[3];
    };
    std::size_t add_node(std::span<const Corners> triangles, std::size_t begin, std::size_t end);
    /// Entry of a ray into a node's padded box; infinite if it is not met before `limit`.
    [[nodiscard]] double entry(const Node& node, const Ray& ray, double limit) const;
    void search(std::size_t node, const Ray& ray, OracleHit& hit) const;

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> numbers_;  // of triangles, in the order of the nodes
    std::optional<Oracle> oracle_;        // of the triangles in this order
    double size_ = 0;                     // the largest coordinate
};

}  // namespace claray::verify
