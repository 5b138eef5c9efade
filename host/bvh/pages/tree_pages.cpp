#include "host/bvh/pages/tree_pages.hpp"

#include "host/bvh/bvh_state.hpp"
#include "host/bvh/instances_state.hpp"

namespace claray {

void renumber_triangles(Bvh& bvh, std::span<const std::uint32_t> numbers) {
    Bvh::State& state = state_of(bvh);
    state.stop_learning();
    const BvhHeader header = state.read_header();
    if (state.layout == Layout::binary) {
        std::vector<LeafTriangle> leaves(header.valid);
        state.leaves.read(std::span(leaves));
        for (LeafTriangle& leaf : leaves) leaf.primitive = numbers[leaf.primitive];
        state.leaves.write(std::span<const LeafTriangle>(leaves));
        return;
    }
    std::vector<TriangleBlock> blocks(header.wide_blocks);
    state.wide_blocks.read(std::span(blocks));
    for (TriangleBlock& block : blocks)
        for (auto& primitive : block.primitive)  // lanes beyond the leaf's count hold anything
            primitive = primitive < numbers.size() ? numbers[primitive] : CLARAY_MISS;
    state.wide_blocks.write(std::span<const TriangleBlock>(blocks));
}

template <class State>
void TreePages::take(State& of, std::size_t nodes, std::size_t leaves) {
    const bool wide = of.layout == Layout::wide;
    pages_ = {TreePage<BvhNode>{&of.nodes, wide ? 0 : nodes}, TreePage<LeafTriangle>{&of.leaves, wide ? 0 : leaves},
              TreePage<WideNode>{&of.wide_nodes, wide ? nodes : 0},
              TreePage<TriangleBlock>{&of.wide_blocks, wide ? leaves : 0}};
    on_device_ = true;
}

TreePages::TreePages(const Bvh& bvh) : bvh_(bvh) {
    Bvh::State& state = state_of(*bvh_);
    const BvhHeader header = state.read_header();
    state.keep_tree_only();
    if (state.layout == Layout::wide)
        take(state, header.wide_nodes, header.wide_blocks);
    else
        take(state, header.inner_nodes, header.valid);
}

TreePages::TreePages(const InstancedBvh& instanced) : instanced_(instanced) {
    InstancedBvh::State& state = state_of(*instanced_);
    if (state.shared) {
        *this = TreePages(*state.shared);
        instanced_ = instanced;
    } else if (state.layout == Layout::wide) {
        take(state, state.wide_nodes.size(), state.wide_blocks.size());
    } else {
        take(state, state.nodes.size(), state.leaves.size());
    }
}

std::uint64_t TreePages::bytes() const {
    std::uint64_t bytes = 0;
    const auto add = [&](const auto& page) { bytes += page.count * sizeof(page.host[0]); };
    std::apply([&](const auto&... pages) { (add(pages), ...); }, pages_);
    return bytes;
}

void TreePages::page_in() {
    if (on_device_) return;
    const Device device = bvh_ ? bvh_->device() : instanced_->device();
    const auto copy = [&](auto& page) {
        if (page.count > 0) *page.buffer = {device, page.host};
    };
    std::apply([&](auto&... pages) { (copy(pages), ...); }, pages_);
    on_device_ = true;
}

void TreePages::page_out() {
    if (!on_device_) return;
    const auto free = [&](auto& page) {
        if (page.count > 0 && !on_host_) {
            page.host.resize(page.count);
            page.buffer->read(std::span(page.host));
        }
        *page.buffer = {};
    };
    std::apply([&](auto&... pages) { (free(pages), ...); }, pages_);
    on_host_ = true, on_device_ = false;
}

}  // namespace claray
