#include "claray/instances.hpp"

#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/bvh/host_placement.hpp"
#include "host/bvh/host_tree.hpp"
#include "host/bvh/instances_state.hpp"
#include "host/compute/memory.hpp"

namespace claray {
namespace {

constexpr std::size_t instances_group = 64;  // GROUP_SIZE of bvh/instances.cl

/// Sizes of the parts of a bottom level that rays visit.
struct BottomSize {
    std::size_t nodes = 0, leaves = 0;
};

BottomSize size_of(const Bvh& bvh, const BvhHeader& header) {
    if (bvh.layout() == Layout::wide) return {header.wide_nodes, header.wide_blocks};
    return {state_of(bvh).nodes.size(), state_of(bvh).leaves.size()};
}

void check_bottoms(std::span<const Bvh> bottoms) {
    if (bottoms.empty()) throw Error(ErrorKind::usage, "instances without a bottom level", "pass at least one Bvh");
    for (const Bvh& bvh : bottoms) {
        require_triangles(bvh, "an instance");
        if (bvh.device().context()() != bottoms[0].device().context()())
            throw Error(ErrorKind::usage, "bottom levels of different devices", "build all of them on one Device");
        if (bvh.layout() != bottoms[0].layout())
            throw Error(ErrorKind::usage, "bottom levels of different layouts", "build all of them with one layout");
    }
}

template <class T>
void append(const Device& device, const Buffer<T>& from, Buffer<T>& to, std::size_t at, std::size_t count) {
    if (count != 0) detail::copy(device, from.memory(), to.memory(), count * sizeof(T), at * sizeof(T));
}

}  // namespace

Instance make_instance(const glm::mat4& m, std::uint32_t bottom, std::uint32_t mask, std::uint32_t id) {
    Instance instance{};
    for (int k = 0; k < 4; ++k) instance.row0[k] = m[k].x, instance.row1[k] = m[k].y, instance.row2[k] = m[k].z;
    instance.bottom = bottom;
    instance.mask = mask;
    instance.id = id;
    return instance;
}

InstancedBvh::State::State(std::span<const Bvh> bottoms, const Buffer<Instance>& of, const Buffer<Instance>& to,
                           const Config& with, bool by_host)
    : device((check_bottoms(bottoms), bottoms[0].device())), instances(of), ends(to), config(with) {
    const std::size_t count = of.size();
    if (to.allocated() && to.size() != count)
        throw Error(ErrorKind::usage,
                    std::to_string(count) + " instances, but " + std::to_string(to.size()) + " ends of their motion",
                    "pass one end per instance; for an instance that does not move, repeat its transform");
    if (count >= CLARAY_SLOT)
        throw Error(ErrorKind::user, "too many instances: " + std::to_string(count) + ", the limit is 2^29 - 2");
    take_bottoms(bottoms);
    placed = Buffer<PlacedInstance>(device, count);
    if (ends.allocated()) moving = Buffer<MovingInstance>(device, count);
    widening = Buffer<float>(device, 1);
    if (by_host) return;
    boxes.positions = Buffer<float>(device, 9 * count);
    boxes.indices = Buffer<std::uint32_t>(device, 3 * count);
    load_kernel(device, "bvh/instances.cl", "number_corners")
        .run({3 * count, 256}, boxes.indices, std::uint32_t(3 * count));
    place();
    top = Bvh::build(device, boxes, config_of_top(config));
    widen_top();
}

Bvh::Config InstancedBvh::State::config_of_top(const Config& config) {
    return {.builder = config.builder,
            .morton_bits = config.morton_bits,
            .layout = Layout::binary,
            .max_leaf_triangles = 1};  // one per leaf
}

void InstancedBvh::State::build_by_host(std::span<const Instance> begins, std::span<const Instance> motion_ends) {
    const HostPlacement placement = place_by_host(begins, motion_ends, headers.read());
    placed.write(placement.placed);
    if (moving.allocated()) moving.write(placement.moving);
    widening.write(std::span(&placement.widening, 1));
    top = claray::build_by_host(device, std::span(&placement.boxes, 1), config_of_top(config));
    boxes = top->triangles();
    widen_top();
}

/// Writes the widening to the top level's header, which the builder has cleared.
void InstancedBvh::State::widen_top() {
    detail::copy(device, widening.memory(), state_of(*top).header.memory(), sizeof(float),
                 offsetof(BvhHeader, widening));
}

void InstancedBvh::State::take_bottoms(std::span<const Bvh> bottoms) {
    check_bottoms(bottoms);
    layout = bottoms[0].layout();
    format = format_of(bottoms[0]);
    if (bottoms.size() > 1) format.cutouts = false;  // copies have no own cut-outs
    format.moves = ends.allocated();
    nodes = {}, leaves = {}, wide_nodes = {}, wide_blocks = {};
    if (bottoms.size() > 1) {
        shared.reset();
        copy_bottoms(bottoms);
        return;
    }
    shared = bottoms[0];
    headers = state_of(*shared).header;
    bottom_bytes = state_of(*shared).tree_bytes(state_of(*shared).read_header());
}

void InstancedBvh::State::copy_bottoms(std::span<const Bvh> bottoms) {
    std::vector<BvhHeader> host_headers;
    BottomSize all;
    for (const Bvh& bvh : bottoms) {
        host_headers.push_back(state_of(bvh).read_header());
        BvhHeader& header = host_headers.back();
        header.first_node = std::uint32_t(all.nodes), header.first_leaf = std::uint32_t(all.leaves);
        const BottomSize size = size_of(bvh, header);
        all = {all.nodes + size.nodes, all.leaves + size.leaves};
    }
    if (std::max(all.nodes, all.leaves) > 0xffffffffu)
        throw Error(ErrorKind::user, "the bottom levels have 2^32 or more nodes or leaves in total");
    headers = Buffer<BvhHeader>(device, host_headers);
    const bool wide = layout == Layout::wide;
    if (wide) {
        wide_nodes = Buffer<WideNode>(device, all.nodes);
        wide_blocks = Buffer<TriangleBlock>(device, all.leaves);
    } else {
        nodes = Buffer<BvhNode>(device, all.nodes);
        leaves = Buffer<LeafTriangle>(device, all.leaves);
    }
    bottom_bytes = headers.bytes() + wide_nodes.bytes() + wide_blocks.bytes() + nodes.bytes() + leaves.bytes();
    for (std::size_t i = 0; i < bottoms.size(); ++i) {
        const BottomSize size = size_of(bottoms[i], host_headers[i]);
        const BvhHeader& at = host_headers[i];
        if (wide) {
            append(device, state_of(bottoms[i]).wide_nodes, wide_nodes, at.first_node, size.nodes);
            append(device, state_of(bottoms[i]).wide_blocks, wide_blocks, at.first_leaf, size.leaves);
        } else {
            append(device, state_of(bottoms[i]).nodes, nodes, at.first_node, size.nodes);
            append(device, state_of(bottoms[i]).leaves, leaves, at.first_leaf, size.leaves);
        }
    }
}

std::uint64_t InstancedBvh::State::bytes() const {
    return buffer_bytes(instances, ends, nodes, leaves, wide_nodes, wide_blocks, placed, moving, widening) +
           buffer_bytes(boxes.positions, boxes.indices) + (shared ? state_of(*shared).bytes() : headers.bytes()) +
           (top ? state_of(*top).bytes() : 0);
}

void InstancedBvh::State::place() {
    if (!place_.handle()()) place_ = load_kernel(device, placing());
    widening.fill(0);
    const std::size_t count = instances.size();
    place_.run({count, instances_group}, arg("instances", instances), arg("ends", ends), std::uint32_t(count), headers,
               std::uint32_t(headers.size()), placed, moving, boxes.positions, widening.memory());
}

InstancedBvh InstancedBvh::build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances,
                                 const Config& config) {
    return build(bottoms, instances, Buffer<Instance>(), config);
}

InstancedBvh InstancedBvh::build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances,
                                 const Buffer<Instance>& ends, const Config& config) {
    InstancedBvh bvh;
    bvh.state_ = std::make_shared<State>(bottoms, instances, ends, config);
    return bvh;
}

InstancedBvh InstancedBvh::build(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                 const Config& config) {
    check_bottoms(bottoms);
    return build(bottoms, Buffer<Instance>(bottoms[0].device(), instances), config);
}

InstancedBvh InstancedBvh::build(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                 std::span<const Instance> ends, const Config& config) {
    check_bottoms(bottoms);
    const Device& device = bottoms[0].device();
    return build(bottoms, Buffer<Instance>(device, instances), Buffer<Instance>(device, ends), config);
}

InstancedBvh build_by_host(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                           std::span<const Instance> ends, const InstancedBvh::Config& config) {
    check_bottoms(bottoms);
    const Device& device = bottoms[0].device();
    if (!device.info().fp64)
        throw Error(ErrorKind::usage,
                    "instances cannot be placed by the host for a device without float64, since results differ",
                    "use InstancedBvh::build");
    const Buffer<Instance> end_buffer = ends.empty() ? Buffer<Instance>() : Buffer<Instance>(device, ends);
    auto state =
        std::make_shared<InstancedBvh::State>(bottoms, Buffer<Instance>(device, instances), end_buffer, config, true);
    state->build_by_host(instances, ends);
    return handle_of<InstancedBvh>(std::move(state));
}

void InstancedBvh::rebuild() {
    state_->place();
    state_->top->rebuild();
    state_->widen_top();
}

void InstancedBvh::refit() {
    state_->place();
    state_->top->refit();
    state_->widen_top();
}

void InstancedBvh::replace_bottoms(std::span<const Bvh> bottoms) { state_->take_bottoms(bottoms); }

const Buffer<Instance>& InstancedBvh::instances() const { return state_->instances; }
const Buffer<Instance>& InstancedBvh::ends() const { return state_->ends; }
std::size_t InstancedBvh::instance_count() const { return state_->instances.size(); }
Layout InstancedBvh::layout() const { return state_->layout; }
const Device& InstancedBvh::device() const { return state_->device; }
const Bvh& InstancedBvh::top() const { return *state_->top; }
BvhValidation InstancedBvh::validate() const { return state_->top->validate(); }
Defines InstancedBvh::defines() const { return state_->format.defines(); }

InstanceStatistics InstancedBvh::statistics() const {
    const BvhStatistics top = state_->top->statistics();
    InstanceStatistics statistics;
    statistics.instances = top.triangles;
    statistics.culled = top.culled;
    statistics.height = top.height;
    statistics.sah_cost = top.sah_cost;
    statistics.widening = state_->widening.read()[0];
    statistics.top_bytes =
        top.bytes + state_->instances.bytes() + state_->ends.bytes() + state_->placed.bytes() + state_->moving.bytes();
    statistics.bottom_bytes = state_->bottom_bytes;
    return statistics;
}

void InstancedBvh::bind(Kernel& kernel, unsigned& index) const {
    kernel.require(defines());
    const Bvh& top = *state_->top;
    kernel.set(index, arg("claray_top", state_of(top).header));
    kernel.set(index, arg("claray_top_nodes", state_of(top).nodes));
    kernel.set(index, arg("claray_top_leaves", state_of(top).leaves));
    kernel.set(index, state_->placed);
    state_->bind_bottoms(kernel, index);
    if (state_->moving.allocated()) kernel.set(index, state_->moving);
}

void InstancedBvh::State::set_cutouts(const Buffer<std::uint32_t>& store) {
    if (shared)
        state_of(*shared).set_cutouts(store);
    else
        cutouts = store;
    format.cutouts = store.allocated();
}

void InstancedBvh::State::bind_bottoms(Kernel& kernel, unsigned& index) const {
    if (shared) {
        kernel.set(index, *shared);
        return;
    }
    kernel.set(index, arg("claray_header", headers));
    const bool wide = layout == Layout::wide;
    wide ? kernel.set(index, wide_nodes) : kernel.set(index, arg("claray_nodes", nodes));
    wide ? kernel.set(index, wide_blocks) : kernel.set(index, arg("claray_triangles", leaves));
    if (cutouts.allocated()) kernel.set(index, arg("claray_cutouts", cutouts));
}

}  // namespace claray
