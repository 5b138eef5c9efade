#include "host/bvh/saved_tree.hpp"

#include <algorithm>
#include <cmath>

namespace claray {
namespace {

bool is_leaf(std::uint32_t child) { return (child & CLARAY_LEAF) != 0; }

std::uint32_t height_of(std::uint32_t height_count) { return height_count >> 24; }

std::string numbered(const char* what, std::size_t number) { return what + (" " + std::to_string(number)); }

}  // namespace

SavedTree::SavedTree(std::size_t nodes, std::size_t leaves, std::size_t geometries) {
    nodes_.reserve(nodes), leaves_.reserve(leaves), geometries_.reserve(geometries);
}

void SavedTree::add(std::span<const BvhNode> nodes) {
    for (const BvhNode& n : nodes) nodes_.push_back({{n.child0, n.child1}, n.parent, n.height_count});
}

void SavedTree::add(std::span<const LeafTriangle> leaves) {
    for (const LeafTriangle& leaf : leaves) leaves_.push_back({leaf.primitive, leaf.geometry, leaf.mask});
}

void SavedTree::add_indices(std::span<const std::uint32_t> indices) {
    for (const std::uint32_t index : indices) largest_index_ = std::max(largest_index_, index);
}

void SavedTree::add_geometries(std::span<const std::uint32_t> geometries) {
    geometries_.insert(geometries_.end(), geometries.begin(), geometries.end());
}

void SavedTree::add_masks(std::span<const std::uint32_t> masks) {
    masks_.insert(masks_.end(), masks.begin(), masks.end());
}

/// The part of the tree that was checked so far.
struct SavedTree::Walk {
    std::uint32_t most_in_leaf;
    std::vector<bool> slots;                                       // slots that a leaf holds
    std::size_t used = 0, links = 0;                               // nodes in use, and references to nodes
    std::size_t held = 0;                                          // number of slots that leaves hold
    std::uint32_t index = CLARAY_NO_CHILD, height = 0, count = 0;  // the current node, and the subtree below it
};

std::string SavedTree::fault(const BvhHeader& header, const Counts& counts) const {
    for (const std::string& fault : {fault_of_header(header, counts), fault_of_triangles(counts)})
        if (!fault.empty()) return fault;
    const std::string fault = fault_of_nodes(header, counts);
    return fault.empty() ? fault_of_leaves(header, counts) : fault;
}

std::string SavedTree::fault_of_header(const BvhHeader& h, const Counts& counts) const {
    if (h.inner_nodes > nodes_.size() || h.valid > leaves_.size())
        return "its header counts more nodes than the file contains";
    const std::uint64_t listed = std::uint64_t(h.valid) + h.culled;
    if (h.culled > counts.triangles || (counts.splits ? listed < counts.triangles : listed != counts.triangles))
        return "its tree and its mesh differ in the number of triangles";
    if ((h.valid == 0) != (h.root == CLARAY_NO_CHILD)) return "its root is missing";
    if (h.height > CLARAY_MAX_HEIGHT) return "its tree is higher than " + std::to_string(CLARAY_MAX_HEIGHT) + " levels";
    if (h.valid == 0) return {};
    const float lo[] = {h.lox, h.loy, h.loz}, hi[] = {h.hix, h.hiy, h.hiz};
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(lo[axis]) || !std::isfinite(hi[axis]) || lo[axis] > hi[axis]) return "it has no bounds";
    return {};
}

std::string SavedTree::fault_of_triangles(const Counts& counts) const {
    if (counts.triangles != 0 && largest_index_ >= counts.vertices) return numbered("missing vertex", largest_index_);
    if (masks_.empty()) return {};
    const auto largest = std::max_element(geometries_.begin(), geometries_.end());
    const std::uint32_t geometry = largest == geometries_.end() ? 0 : *largest;
    return geometry < masks_.size() ? "" : numbered("missing mask of geometry", geometry);
}

/// A node has one parent, so that no node is the child of two; and a child is lower than its parent, so that there are
/// no cycles.
std::string SavedTree::fault_of_child(const BvhHeader& header, std::uint32_t child, Walk& walk) const {
    if (!is_leaf(child)) {
        if (child >= header.inner_nodes || nodes_[child].free()) return numbered("missing node", child);
        if (nodes_[child].parent != walk.index) return numbered("wrong parent of node", child);
        ++walk.links;
        walk.height = std::max(walk.height, height_of(nodes_[child].height_count));
        walk.count += nodes_[child].height_count & CLARAY_COUNT_LIMIT;
        return {};
    }
    const std::uint32_t first = child & CLARAY_SLOT, count = CLARAY_LEAF_COUNT(child);
    if (count > walk.most_in_leaf || first + count > header.valid) return numbered("invalid leaf", child);
    for (std::uint32_t slot = first; slot < first + count; ++slot) {
        if (walk.slots[slot]) return numbered("several leaves contain triangle", slot);
        walk.slots[slot] = true;
    }
    walk.held += count;
    walk.count += count;
    return {};
}

std::string SavedTree::fault_of_node(const BvhHeader& header, std::uint32_t index, Walk& walk) const {
    const Links& node = nodes_[index];
    walk.index = index, walk.height = walk.count = 0;
    ++walk.used;
    for (const std::uint32_t child : node.child)
        if (const std::string fault = fault_of_child(header, child, walk); !fault.empty()) return fault;
    const std::uint32_t count = std::min(walk.count, CLARAY_COUNT_LIMIT);
    if (node.height_count != ((walk.height + 1) << 24 | count)) return numbered("wrong height or count in node", index);
    if (walk.height >= CLARAY_MAX_HEIGHT) return numbered("the tree is too high below node", index);
    if ((node.parent == CLARAY_NO_CHILD) != (index == header.root)) return numbered("missing parent of node", index);
    return {};
}

/// Each node in use has one parent or is the root, and there are as many references as such nodes: so all are reached.
std::string SavedTree::fault_of_nodes(const BvhHeader& header, const Counts& counts) const {
    Walk walk{.most_in_leaf = counts.most_in_leaf, .slots = std::vector<bool>(header.valid)};
    if (header.valid == 0) return header.inner_nodes == 0 ? "" : "nodes without triangles";
    if (is_leaf(header.root)) {
        if (const std::string fault = fault_of_child(header, header.root, walk); !fault.empty()) return fault;
    } else if (header.root >= header.inner_nodes || nodes_[header.root].free()) {
        return "its root is missing";
    }
    for (std::uint32_t index = 0; index < header.inner_nodes; ++index)
        if (!nodes_[index].free())
            if (const std::string fault = fault_of_node(header, index, walk); !fault.empty()) return fault;
    const bool rooted = !is_leaf(header.root);
    if (walk.links + (rooted ? 1 : 0) != walk.used) return "some of its nodes are not in the tree";
    if (walk.held != header.valid) return "some of its triangles are in no leaf";
    if (header.height != (rooted ? height_of(nodes_[header.root].height_count) : 0)) return "its height is wrong";
    return {};
}

std::string SavedTree::fault_of_leaves(const BvhHeader& header, const Counts& counts) const {
    for (std::uint32_t slot = 0; slot < header.valid; ++slot) {
        const Leaf& leaf = leaves_[slot];
        if (leaf.primitive >= counts.triangles) return numbered("missing triangle", leaf.primitive);
        if (leaf.geometry != geometry_of(leaf.primitive) || leaf.mask != mask_of(leaf.geometry))
            return numbered("wrong geometry or mask in leaf", slot);
    }
    return {};
}

std::uint32_t SavedTree::geometry_of(std::uint32_t primitive) const {
    return geometries_.empty() ? 0 : geometries_[primitive];
}
std::uint32_t SavedTree::mask_of(std::uint32_t geometry) const {
    return masks_.empty() ? 0xffffffffu : masks_[geometry];
}

}  // namespace claray
