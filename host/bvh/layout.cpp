#include "host/bvh/layout.hpp"

namespace claray {
namespace {

constexpr const char* layout_file = "bvh/layout.cl";
constexpr std::size_t layout_group = 64;
constexpr std::size_t words_per_subtree = 9;

}  // namespace

TreeLayout::TreeLayout(const Device& device, std::uint32_t capacity, unsigned max_leaf)
    : subtrees_(device, words_per_subtree * capacity) {
    load(device, kernels(max_leaf), *this);
}

KernelsOf<TreeLayout> TreeLayout::kernels(unsigned max_leaf) {
    const Defines defines = {{"MAX_LEAF", std::to_string(max_leaf) + "u"}};
    return {{&TreeLayout::measure_, {layout_file, "measure_subtrees", defines}},
            {&TreeLayout::copy_, {layout_file, "copy_tree", defines}},
            {&TreeLayout::finish_, {layout_file, "finish_copy", defines}}};
}

void TreeLayout::copy(const TriangleBuffers& triangles, const Buffer<BvhNode>& nodes,
                      const Buffer<LeafTriangle>& leaves, std::uint32_t leaf_count, Buffer<std::uint32_t>& arrivals,
                      const Buffer<BvhHeader>& header, const Buffer<BvhNode>& new_nodes,
                      const Buffer<LeafTriangle>& new_leaves) {
    if (leaf_count == 0) return;
    arrivals.fill(0);
    measure_.run({leaf_count, layout_group}, nodes, leaves, subtrees_.memory(), arrivals, header);
    copy_.run({leaf_count, layout_group}, arg("nodes", nodes), arg("leaves", leaves), subtrees_.memory(), header,
              triangles.positions, arg("indices", triangles.indices), arg("geometries", triangles.geometries),
              arg("masks", triangles.masks), arg("new_nodes", new_nodes), arg("new_leaves", new_leaves));
    finish_.run({1, 1}, nodes, subtrees_.memory(), header);
}

}  // namespace claray
