// The acceleration structure: build, rebuild, refit, validate.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "claray/buffer.hpp"
#include "claray/mesh.hpp"
#include "claray/program.hpp"
#include "claray/shared/bvh_node.h"
#include "claray/shared/types.h"

#pragma GCC visibility push(default)
namespace claray {

/// Memory layout of the tree that is traversed.
enum class Layout {
    automatic,  ///< chosen by the tuning table
    binary,     ///< 64-byte nodes with the boxes of both children
    wide        ///< 8 boxes per node and up to 4 triangles per leaf, tested together by vector instructions
};

// The list of all builders. A row is X(name, NAME, "note for users", codes, splits):
//   name    Builder::name, and the name for users
//   NAME    prefix of the planner's tuning rows
//   codes   1: sorts Morton codes first; 0: splits nodes from the root down (host/bvh/sbvh.hpp)
//   splits  1: splits large triangles into several boxes

/// Builders that the planner chooses among (claray/plan/target.hpp).
#define CLARAY_PLANNED_BUILDERS(X)                     \
    X(fast, FAST, "fastest to build", 1, 0)            \
    X(balanced, BALANCED, "better tree, slower", 1, 0) \
    X(high, HIGH, "best tree, slowest", 0, 1)
#define CLARAY_OTHER_BUILDERS(X) X(binned, BINNED, "binned SAH, nothing split", 0, 0)
#define CLARAY_BUILDERS(X) CLARAY_PLANNED_BUILDERS(X) CLARAY_OTHER_BUILDERS(X)

/// How the tree is built. The builders differ in build time and trace speed. `fast`: linear BVH (Apetrei 2014).
/// `balanced`: hierarchical locally-ordered clustering (Benthin et al. 2024). `high`: binned SAH from the root down,
/// over large triangles split into several boxes (Stich et al. 2009). `binned`: binned SAH alone (Wald 2007), for
/// geometry that is refitted. `automatic`: `high` on GPUs, where it builds sponza in 4 ms, else `balanced`
/// (bvh/automatic of kernels/tuning.txt); for geometry that stays. Use `fast` for geometry that is built again every
/// frame.
enum class Builder {
#define CLARAY_ROW(name, NAME, note, codes, splits) name,
    CLARAY_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
        automatic
};

struct BuilderTraits {
    Builder builder;
    const char* name;
    const char* note;  ///< for users
    bool codes;        ///< sorts Morton codes first
    bool splits;       ///< a large triangle may be in several leaves
};
inline constexpr BuilderTraits builders[] = {
#define CLARAY_ROW(name, NAME, note, codes, splits) {Builder::name, #name, note, (codes) != 0, (splits) != 0},
    CLARAY_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
};
inline constexpr BuilderTraits automatic_traits = {Builder::automatic, "automatic", "high on GPUs, else balanced", true,
                                                   false};
[[nodiscard]] constexpr const BuilderTraits& traits_of(Builder builder) {
    return builder == Builder::automatic ? automatic_traits : builders[std::size_t(builder)];
}
/// Returns what `builder` stands for on the device.
[[nodiscard]] Builder resolve(Builder builder, const Device& device);

/// Measurements of a built structure.
struct BvhStatistics {
    std::uint32_t triangles = 0;   ///< number of triangles in the tree
    std::uint32_t culled = 0;      ///< triangles left out: not finite, beyond 1e18, or with two equal vertices
    std::uint32_t references = 0;  ///< additional leaves of triangles that were split
    std::uint32_t height = 0;
    double sah_cost = 0;      ///< surface area heuristic: 1 per box pair, 1 per triangle, relative to the root's area
    std::uint64_t bytes = 0;  ///< device memory of the structure, without scratch memory
};

/// The result of `Bvh::validate`. All counts are 0 for a valid structure.
struct BvhValidation {
    std::uint32_t leaves_missing = 0;        ///< triangles that are in no leaf
    std::uint32_t leaves_repeated = 0;       ///< triangles that are in several leaves without being split
    std::uint32_t boxes_not_containing = 0;  ///< boxes that do not contain their subtree, split triangles not covered
    std::uint32_t links_broken = 0;          ///< wrong parent indices, and indices out of range
    [[nodiscard]] bool ok() const {
        return leaves_missing + leaves_repeated + boxes_not_containing + links_broken == 0;
    }
};

/// Triangles in device memory: `positions` holds 3 floats per vertex, `indices` 3 vertices per triangle. `geometries`
/// (one per triangle) may be empty: all triangles belong to geometry 0. `masks` (one per geometry) may be empty: every
/// ray sees every geometry.
struct TriangleBuffers {
    Buffer<float> positions = {};
    Buffer<std::uint32_t> indices = {};
    Buffer<std::uint32_t> geometries = {};
    Buffer<std::uint32_t> masks = {};
};

/// Device memory for a build, in bytes: the triangles, the structure, and the scratch memory that is kept for
/// rebuilding.
struct BvhMemory {
    std::uint64_t bytes = 0;
    std::uint64_t largest_buffer = 0;
};

/// A bounding volume hierarchy in device memory. A handle: copies share the structure.
class Bvh {
public:
    struct Config {
        Builder builder = Builder::automatic;
        unsigned morton_bits = 63;  ///< bits per Morton code: 30 or 63, which is 10 or 21 per axis
        Layout layout = Layout::automatic;
        /// `high` only: upper limit of additional references from splitting large triangles, per triangle; 0: do not
        /// split. A refit loses the gain from splitting. Use 0 for geometry that will be refitted.
        double split_budget = 0.5;
        /// Binary layout only: largest number of triangles per leaf, up to 4, if the surface area heuristic prefers it.
        unsigned max_leaf_triangles = 4;
        /// Whether queries may replace the tree by one of `high`, which a thread builds. The thread begins after at
        /// least 100 batches of rays that took as long as ten such builds take. The new tree must save at least 3 % of
        /// the time of batches that are traced in both trees. Hits stay the same bit for bit. Both trees then stay in
        /// memory, and the build takes at most half of the memory that is left. Unset: if `builder` is automatic.
        ///
        /// Rays are those of closest_hit, any_hit and Query for this Bvh (claray/query.hpp), but not with masks, a
        /// filter, `visits`, `brute_force` or `count`: such queries always trace the first tree. Times need a queue
        /// with CL_QUEUE_PROFILING_ENABLE. `refit` and `rebuild` return to the first tree for good; they wait while the
        /// thread reads it. The destructor of the last handle waits for a build. Do not call these functions, or
        /// destroy that handle, while the queue waits for a user event that the same thread sets later.
        std::optional<bool> learns = {};
    };

    /// Builds a tree over the triangles of all meshes. Primitive indices continue from mesh to mesh, in order. Throws
    /// ErrorKind::device, before any upload or computation, if the device has too little memory.
    [[nodiscard]] static Bvh build(const Device& device, std::span<const Mesh> meshes, const Config& config);
    [[nodiscard]] static Bvh build(const Device& device, std::span<const Mesh> meshes) {
        return build(device, meshes, Config{});
    }
    /// Builds a tree from triangles that are already on the device. The structure shares these buffers, for `rebuild`
    /// and `refit`.
    [[nodiscard]] static Bvh build(const Device& device, const TriangleBuffers& triangles, const Config& config);
    [[nodiscard]] static Bvh build(const Device& device, const TriangleBuffers& triangles) {
        return build(device, triangles, Config{});
    }

    /// Returns the device memory that a build over this many vertices and triangles needs.
    [[nodiscard]] static BvhMemory memory_needed(const Device& device, std::size_t vertices, std::size_t triangles,
                                                 const Config& config);

    /// Writes the structure and its triangles to a file. `load` restores the same tree with the same hits, and it can
    /// be refitted and rebuilt. The data is written to a temporary file, which is then renamed. Throws ErrorKind::user
    /// on failure.
    void save(const std::filesystem::path& path) const;
    /// Loads a saved structure on any device. A wide tree is made from the binary tree in the file. Queries do not
    /// replace its tree (Config::learns). Throws ErrorKind::user, naming the file, if the file cannot be read, is
    /// damaged, or was written by another version.
    [[nodiscard]] static Bvh load(const Device& device, const std::filesystem::path& path,
                                  Layout layout = Layout::automatic);

    /// Rebuilds the tree in the same memory after the positions in `triangles().positions` have changed.
    void rebuild();
    /// Keeps the tree and recomputes all boxes after the positions have changed. Faster than `rebuild`, but the tree
    /// gets worse with more motion. Triangles culled at the last build stay out. Triangles that became NaN cannot be
    /// hit.
    void refit();
    /// Returns the current SAH cost divided by the SAH cost at the last build: 1 if nothing moved. Computed on the
    /// device in about the time of a refit; blocks.
    [[nodiscard]] double cost_growth() const;

    [[nodiscard]] const TriangleBuffers& triangles() const;
    [[nodiscard]] std::size_t triangle_count() const;
    [[nodiscard]] Layout layout() const;
    [[nodiscard]] const Device& device() const;

    [[nodiscard]] BvhStatistics statistics() const;
    /// Checks every leaf, box and link on the device. Blocks.
    [[nodiscard]] BvhValidation validate() const;
    /// Returns 32 hexadecimal digits over the binary nodes and the order of the leaves. The hash is equal on all
    /// devices that build the same tree from the same triangles.
    [[nodiscard]] std::string hash() const;

    /// Binds the kernel parameters CLARAY_BVH_PARAMETERS of trace/closest_hit.clh, from `index` on, and advances
    /// `index`.
    void bind(Kernel& kernel, unsigned& index) const;
    /// Returns the macros for compiling a kernel that includes trace/closest_hit.clh for this structure.
    [[nodiscard]] Defines defines() const;

    struct State;  ///< not for users

private:
    friend struct Internals;
    std::shared_ptr<State> state_;
};

/// Returns whether `cost_growth()` is large enough for a rebuild to pay off (Lauterbach et al. 2006, "RT-DEFORM", who
/// rebuilt at 40 %).
[[nodiscard]] bool should_rebuild(const Bvh& bvh, double most_growth = 1.4);
/// Returns whether queries trace a better tree instead of this one: see Bvh::Config::learns.
[[nodiscard]] bool is_replaced(const Bvh& bvh);
/// Returns whether the triangles close: every edge belongs to an even number of them. Edges are the same if the
/// coordinates of their ends are. Computed once after a build, rebuild or refit; blocks. An open surface has no inside.
[[nodiscard]] bool is_closed(const Bvh& bvh);

}  // namespace claray
#pragma GCC visibility pop
