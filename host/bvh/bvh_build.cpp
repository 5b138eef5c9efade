#include <algorithm>

#include "host/bvh/bvh_state.hpp"
#include "host/compute/memory.hpp"

namespace claray {
namespace {

constexpr std::uint32_t build_group = 256;
constexpr std::size_t pieces_a_range = 196;  // MAX_WAITING of kernels/bvh/serial/serial.clh
constexpr std::size_t triangle_limit = CLARAY_SLOT;

constexpr const char* collapse_file = "bvh/collapse.cl";

using Sort32 = RadixSort<std::uint32_t>;
using Sort64 = RadixSort<std::uint64_t>;

Bvh::Config resolved(Bvh::Config config, const Device& device) {
    config.layout = resolve(config.layout, device), config.builder = resolve(config.builder, device);
    return config;
}

Defines defines_of(LeafShape shape) {
    if (shape == LeafShape::triangle) return {};
    return {{"LEAF_SHAPE", std::to_string(int(shape))}};
}

/// Whether the collapse takes the cheapest tree. For triangles of `balanced` it would take two fifths of the build.
bool weighs_costs(const Bvh::Config& config, LeafShape shape) {
    return shape != LeafShape::triangle || !traits_of(config.builder).codes;
}

/// See sbvh_serial.cl.
unsigned leaf_block(const Bvh::Config& config, LeafShape shape) {
    return shape != LeafShape::triangle && config.layout == Layout::wide ? CLARAY_WIDTH : 1;
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

Layout resolve(Layout layout, const Device& device) {
    if (layout != Layout::automatic) return layout;
    return device.tuning("trace/closest_hit", "WIDE") != 0 ? Layout::wide : Layout::binary;
}

Bvh::State::State(const Device& on, const TriangleBuffers& of, const Config& with, bool by_host, LeafShape shape)
    : device(on),
      triangles(of),
      config(resolved(with, on)),
      layout(config.layout),
      leaf_shape(shape),
      count(std::uint32_t(of.indices.size() / 3)),
      learns(shape == LeafShape::triangle && with.learns.value_or(with.builder == Builder::automatic)) {
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
    if (!by_host) claray::load(device, programs_of_builder(device, config, shape));
    allocate();
    if (!by_host) prepare();
}

void Bvh::State::prepare() {
    prepared_ = true;
    if (traits_of(config.builder).codes) {
        allocate_for_sorting();
        if (config.morton_bits == 63)
            sort64 = std::make_unique<Sort64>(device, count, Sort64::config_for(device));
        else
            sort32 = std::make_unique<Sort32>(device, count, Sort32::config_for(device));
    }
    claray::load(device, kernels(device, config, leaf_shape), *this);
}

KernelsOf<Bvh::State> Bvh::State::kernels(const Device& device, const Config& config, LeafShape shape) {
    const BuilderTraits& traits = traits_of(config.builder);
    const bool is_serial = traits.codes && device.tuning("bvh/serial", "RANGES_PER_UNIT") != 0;
    KernelsOf<State> kernels = {{&State::reset_, {"bvh/bounds.cl", "reset_header", {}}},
                                {&State::finish_bounds_, {"bvh/bounds.cl", "finish_bounds", {}}}};
    const auto add = [&](Kernel State::*member, const char* file, const char* function, const Defines& defines) {
        kernels.push_back({member, {file, function, defines}});
    };
    if (!is_serial) add(&State::bounds_, "bvh/bounds.cl", "compute_bounds", {});
    if (traits.codes) {
        const Defines bits = {{"CODE_BITS", std::to_string(config.morton_bits)}};
        Defines tree = bits;
        tree.emplace_back("MAX_LEAF", std::to_string(leaf_limit(config)));
        const bool balanced = config.builder == Builder::balanced;
        if (is_serial) {
            add(&State::centroids_, "bvh/centroids.cl", "compute_centroids", bits);
            add(&State::encode_, "bvh/centroids.cl", "encode_centroids", bits);
            add(&State::lbvh_ranges_, "bvh/serial/lbvh_serial.cl", "build_lbvh_ranges", tree);
            add(&State::join_lbvh_, "bvh/serial/lbvh_serial.cl", "join_lbvh_ranges", tree);
            if (balanced) add(&State::hploc_ranges_, "bvh/serial/hploc_serial.cl", "build_hploc_ranges", tree);
            if (balanced) add(&State::join_hploc_, "bvh/serial/hploc_serial.cl", "join_hploc_ranges", tree);
        } else {
            add(&State::codes_, "bvh/morton_codes.cl", "compute_morton_codes", bits);
            add(&State::lbvh_, "bvh/lbvh.cl", "build_lbvh", tree);
            if (balanced) add(&State::hploc_, "bvh/hploc.cl", "build_hploc", tree);
        }
    }
    if (config.layout == Layout::binary) return kernels;
    add(&State::begin_collapse_, collapse_file, "begin_collapse", defines_of(shape));
    if (weighs_costs(config, shape)) add(&State::cost_subtrees_, collapse_file, "cost_subtrees", defines_of(shape));
    add(&State::collapse_level_, collapse_file, "collapse_level", defines_of(shape));
    add(&State::collapse_subtrees_, collapse_file, "collapse_subtrees", defines_of(shape));
    return kernels;
}

KernelSet programs_of_builder(const Device& device, const Bvh::Config& with, LeafShape shape) {
    const Bvh::Config config = resolved(with, device);
    KernelSet set = programs_of(device, Bvh::State::kernels(device, config, shape));
    if (!traits_of(config.builder).codes) {
        set.add(programs_of(device, Sbvh::kernels(device, leaf_block(config, shape))));
        set.add(programs_of(device, TreeLayout::kernels(Bvh::State::leaf_limit(config))));
    } else if (config.morton_bits == 63) {
        set.add(programs_of(device, Sort64::kernels(device, Sort64::config_for(device).onesweep)));
    } else {
        set.add(programs_of(device, Sort32::kernels(device, Sort32::config_for(device).onesweep)));
    }
    return set;
}

void Bvh::State::allocate() {
    std::uint32_t capacity = count;  // of leaves
    if (!traits_of(config.builder).codes) {
        sbvh = Sbvh(device, count, traits_of(config.builder).splits ? config.split_budget : 0,
                    leaf_block(config, leaf_shape));
        capacity = sbvh.capacity();
        other_nodes = Buffer<BvhNode>(device, capacity);
        other_leaves = Buffer<LeafTriangle>(device, capacity);
        finish = TreeLayout(device, capacity, leaf_limit(config));
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
        if (weighs_costs(config, leaf_shape)) costs = Buffer<float>(device, std::size_t(CLARAY_WIDTH) * capacity);
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
    if (!prepared_) {
        claray::load(device, programs_of_builder(device, config, leaf_shape));
        prepare();
    }
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
    if (layout == Layout::wide) refit_wide_ = load_kernel(device, collapse_file, "refit_wide", defines_of(leaf_shape));
    (void)load_kernel(device, area_sum);
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
    load_kernel(device, area_sum).run({items, 64}, nodes, header, sums);
    double area = 0;
    for (const float sum : sums.read()) area += sum;
    const double x = double(h.hix) - h.lox, y = double(h.hiy) - h.loy, z = double(h.hiz) - h.loz;
    return area / (x * y + y * z + z * x);
}

BvhHeader Bvh::State::read_header() const { return header.read()[0]; }

}  // namespace claray
