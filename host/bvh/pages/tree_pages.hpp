// Trees whose arrays can leave the device, so that several trees share its memory.
#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "claray/instances.hpp"

namespace claray {

/// Replaces the numbers of a tree's triangles, which its hits report as primitives, by numbers[primitive]. Blocks.
void renumber_triangles(Bvh& bvh, std::span<const std::uint32_t> numbers);

/// An array of a tree.
template <class T>
struct TreePage {
    Buffer<T>* buffer = nullptr;
    std::size_t count = 0;  // elements that the tree uses
    std::vector<T> host = {};
};

/// The nodes and leaves of a tree: of a Bvh, or of the bottom levels of an InstancedBvh. They are on the device, or in
/// host memory only.
class TreePages {
public:
    TreePages() = default;
    /// The tree can only be traversed from now on: what is needed for rebuilding is freed.
    explicit TreePages(const Bvh& bvh);
    explicit TreePages(const InstancedBvh& instanced);

    [[nodiscard]] std::uint64_t bytes() const;
    [[nodiscard]] bool on_device() const { return on_device_; }
    /// Copies the arrays to the device. Blocks. Throws ErrorKind::device if there is too little memory.
    void page_in();
    /// Frees the arrays on the device; the first time they are copied to the host before. Blocks.
    void page_out();

private:
    template <class State>
    void take(State& of, std::size_t nodes, std::size_t leaves);

    std::optional<Bvh> bvh_;  // of which the pages are
    std::optional<InstancedBvh> instanced_;
    std::tuple<TreePage<BvhNode>, TreePage<LeafTriangle>, TreePage<WideNode>, TreePage<TriangleBlock>> pages_;
    bool on_device_ = false, on_host_ = false;
};

}  // namespace claray
