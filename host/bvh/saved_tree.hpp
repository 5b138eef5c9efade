// Checks that a saved tree can be traversed, refitted and rebuilt: a file with right checksums may still be forged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "claray/shared/bvh_node.h"

namespace claray {

/// The indices, counts and depths in the arrays of a saved tree. They are collected piece by piece while the arrays are
/// uploaded.
class SavedTree {
public:
    /// Allocates memory for this many.
    SavedTree(std::size_t nodes, std::size_t leaves, std::size_t geometries);

    void add(std::span<const BvhNode> nodes);
    void add(std::span<const LeafTriangle> leaves);
    void add_indices(std::span<const std::uint32_t> indices);
    void add_geometries(std::span<const std::uint32_t> geometries);
    void add_masks(std::span<const std::uint32_t> masks);

    struct Counts {
        std::uint32_t triangles = 0;
        std::uint64_t vertices = 0;
        std::uint32_t most_in_leaf = 1;
        bool splits = false;  ///< a triangle may be in several leaves
    };
    /// Returns the first fault in words, or nothing: then no two references lead to the same node or leaf, all of them
    /// are reached from the root, no path is longer than a traversal's stack, and every index exists. Boxes and
    /// coordinates are not checked: wrong ones only give wrong hits. The time is linear in the size of the tree.
    [[nodiscard]] std::string fault(const BvhHeader& header, const Counts& counts) const;

private:
    struct Links {
        std::uint32_t child[2], parent, height_count;
        [[nodiscard]] bool free() const { return child[0] == CLARAY_NO_CHILD; }
    };
    struct Leaf {
        std::uint32_t primitive, geometry, mask;
    };
    struct Walk;

    [[nodiscard]] std::string fault_of_header(const BvhHeader& header, const Counts& counts) const;
    [[nodiscard]] std::string fault_of_node(const BvhHeader& header, std::uint32_t index, Walk& walk) const;
    [[nodiscard]] std::string fault_of_child(const BvhHeader& header, std::uint32_t child, Walk& walk) const;
    [[nodiscard]] std::string fault_of_nodes(const BvhHeader& header, const Counts& counts) const;
    [[nodiscard]] std::string fault_of_leaves(const BvhHeader& header, const Counts& counts) const;
    [[nodiscard]] std::string fault_of_triangles(const Counts& counts) const;
    [[nodiscard]] std::uint32_t geometry_of(std::uint32_t primitive) const;
    [[nodiscard]] std::uint32_t mask_of(std::uint32_t geometry) const;

    std::vector<Links> nodes_;
    std::vector<Leaf> leaves_;
    std::vector<std::uint32_t> geometries_, masks_;
    std::uint32_t largest_index_ = 0;
};

}  // namespace claray
