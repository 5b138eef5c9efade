// The state shared by copies of an InstancedBvh. Internal to host/bvh.
#pragma once

#include <optional>

#include "claray/instances.hpp"
#include "host/bvh/bvh_state.hpp"

namespace claray {

struct InstancedBvh::State {
    /// `by_host`: the top level is not built yet.
    State(std::span<const Bvh> bottoms, const Buffer<Instance>& of, const Buffer<Instance>& to, const Config& with,
          bool by_host = false);

    /// Of all instances; its file has every kernel that places them.
    [[nodiscard]] static KernelRequest placing() { return {"bvh/instances.cl", "place_instances", {}}; }
    /// Of the tree over the instances.
    [[nodiscard]] static Bvh::Config config_of_top(const Config& config);

    void take_bottoms(std::span<const Bvh> bottoms);
    void place();
    void widen_top();
    void build_by_host(std::span<const Instance> begins, std::span<const Instance> motion_ends);
    /// As Bvh::State::set_cutouts. The `id` of an instance must then be the index, in the store, of the first triangle
    /// of its structure. A single bottom level receives the store itself.
    void set_cutouts(const Buffer<std::uint32_t>& store);
    /// Of all buffers; of a shared bottom level without its triangles.
    [[nodiscard]] std::uint64_t bytes() const;
    void bind_bottoms(Kernel& kernel, unsigned& index) const;

    Device device;
    Buffer<Instance> instances, ends;  // ends: not allocated if nothing can move
    Config config;
    Layout layout = Layout::automatic;  // of the bottom levels
    TreeFormat format;

    // The bottom levels: one shared Bvh, or copies of several in common buffers.
    std::optional<Bvh> shared;
    Buffer<BvhHeader> headers;
    Buffer<BvhNode> nodes;
    Buffer<LeafTriangle> leaves;
    Buffer<WideNode> wide_nodes;
    Buffer<TriangleBlock> wide_blocks;
    Buffer<std::uint32_t> cutouts;  // of several bottom levels; a shared one has its own
    std::uint64_t bottom_bytes = 0;

    Buffer<PlacedInstance> placed;
    Buffer<MovingInstance> moving;  // not allocated if nothing can move
    Buffer<float> widening;         // the top level's, until its header holds it
    TriangleBuffers boxes;          // a triangle that spans the box of each instance
    std::optional<Bvh> top;

private:
    void copy_bottoms(std::span<const Bvh> bottoms);

    Kernel place_;
};

/// Places instances and builds the top level without compiling kernels. If `ends` is empty, nothing moves. Throws
/// ErrorKind::usage on a device without float64, since its placements would differ in their bits.
[[nodiscard]] InstancedBvh build_by_host(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                         std::span<const Instance> ends, const InstancedBvh::Config& config);

}  // namespace claray
