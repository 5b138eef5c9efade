#include "claray/bvh.hpp"

#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/bvh/host_tree.hpp"
#include "host/bvh/require_memory.hpp"
#include "host/compute/programs/program_cache.hpp"

namespace claray {
namespace {

void check_indices(const Mesh& mesh, std::size_t geometry) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::uvec3 t = mesh.triangles[i];
        const std::uint32_t largest = std::max({t.x, t.y, t.z});
        if (largest < mesh.positions.size()) continue;
        throw Error(ErrorKind::user, "mesh " + std::to_string(geometry) + " '" + mesh.name + "', triangle " +
                                         std::to_string(i) + ": vertex " + std::to_string(largest) + " of " +
                                         std::to_string(mesh.positions.size()) + " does not exist");
    }
}

/// Joins the vertices and triangles of all meshes in buffers of their counts.
void write(std::span<const Mesh> meshes, TriangleBuffers& buffers) {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices, geometries, masks;
    for (std::size_t geometry = 0; geometry < meshes.size(); ++geometry) {
        const Mesh& mesh = meshes[geometry];
        const auto base = std::uint32_t(positions.size() / 3);
        for (const glm::vec3& p : mesh.positions) positions.insert(positions.end(), {p.x, p.y, p.z});
        for (const glm::uvec3& t : mesh.triangles) indices.insert(indices.end(), {base + t.x, base + t.y, base + t.z});
        geometries.resize(indices.size() / 3, std::uint32_t(geometry));
        masks.push_back(mesh.mask);
    }
    buffers.positions.write(positions);
    buffers.indices.write(indices);
    if (buffers.geometries.allocated()) buffers.geometries.write(geometries);
    if (buffers.masks.allocated()) buffers.masks.write(masks);
}

TriangleBuffers upload(const Device& device, std::span<const Mesh> meshes) {
    for (std::size_t geometry = 0; geometry < meshes.size(); ++geometry) check_indices(meshes[geometry], geometry);
    TriangleBuffers buffers = allocate_triangles(device, counts_of(meshes));
    write(meshes, buffers);
    return buffers;
}

template <class T>
void append_bytes(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

Bvh Bvh::build(const Device& device, std::span<const Mesh> meshes, const Config& config) {
    for (std::size_t geometry = 0; geometry < meshes.size(); ++geometry) check_indices(meshes[geometry], geometry);
    const TriangleCounts counts = counts_of(meshes);
    require_memory(device, counts, config);
    TriangleBuffers triangles;
    Bvh bvh;
    commit_memory(device, counts, config, [&] {
        triangles = allocate_triangles(device, counts);
        bvh.state_ = std::make_shared<State>(device, triangles, config);
    });
    write(meshes, triangles);
    bvh.state_->build();
    return bvh;
}

Bvh Bvh::build(const Device& device, const TriangleBuffers& triangles, const Config& config) {
    require_memory(device, triangles, config);
    Bvh bvh;
    commit_memory(device, counts_of(triangles), config,
                  [&] { bvh.state_ = std::make_shared<State>(device, triangles, config); });
    bvh.state_->build();
    return bvh;
}

Bvh build_over_primitives(const Device& device, const TriangleBuffers& corners, const Bvh::Config& config,
                          bool capsules) {
    require_memory(device, corners, config);
    auto state =
        std::make_shared<Bvh::State>(device, corners, config, false, capsules ? LeafShape::capsule : LeafShape::box);
    state->build();
    return handle_of<Bvh>(std::move(state));
}

void require_triangles(const Bvh& bvh, const std::string& user) {
    if (state_of(bvh).leaf_shape == LeafShape::triangle) return;
    throw Error(
        ErrorKind::usage,
        user + " needs a tree of triangles, not that of Primitives::bvh(), whose leaves are boxes of primitives",
        "call closest_hit or any_hit of the Primitives, or build a Bvh of a mesh");
}

Bvh without_owning(const Bvh& bvh) {
    return handle_of<Bvh>(std::shared_ptr<Bvh::State>(std::shared_ptr<Bvh::State>(), &state_of(bvh)));
}

Bvh build_by_host(const Device& device, std::span<const Mesh> meshes, const Bvh::Config& with) {
    Bvh::Config config = with;
    config.layout = Layout::binary, config.builder = Builder::fast;
    Bvh bvh = bvh_of(device, meshes, build_host_tree(meshes), config);
    state_of(bvh).small_kernels = true;
    return bvh;
}

Bvh bvh_of(const Device& device, std::span<const Mesh> meshes, const HostTree& tree, const Bvh::Config& config) {
    auto state = std::make_shared<Bvh::State>(device, upload(device, meshes), config, config.layout == Layout::binary);
    state->learns = false;
    state->nodes.write(tree.nodes);
    state->leaves.write(tree.leaves);
    state->header.write(std::span(&tree.header, 1));
    state->splits_of_host = tree.header.valid + tree.header.culled > state->count;
    if (state->layout == Layout::wide) state->collapse(false);
    return handle_of<Bvh>(std::move(state));
}

void Bvh::rebuild() {
    state_->stop_learning();
    state_->build();
}
void Bvh::refit() {
    state_->stop_learning();
    state_->refit();
}

const TriangleBuffers& Bvh::triangles() const { return state_->triangles; }
std::size_t Bvh::triangle_count() const { return state_->count; }
bool is_replaced(const Bvh& bvh) { return state_of(bvh).search() && state_of(bvh).search()->has_found(); }
Layout Bvh::layout() const { return state_->layout; }
const Device& Bvh::device() const { return state_->device; }

BvhStatistics Bvh::statistics() const {
    const BvhHeader header = state_->read_header();
    BvhStatistics statistics;
    statistics.triangles = state_->count - header.culled;
    statistics.references = header.valid - statistics.triangles;
    statistics.culled = header.culled;
    statistics.height = header.height;
    statistics.bytes = state_->tree_bytes(header);
    statistics.sah_cost = state_->sah_cost();
    return statistics;
}

double Bvh::cost_growth() const { return state_->built_cost > 0 ? state_->sah_cost() / state_->built_cost : 1; }
bool should_rebuild(const Bvh& bvh, double most_growth) { return bvh.cost_growth() > most_growth; }

bool is_closed(const Bvh& bvh) {
    require_triangles(bvh, "a test for closed surfaces");
    const Bvh::State& state = state_of(bvh);
    if (!state.closed) {
        constexpr std::uint32_t most_items = 1u << 16;
        Buffer<std::uint32_t> sums(bvh.device(), 2);
        sums.fill(0);
        load_kernel(bvh.device(), "bvh/validate.cl", "sum_edges")
            .run({std::min(state.count, most_items), 0}, state.triangles.positions,
                 arg("indices", state.triangles.indices), state.count, arg("sums", sums));
        state_of(bvh).closed = sums.read() == std::vector<std::uint32_t>{0, 0};
    }
    return *state.closed;
}

BvhValidation Bvh::validate() const {
    const std::uint32_t count = state_->count;
    Buffer<std::uint32_t> seen(device(), count), of_nodes(device(), 2), of_leaves(device(), 3);
    seen.fill(0), of_nodes.fill(0), of_leaves.fill(0);
    load_kernel(device(), "bvh/validate.cl", "validate_nodes")
        .run({state_->nodes.size(), 64}, state_->nodes, state_->leaves, state_->header, count, arg("seen", seen),
             arg("failures", of_nodes));
    load_kernel(device(), "bvh/validate.cl", "validate_leaves")
        .run({count, 64}, state_->triangles.positions, arg("indices", state_->triangles.indices), count, state_->nodes,
             state_->leaves, state_->header, arg("seen", seen), arg("failures", of_leaves));
    const std::vector<std::uint32_t> nodes = of_nodes.read(), leaves = of_leaves.read();
    return {.leaves_missing = leaves[0],
            .leaves_repeated = leaves[1],
            .boxes_not_containing = nodes[0] + leaves[2],
            .links_broken = nodes[1]};
}

std::string Bvh::hash() const {
    // Depth first, because the numbering by clustering depends on the schedule; the place of a child depends on its
    // node only.
    const std::vector<BvhNode> tree = state_->nodes.read();
    std::string bytes;
    std::vector<std::uint32_t> stack;
    if (const std::uint32_t root = state_->read_header().root; root != CLARAY_NO_CHILD) stack.push_back(root);
    while (!stack.empty()) {
        const std::uint32_t child = stack.back();
        stack.pop_back();
        if (child & CLARAY_LEAF) {
            append_bytes(bytes, child);
            continue;
        }
        BvhNode node = tree[child];
        stack.push_back(node.child1);
        stack.push_back(node.child0);
        node.child0 = node.child1 = node.parent = 0;
        append_bytes(bytes, node);
    }
    std::vector<LeafTriangle> leaves(state_->read_header().valid);
    state_->leaves.read(std::span(leaves));
    for (const LeafTriangle& leaf : leaves) append_bytes(bytes, leaf);
    return hash128(bytes);
}

void Bvh::bind(Kernel& kernel, unsigned& index) const {
    kernel.require(defines());
    state_->bind_solid(kernel, index);
    state_->bind_cutouts(kernel, index);
}

bool Bvh::State::splits() const {
    return splits_of_host || (traits_of(config.builder).splits && config.split_budget > 0);
}

void Bvh::State::bind_solid(Kernel& kernel, unsigned& index) const {
    kernel.set(index, arg("claray_header", header));
    if (layout == Layout::wide) {
        kernel.set(index, wide_nodes);
        primitive_blocks.size() != 0 ? kernel.set(index, primitive_blocks) : kernel.set(index, wide_blocks);
    } else {
        kernel.set(index, arg("claray_nodes", nodes));
        kernel.set(index, arg("claray_triangles", leaves));
    }
}

void Bvh::State::bind_cutouts(Kernel& kernel, unsigned& index) const {
    if (has_cutouts()) kernel.set(index, arg("claray_cutouts", cutouts));
}

void Bvh::State::set_cutouts(const Buffer<std::uint32_t>& store) {
    stop_learning();
    cutouts = store;
}

TreeFormat format_of(const Bvh& bvh) {
    const Bvh::State& state = state_of(bvh);
    return {.wide = state.layout == Layout::wide,
            .small = state.small_kernels,
            .cutouts = state.has_cutouts(),
            .primitives = state.leaf_shape != LeafShape::triangle};
}

Defines TreeFormat::defines() const {
    Defines defines = {{"CLARAY_WIDE", wide ? "1" : "0"}};
    if (small) defines.emplace_back("CLARAY_SMALL", "1");
    if (moves) defines.emplace_back("CLARAY_INSTANCE_MOTION", "1");
    if (cutouts) defines.emplace_back("CLARAY_CUTOUTS", "1");
    if (primitives) defines.emplace_back("CLARAY_PRIMITIVES", "1");
    return defines;
}

Defines Bvh::defines() const { return format_of(*this).defines(); }

}  // namespace claray
