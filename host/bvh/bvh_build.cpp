#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/compute/memory.hpp"
#include "host/compute/programs/joint_program.hpp"

namespace claray {
namespace {

constexpr std::uint32_t build_group = 256;
constexpr std::size_t pieces_a_range = 196;  // MAX_WAITING of kernels/bvh/serial/serial.clh
constexpr std::size_t triangle_limit = CLARAY_SLOT;

Layout resolve(Layout layout, const Device& device) {
    if (layout != Layout::automatic) return layout;
    return device.tuning("trace/closest_hit", "WIDE") != 0 ? Layout::wide : Layout::binary;
}

/// The collapse uses one item per subtree, with at least this many subtrees and fewer than eight times as many.
std::uint32_t subtrees_for(const Device& device) {
    return device.info().compute_units * device.tuning("bvh/collapse", "SUBTREES_PER_UNIT");
}

/// The number of wide nodes that an item reserves at once: small enough that unused ones cost little memory.
std::uint32_t numbers_at_once(std::uint32_t count, const Device& device) {
    return std::clamp(count / (64u * CLARAY_WIDTH * std::max(subtrees_for(device), 1u)), 1u, 32u);
}

}  // namespace

Builder resolve(Builder builder, const Device& device) {
    if (builder != Builder::automatic) return builder;
    return Builder(std::min<unsigned>(device.tuning("bvh/automatic", "BUILDER"), std::size(builders) - 1));
}

Bvh::State::State(const Device& on, const TriangleBuffers& of, const Config& with, bool by_host, LeafShape shape)
    : device(on),
      triangles(of),
      config(with),
      layout(resolve(with.layout, on)),
      leaf_shape(shape),
      count(std::uint32_t(of.indices.size() / 3)),
      learns(shape == LeafShape::triangle && with.learns.value_or(with.builder == Builder::automatic)) {
    config.builder = claray::resolve(config.builder, on);
    learns = learns && config.builder != Builder::high;
    if (config.morton_bits != 30 && config.morton_bits != 63)
        throw Error(ErrorKind::usage, "morton_bits is " + std::to_string(config.morton_bits), "use 30 or 63");
    if (config.max_leaf_triangles < 1 || config.max_leaf_triangles > 4)
        throw Error(ErrorKind::usage, "max_leaf_triangles is " + std::to_string(config.max_leaf_triangles),
                    "use 1 to 4");
    if (!(config.split_budget >= 0))
        throw Error(ErrorKind::usage, "split_budget is " + std::to_string(config.split_budget), "use 0 or more");
    if (of.indices.size() / 3 >= triangle_limit)
        throw Error(ErrorKind::user,
                    "too many triangles: " + std::to_string(of.indices.size() / 3) + ", the limit is 2^29 - 2");
    if (!by_host)
        compile_side_by_side(device, [this] {
            allocate();
            load_for_building(1);
        });
    allocate();
    if (!by_host) load_for_building(count);
}

void Bvh::State::load_for_building(std::size_t keys_to_sort) {
    prepared_ = true;
    if (traits_of(config.builder).codes) allocate_for_sorting();
    load_kernels(keys_to_sort);
}

void Bvh::State::prepare_to_build_after_host() {
    compile_side_by_side(device, [this] { load_for_building(1); });
    load_for_building(count);
}

void Bvh::State::load_kernels(std::size_t keys_to_sort) {
    reset_ = load_kernel(device, "bvh/bounds.cl", "reset_header");
    finish_bounds_ = load_kernel(device, "bvh/bounds.cl", "finish_bounds");
    if (ranges == 0) bounds_ = load_kernel(device, "bvh/bounds.cl", "compute_bounds");
    if (traits_of(config.builder).codes) load_for_sorting(keys_to_sort);
    if (layout == Layout::wide) {
        begin_collapse_ = load_collapse("begin_collapse");
        if (costs.size() != 0) cost_subtrees_ = load_collapse("cost_subtrees");
        collapse_level_ = load_collapse("collapse_level");
        collapse_subtrees_ = load_collapse("collapse_subtrees");
    }
}

Kernel Bvh::State::load_collapse(const std::string& function) const {
    Defines defines;
    if (leaf_shape != LeafShape::triangle) defines.emplace_back("LEAF_SHAPE", std::to_string(int(leaf_shape)));
    return load_kernel(device, "bvh/collapse.cl", function, defines);
}

void Bvh::State::load_for_sorting(std::size_t keys) {
    if (config.morton_bits == 63)
        sort64 = std::make_unique<RadixSort<std::uint64_t>>(device, keys, RadixSort<std::uint64_t>::config_for(device));
    else
        sort32 = std::make_unique<RadixSort<std::uint32_t>>(device, keys, RadixSort<std::uint32_t>::config_for(device));
    const bool balanced = config.builder == Builder::balanced;
    const Defines bits = {{"CODE_BITS", std::to_string(config.morton_bits)}};
    Defines tree = bits;
    tree.emplace_back("MAX_LEAF", std::to_string(leaf_limit()));
    if (ranges == 0) {
        codes_ = load_kernel(device, "bvh/morton_codes.cl", "compute_morton_codes", bits);
        lbvh_ = load_kernel(device, "bvh/lbvh.cl", "build_lbvh", tree);
        if (!balanced) return;
        hploc_ = load_kernel(device, "bvh/hploc.cl", "build_hploc", tree);
        return;
    }
    centroids_ = load_kernel(device, "bvh/centroids.cl", "compute_centroids", bits);
    encode_ = load_kernel(device, "bvh/centroids.cl", "encode_centroids", bits);
    lbvh_ranges_ = load_kernel(device, "bvh/serial/lbvh_serial.cl", "build_lbvh_ranges", tree);
    join_lbvh_ = load_kernel(device, "bvh/serial/lbvh_serial.cl", "join_lbvh_ranges", tree);
    if (!balanced) return;
    hploc_ranges_ = load_kernel(device, "bvh/serial/hploc_serial.cl", "build_hploc_ranges", tree);
    join_hploc_ = load_kernel(device, "bvh/serial/hploc_serial.cl", "join_hploc_ranges", tree);
}

void Bvh::State::allocate() {
    std::uint32_t capacity = count;  // of leaves
    if (!traits_of(config.builder).codes) {
        const bool blocks_of_eight = leaf_shape != LeafShape::triangle && layout == Layout::wide;
        sbvh = Sbvh(device, count, traits_of(config.builder).splits ? config.split_budget : 0,
                    blocks_of_eight ? CLARAY_WIDTH : 1);
        capacity = sbvh.capacity();
        other_nodes = Buffer<BvhNode>(device, capacity);
        other_leaves = Buffer<LeafTriangle>(device, capacity);
        finish = TreeLayout(device, capacity, leaf_limit());
    }
    header = Buffer<BvhHeader>(device, 1);
    bound_keys = Buffer<std::uint32_t>(device, 7);
    nodes = Buffer<BvhNode>(device, capacity);
    leaves = Buffer<LeafTriangle>(device, capacity);
    arrivals = Buffer<std::uint32_t>(device, capacity);
    if (layout == Layout::wide) {
        // A node with a wide child has 8 slots, one without has at least 5 triangles: at most count / 4 nodes in all.
        // Each subtree may leave all but one of the numbers that it reserved unused.
        const std::size_t spare =
            std::size_t(CLARAY_WIDTH) * subtrees_for(device) * (numbers_at_once(capacity, device) - 1);
        wide_nodes = Buffer<WideNode>(device, capacity / 4 + 1 + spare);
        const std::size_t blocks = std::max(capacity, 1u) + 2 * spare;
        if (leaf_shape == LeafShape::triangle)
            wide_blocks = Buffer<TriangleBlock>(device, blocks);
        else
            primitive_blocks = Buffer<PrimitiveBlock>(device, blocks);
        // For triangles of `balanced` it would take two fifths of the build.
        if (leaf_shape != LeafShape::triangle || !traits_of(config.builder).codes)
            costs = Buffer<float>(device, std::size_t(CLARAY_WIDTH) * capacity);
    }
}

/// Allocates the buffers of builders that begin with Morton codes.
void Bvh::State::allocate_for_sorting() {
    order = Buffer<std::uint32_t>(device, count);
    const unsigned per_unit = device.tuning("bvh/serial", "RANGES_PER_UNIT");
    if (per_unit != 0) {
        const unsigned least = std::max(1u, device.tuning("bvh/serial", "RANGE_LEAVES"));
        ranges = std::clamp(count / least, 1u, device.info().compute_units * per_unit);
        pieces = Buffer<std::uint32_t>(device, ranges * 2 * pieces_a_range);
        piece_counts = Buffer<std::uint32_t>(device, std::size_t(2) * ranges);
    }
    if (config.builder == Builder::balanced) clusters = Buffer<std::uint32_t>(device, count);
    if (config.morton_bits == 63)
        codes64 = Buffer<std::uint64_t>(device, count);
    else
        codes32 = Buffer<std::uint32_t>(device, count);
}

void Bvh::State::compute_bounds() {
    const std::uint32_t axis_bits = config.morton_bits / 3;
    reset_.run({1, 1}, header, bound_keys);
    if (ranges != 0) {  // the leaves' memory is unused until the tree is built
        centroids_.run({ranges, 1}, arg("positions", triangles.positions), arg("indices", triangles.indices), count,
                       header, arg("keys", bound_keys), ranges, arg("centroids", leaves.memory()));
    } else {
        const std::size_t items =
            std::min<std::size_t>(count, std::size_t(device.info().compute_units) * 8 * build_group);
        bounds_.run({items, build_group}, triangles.positions, arg("indices", triangles.indices), count, header,
                    arg("keys", bound_keys));
    }
    finish_bounds_.run({1, 1}, header, bound_keys, count, axis_bits);
}

template <class Code>
void Bvh::State::build_tree(Buffer<Code>& codes, RadixSort<Code>& sort) {
    if (ranges != 0)
        encode_.run({ranges, 1}, leaves.memory(), count, header, arg("keys", bound_keys), ranges, arg("codes", codes));
    else
        codes_.run({count, build_group}, triangles.positions, arg("indices", triangles.indices), count, header,
                   arg("keys", bound_keys), arg("codes", codes));
    sort.sort(codes, order, count);
    if (config.builder == Builder::fast) {
        build_lbvh(codes);
        return;
    }
    build_hploc(codes);
    // Clustering does not bound the height; a tree too high for a traversal's stack is replaced.
    if (read_header().height > CLARAY_MAX_HEIGHT) build_lbvh(codes);
}

/// Leaves are references until the copy turns them into triangles.
void Bvh::State::build_from_root() {
    sbvh.build(triangles, other_nodes, other_leaves, header);
    finish.copy(triangles, other_nodes, other_leaves, sbvh.capacity(), arrivals, header, nodes, leaves);
}

template <class Code>
void Bvh::State::build_lbvh(const Buffer<Code>& codes) {
    if (ranges != 0) {
        lbvh_ranges_.run({ranges, 1}, triangles.positions, arg("indices", triangles.indices),
                         arg("geometries", triangles.geometries), arg("masks", triangles.masks), arg("codes", codes),
                         arg("order", order), nodes, leaves, header, ranges, pieces, arg("piece_counts", piece_counts));
        join_lbvh_.run({1, 1}, arg("codes", codes), nodes, leaves, header, ranges, pieces,
                       arg("piece_counts", piece_counts));
        return;
    }
    arrivals.fill(0xffffffffu);
    lbvh_.run({count, build_group}, triangles.positions, arg("indices", triangles.indices),
              arg("geometries", triangles.geometries), arg("masks", triangles.masks), arg("codes", codes),
              arg("order", order), nodes, leaves, arg("arrivals", arrivals), header);
}

template <class Code>
void Bvh::State::build_hploc(const Buffer<Code>& codes) {
    if (ranges != 0) {
        hploc_ranges_.run({ranges, 1}, triangles.positions, arg("indices", triangles.indices),
                          arg("geometries", triangles.geometries), arg("masks", triangles.masks), arg("codes", codes),
                          arg("order", order), nodes, leaves, arg("clusters", clusters), header, ranges,
                          arg("pieces", pieces), arg("piece_counts", piece_counts));
        join_hploc_.run({1, 1}, arg("codes", codes), nodes, leaves, arg("clusters", clusters), header, ranges,
                        arg("pieces", pieces), arg("piece_counts", piece_counts));
        return;
    }
    arrivals.fill(0xffffffffu);
    hploc_.run({count, device.tuning("bvh/hploc", "GROUP_SIZE")}, triangles.positions,
               arg("indices", triangles.indices), arg("geometries", triangles.geometries),
               arg("masks", triangles.masks), arg("codes", codes), arg("order", order), nodes, leaves,
               arg("arrivals", arrivals), arg("clusters", clusters), header);
}

void Bvh::State::build() {
    if (!prepared_) prepare_to_build_after_host();
    built_cost = 0;
    closed.reset();
    splits_of_host = false;
    compute_bounds();
    if (!traits_of(config.builder).codes)
        build_from_root();
    else if (sort64)
        build_tree(codes64, *sort64);
    else
        build_tree(codes32, *sort32);
    if (layout == Layout::wide) collapse(config.builder == Builder::fast);
}

/// Runs a kernel of collapse.cl with the buffers that all but the first have.
template <class... Parameters>
void Bvh::State::run_collapse(Kernel& kernel, Range range, const Parameters&... parameters) {
    if (leaf_shape == LeafShape::triangle)
        kernel.run(range, nodes, leaves, wide_nodes, wide_blocks, header, parameters...);
    else
        kernel.run(range, nodes, leaves, wide_nodes, primitive_blocks, header, parameters...);
}

void Bvh::State::collapse(bool by_split) {
    begin_collapse_.run({1, 1}, header, wide_nodes);
    std::uint32_t begin = 0, end = read_header().wide_nodes;
    if (costs.size() != 0) {
        arrivals.fill(0);
        cost_subtrees_.run({nodes.size(), build_group}, nodes, header, arg("arrivals", arrivals), arg("costs", costs));
    }
    const std::uint32_t enough = subtrees_for(device), at_once = numbers_at_once(count, device);
    while (begin < end && end - begin < enough) {
        run_collapse(collapse_level_, {end - begin, 1}, arg("costs", costs), begin, end);
        begin = end;
        end = read_header().wide_nodes;
    }
    run_collapse(collapse_subtrees_, {end - begin, 1}, arg("costs", costs), begin, end, at_once,
                 std::uint32_t(by_split));
}

void Bvh::State::load_refit() {
    if (refit_.handle()()) return;
    refit_ = load_kernel(device, "bvh/refit.cl", "refit_nodes");
    if (layout == Layout::wide) refit_wide_ = load_collapse("refit_wide");
    (void)load_kernel(device, "bvh/validate.cl", "sum_areas");  // of sah_cost
}

void Bvh::State::refit() {
    closed.reset();
    load_refit();
    if (built_cost == 0) built_cost = sah_cost();
    arrivals.fill(0);
    const std::uint32_t group = device.tuning("bvh/refit", "GROUP_SIZE");
    refit_.run({nodes.size(), group == 1 ? build_group : group}, triangles.positions, arg("indices", triangles.indices),
               nodes, leaves, arg("arrivals", arrivals), header);
    if (layout == Layout::wide) run_collapse(refit_wide_, {wide_nodes.size(), 64});
}

void Bvh::State::stop_learning() {
    learns = false;
    if (search()) search()->stop();
}

void Bvh::State::keep_tree_only() {
    stop_learning();
    triangles = {};
    bound_keys = {}, codes32 = {}, order = {}, arrivals = {}, clusters = {}, codes64 = {};
    pieces = {}, piece_counts = {}, costs = {};
    sort32.reset(), sort64.reset();
    other_nodes = {}, other_leaves = {}, sbvh = {}, finish = {};
    if (layout == Layout::wide) nodes = {}, leaves = {};
}

std::uint64_t Bvh::State::bytes() const {
    return buffer_bytes(header, nodes, leaves, wide_nodes, wide_blocks, primitive_blocks, bound_keys, codes32, codes64,
                        order, arrivals, clusters, pieces, piece_counts, costs, other_nodes, other_leaves, sbvh,
                        finish) +
           (sort32 ? sort32->bytes() : 0) + (sort64 ? sort64->bytes() : 0);
}

double Bvh::State::sah_cost() const {
    const BvhHeader h = read_header();
    if (h.inner_nodes == 0) return h.valid;
    const std::size_t items = 4096;
    const Buffer<float> sums(device, 2 * items);
    load_kernel(device, "bvh/validate.cl", "sum_areas").run({items, 64}, nodes, header, sums);
    double area = 0;
    for (const float sum : sums.read()) area += sum;
    const double x = double(h.hix) - h.lox, y = double(h.hiy) - h.loy, z = double(h.hiz) - h.loz;
    return area / (x * y + y * z + z * x);
}

BvhHeader Bvh::State::read_header() const { return header.read()[0]; }

}  // namespace claray
