// The state shared by copies of a Bvh. Internal to host/bvh.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include "claray/bvh.hpp"
#include "host/bvh/layout.hpp"
#include "host/bvh/sbvh.hpp"
#include "host/bvh/tree_search.hpp"
#include "host/compute/state_of.hpp"
#include "host/sort/radix_sort.hpp"

namespace claray {

/// What the leaves of a wide tree hold: see TriangleBlock and PrimitiveBlock.
enum class LeafShape { triangle, box, capsule };

/// Builds over primitives whose boxes the triangles span. Only kernels of kernels/primitives can trace the result.
/// `capsules`: the boxes are those of capsules (kernels/primitives/primitive.clh).
[[nodiscard]] Bvh build_over_primitives(const Device& device, const TriangleBuffers& corners, const Bvh::Config& config,
                                        bool capsules);

/// Throws ErrorKind::usage for a structure over primitives. `user`: what needs triangles, as the subject of a sentence.
void require_triangles(const Bvh& bvh, const std::string& user);

/// The same structure, which someone else must keep alive: for what the structure itself owns.
[[nodiscard]] Bvh without_owning(const Bvh& bvh);

/// What kernels that trace a tree depend on.
struct TreeFormat {
    bool wide = false;
    bool small = false;       // see CLARAY_SMALL in kernels/trace/closest_hit.clh
    bool moves = false;       // of instances
    bool cutouts = false;     // see Bvh::State::set_cutouts
    bool primitives = false;  // leaves hold no triangles

    [[nodiscard]] Defines defines() const;
    bool operator==(const TreeFormat&) const = default;
};
[[nodiscard]] TreeFormat format_of(const Bvh& bvh);

/// The programs that build trees over triangles, or over other primitives.
[[nodiscard]] KernelSet programs_of_builder(const Device& device, const Bvh::Config& config,
                                            LeafShape shape = LeafShape::triangle);
/// For Bvh::State::sah_cost.
inline const KernelRequest area_sum = {"bvh/validate.cl", "sum_areas", {}};
/// What Layout::automatic stands for; otherwise `layout`.
[[nodiscard]] Layout resolve(Layout layout, const Device& device);

struct Bvh::State {
    /// `by_host`: the host will fill in the tree. Kernels and buffers for building are then loaded and allocated on
    /// demand.
    State(const Device& on, const TriangleBuffers& of, const Config& with, bool by_host = false,
          LeafShape shape = LeafShape::triangle);

    /// Those of builders with Morton codes are not all. `shape` and `config`: as resolved for the device.
    [[nodiscard]] static KernelsOf<State> kernels(const Device& device, const Config& config, LeafShape shape);

    void build();
    /// Frees the triangles and the memory kept for rebuilding: the tree can only be traversed afterwards.
    void keep_tree_only();
    void load_refit();
    void refit();
    /// Queries trace the tree that was built, from now on: what it holds changes.
    void stop_learning();
    /// `by_split`: node i of the binary tree splits the leaves between i and i + 1, as the linear builder numbers them.
    void collapse(bool by_split);
    [[nodiscard]] BvhHeader read_header() const;
    /// Whether a triangle may be in several leaves.
    [[nodiscard]] bool splits() const;
    /// Enables cut-outs: rays pass through the transparent parts of triangles. `store` is the texture store that the
    /// renderer makes from a scene (include/claray/shared/texture.h); an unallocated one disables them. All kernels
    /// that trace this structure are then compiled with cut-outs.
    void set_cutouts(const Buffer<std::uint32_t>& store);
    [[nodiscard]] bool has_cutouts() const { return cutouts.allocated(); }
    /// As Bvh::bind, for a kernel that treats all triangles as solid and is compiled without CLARAY_CUTOUTS.
    void bind_solid(Kernel& kernel, unsigned& index) const;
    /// Binds CLARAY_CUTOUTS_PARAMETERS of trace/ray.clh. Binds nothing if there are no cut-outs.
    void bind_cutouts(Kernel& kernel, unsigned& index) const;
    [[nodiscard]] double sah_cost() const;
    [[nodiscard]] std::size_t block_bytes() const {
        return leaf_shape == LeafShape::triangle ? sizeof(TriangleBlock) : sizeof(PrimitiveBlock);
    }
    /// Of all buffers but the triangles.
    [[nodiscard]] std::uint64_t bytes() const;
    /// Of what a traversal reads.
    [[nodiscard]] std::uint64_t tree_bytes(const BvhHeader& of) const {
        if (layout == Layout::binary) return sizeof(BvhHeader) + nodes.bytes() + leaves.bytes();
        return sizeof(BvhHeader) + of.wide_nodes * sizeof(WideNode) + of.wide_blocks * block_bytes();
    }
    /// Largest number of triangles per leaf of the binary tree; 1 for the wide tree, which forms its own leaves.
    [[nodiscard]] static std::uint32_t leaf_limit(const Config& config) {
        return config.layout == Layout::binary ? config.max_leaf_triangles : 1;
    }

    Device device;
    TriangleBuffers triangles;
    Config config;
    Layout layout;
    LeafShape leaf_shape;
    std::uint32_t count;          // triangles of the input, including culled ones
    bool splits_of_host = false;  // a tree from elsewhere has triangles in several leaves
    bool small_kernels = false;   // see CLARAY_SMALL in kernels/trace/closest_hit.clh

    double built_cost = 0;       // the cost before the first refit; 0: none since the last build
    std::optional<bool> closed;  // see is_closed; none since the vertices moved

    Buffer<BvhHeader> header;
    Buffer<BvhNode> nodes;
    Buffer<LeafTriangle> leaves;
    Buffer<WideNode> wide_nodes;
    Buffer<TriangleBlock> wide_blocks;
    Buffer<PrimitiveBlock> primitive_blocks;  // instead of wide_blocks
    Buffer<std::uint32_t> cutouts;            // see set_cutouts

    // Scratch, kept for rebuilding.
    Buffer<std::uint32_t> bound_keys;  // three minima, three maxima (float_key), and the Morton grid's scale
    Buffer<std::uint32_t> codes32, order, arrivals, clusters;
    Buffer<std::uint64_t> codes64;
    Buffer<std::uint32_t> pieces, piece_counts;  // of the serial schedule
    Buffer<float> costs;                         // of subtrees: see collapse.cl
    std::uint32_t ranges = 0;                    // work-items of the serial schedule; 0: every leaf climbs by itself
    std::unique_ptr<RadixSort<std::uint32_t>> sort32;
    std::unique_ptr<RadixSort<std::uint64_t>> sort64;

    // For builders that split from the root down: the tree before it is copied into its final order.
    Buffer<BvhNode> other_nodes;
    Buffer<LeafTriangle> other_leaves;
    Sbvh sbvh;
    TreeLayout finish;

    std::atomic<bool> learns;  // see Config::learns
    std::once_flag search_begun;
    void begin_search(std::unique_ptr<TreeSearch> search) {
        search_ = std::move(search);
        searching_ = search_.get();
    }
    /// Null before the first query.
    [[nodiscard]] TreeSearch* search() const { return searching_; }

private:
    template <class... Parameters>
    void run_collapse(Kernel& kernel, Range range, const Parameters&... parameters);
    void allocate();
    void allocate_for_sorting();
    void prepare();
    void compute_bounds();
    template <class Code>
    void build_tree(Buffer<Code>& codes, RadixSort<Code>& sort);
    void build_from_root();
    template <class Code>
    void build_lbvh(const Buffer<Code>& codes);
    template <class Code>
    void build_hploc(const Buffer<Code>& codes);

    std::unique_ptr<TreeSearch> search_;
    std::atomic<TreeSearch*> searching_ = nullptr;

    bool prepared_ = false;
    Kernel reset_, centroids_, encode_, bounds_, finish_bounds_, codes_, lbvh_, hploc_, refit_, lbvh_ranges_,
        join_lbvh_, hploc_ranges_, join_hploc_, begin_collapse_, cost_subtrees_, collapse_level_, collapse_subtrees_,
        refit_wide_;
};

}  // namespace claray
