// The acceleration structure: build, rebuild, refit, validate.
#pragma once

#include <filesystem>
#include <span>

#include "claray/buffer.hpp"
#include "claray/mesh.hpp"
#include "claray/program.hpp"
#include "claray/shared/bvh_node.h"
#include "claray/shared/types.h"

namespace claray {

/// Which tree is traversed.
enum class Layout {
    automatic,  ///< by the tuning table
    binary,     ///< 64-byte nodes with both children's boxes
    wide        ///< 8 boxes a node and 4 triangles a leaf, tested at once by vector instructions
};

/// How the tree is built: time for quality.
enum class Builder {
    fast,      ///< linear BVH (Apetrei 2014)
    balanced,  ///< hierarchical locally-ordered clustering (Benthin et al. 2024): a better tree
    high  ///< balanced, over large triangles split into several boxes, then improved by moving nodes: the best tree
};

/// Measured facts of a built structure.
struct BvhStatistics {
    std::uint32_t triangles = 0;   ///< in the tree
    std::uint32_t culled = 0;      ///< left out: not finite, beyond 1e18, or with two equal vertices
    std::uint32_t references = 0;  ///< leaves beyond one a triangle, of triangles that were split
    std::uint32_t height = 0;
    double sah_cost = 0;      ///< surface area heuristic: 1 per box pair, 1 per triangle, relative to the root's area
    std::uint64_t bytes = 0;  ///< device memory of the structure, without scratch
};

/// The outcome of `Bvh::validate`; all counts are 0 for a sound structure.
struct BvhValidation {
    std::uint32_t leaves_missing = 0;   ///< triangles that no leaf holds
    std::uint32_t leaves_repeated = 0;  ///< triangles that several leaves hold whole
    std::uint32_t boxes_not_containing =
        0;                           ///< child boxes that don't contain what is below, split triangles not covered
    std::uint32_t links_broken = 0;  ///< parents that don't point back, or indices out of range
    [[nodiscard]] bool ok() const {
        return leaves_missing + leaves_repeated + boxes_not_containing + links_broken == 0;
    }
};

/// Triangles in device memory: `positions` holds 3 floats a vertex, `indices` 3 vertices a triangle. `geometries`
/// (per triangle) may be empty: all belong to geometry 0; `masks` (per geometry) may be empty: every ray sees all.
struct TriangleBuffers {
    Buffer<float> positions;
    Buffer<std::uint32_t> indices;
    Buffer<std::uint32_t> geometries;
    Buffer<std::uint32_t> masks;
};

/// Device memory that a build takes: the triangles, the structure, and the scratch that is kept for rebuilding.
struct BvhMemory {
    std::uint64_t bytes = 0;
    std::uint64_t largest_buffer = 0;
};

struct HostTree;

/// A bounding volume hierarchy in device memory. A handle: copies share the structure.
class Bvh {
public:
    struct Config {
        Builder builder = Builder::fast;
        unsigned morton_bits = 63;  ///< 30 or 63 bits a code: 10 or 21 an axis
        Layout layout = Layout::automatic;
        /// `high` only: further references that splitting large triangles may make, per triangle; 0 splits none. A
        /// refit undoes what splitting gains, so that 0 is for what moves.
        double split_budget = 0.5;
        /// `high` only: rounds of moving nodes.
        unsigned optimization_rounds = 2;
        /// Binary layout only: triangles a leaf may hold where the surface area heuristic says so, up to 4.
        unsigned max_leaf_triangles = 4;
    };

    /// Builds over the triangles of all meshes; primitive indices count over all meshes in order. Throws
    /// ErrorKind::device, before anything is uploaded or computed, where the device has too little memory.
    [[nodiscard]] static Bvh build(const Device& device, std::span<const Mesh> meshes, const Config& config);
    [[nodiscard]] static Bvh build(const Device& device, std::span<const Mesh> meshes) {
        return build(device, meshes, Config{});
    }
    /// Builds from triangles that are already on the device, which it keeps for `rebuild` and `refit`.
    [[nodiscard]] static Bvh build(const Device& device, const TriangleBuffers& triangles, const Config& config);
    [[nodiscard]] static Bvh build(const Device& device, const TriangleBuffers& triangles) {
        return build(device, triangles, Config{});
    }

    /// Builds on the host, always in the binary layout: a worse tree, but no kernel has to be compiled before.
    /// `rebuild` builds on the device, as `fast`.
    [[nodiscard]] static Bvh build_by_host(const Device& device, std::span<const Mesh> meshes, const Config& config);
    /// Takes a tree that was made elsewhere (see host/bvh/host_tree.hpp), in any layout: to compare builders.
    [[nodiscard]] static Bvh build_by_host(const Device& device, std::span<const Mesh> meshes, const HostTree& tree,
                                           const Config& config);

    /// What building over so many vertices and triangles takes on the device.
    [[nodiscard]] static BvhMemory memory_needed(const Device& device, std::size_t vertices, std::size_t triangles,
                                                 const Config& config);

    /// Writes the structure and its triangles to a file, so that `load` gives what was saved: same tree, same hits, and
    /// it can be refitted and rebuilt. Written by temporary file and rename. Throws ErrorKind::user where that fails.
    void save(const std::filesystem::path& path) const;
    /// A saved structure, on any device; a wide tree is made from the binary one in the file. Throws ErrorKind::user,
    /// naming the file, where it can't be read, is damaged, or was written by another version.
    [[nodiscard]] static Bvh load(const Device& device, const std::filesystem::path& path,
                                  Layout layout = Layout::automatic);

    /// Builds anew, in the same memory, after the positions in `triangles().positions` have changed.
    void rebuild();
    /// Keeps the tree and recomputes all boxes after the positions have changed: faster than `rebuild`, and a worse
    /// tree the more has moved. Triangles culled at the last build stay out; ones that became NaN can't be hit.
    void refit();
    /// How many times the tree's SAH cost at its last build it costs now, after refits: 1 where nothing moved. Measured
    /// on the device in about the time of a refit; waits for it.
    [[nodiscard]] double cost_growth() const;
    /// Whether the tree is so much worse than when it was built that a rebuild pays: by Lauterbach et al. 2006
    /// ("RT-DEFORM"), who rebuilt at 40 %.
    [[nodiscard]] bool should_rebuild(double most_growth = 1.4) const;

    /// Makes rays pass through what is cut out of the triangles: `store` is what the renderer makes of a scene's
    /// textures (include/claray/shared/texture.h). All kernels that trace this structure are compiled for it; one that
    /// is not allocated takes it away again.
    void set_cutouts(const Buffer<std::uint32_t>& store);
    [[nodiscard]] bool has_cutouts() const;

    [[nodiscard]] const TriangleBuffers& triangles() const;
    [[nodiscard]] std::size_t triangle_count() const;
    [[nodiscard]] Layout layout() const;
    [[nodiscard]] const Device& device() const;

    [[nodiscard]] BvhHeader header() const;
    [[nodiscard]] BvhStatistics statistics() const;
    /// Checks every leaf, box and link on the device.
    [[nodiscard]] BvhValidation validate() const;
    /// The same for all devices that build the same tree from the same triangles: 32 hexadecimal digits over the binary
    /// nodes and the order of the leaves.
    [[nodiscard]] std::string hash() const;

    [[nodiscard]] const Buffer<BvhNode>& nodes() const;
    [[nodiscard]] const Buffer<LeafTriangle>& leaves() const;
    [[nodiscard]] const Buffer<WideNode>& wide_nodes() const;
    [[nodiscard]] const Buffer<TriangleBlock>& wide_blocks() const;
    [[nodiscard]] const Buffer<BvhHeader>& header_buffer() const;

    /// Binds the kernel parameters CLARAY_BVH_PARAMETERS of trace/closest_hit.clh.
    void bind(Kernel& kernel, unsigned& index) const;
    /// The same for a kernel that takes all triangles for solid and is compiled without CLARAY_CUTOUTS.
    void bind_solid(Kernel& kernel, unsigned& index) const;
    /// Binds CLARAY_CUTOUTS_PARAMETERS of trace/ray.clh: nothing where nothing is cut out.
    void bind_cutouts(Kernel& kernel, unsigned& index) const;
    /// Macros with which a kernel that includes trace/closest_hit.clh must be compiled for this structure.
    [[nodiscard]] Defines defines() const;

    struct State;

private:
    std::shared_ptr<State> state_;
};

}  // namespace claray
