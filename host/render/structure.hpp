// The acceleration structure of a scene: one tree over all triangles, or a tree of trees if the scene has instances;
// and trees over its primitives.
#pragma once

#include <optional>
#include <span>
#include <utility>

#include "claray/instances.hpp"
#include "claray/shared/path.h"
#include "host/bvh/bvh_state.hpp"
#include "host/primitives/scene_primitives.hpp"
#include "host/scene/placement.hpp"
#include "host/trace/instance_query.hpp"
#include "host/trace/query_kernel.hpp"

namespace claray {

class PartsQuery;
class SceneParts;

/// What kernels depend on in the structure of a scene.
struct StructureFormat {
    TreeFormat trees;
    bool has_instances = false, is_split = false;
    std::uint32_t primitives = 0;  // bits of their kinds

    bool operator==(const StructureFormat&) const = default;
    /// Macros of kernels that read hits.
    [[nodiscard]] Defines defines() const;
    /// See Structure::is_one_binary_tree.
    [[nodiscard]] bool is_one_binary_tree() const {
        return !has_instances && !is_split && primitives == 0 && !trees.wide;
    }
};

/// The programs of a SceneQuery, but those of primitives, which are no files of claray's. `file`: see QueryKernel.
[[nodiscard]] KernelSet programs_of_query(const Device& device, const StructureFormat& structure, QueryKind kind,
                                          const QueryOptions& options, const std::string& file = {});
/// The programs that build structures, but the trees over primitives.
[[nodiscard]] KernelSet programs_of_structure(const Device& device, const StructureFormat& structure,
                                              const Bvh::Config& config);

class Structure {
public:
    Structure() = default;
    /// `baked` as in PlacedScene; `by_host`: see build_by_host (host/bvh). `parts`: the trees
    /// are split into so many parts, which take turns on the device if its memory is too small for all. Throws
    /// ErrorKind::user if an instance cannot be placed.
    Structure(const Device& device, const Scene& scene, std::size_t baked, const Bvh::Config& config,
              bool by_host = false, unsigned parts = 1);

    /// For one tree: replaces the positions of the vertices from `first` on. Call `follow_vertices` afterwards.
    void move_vertices(std::size_t first, std::span<const glm::vec3> positions);
    /// Refits the tree, or rebuilds it if that pays. Blocks.
    void follow_vertices();
    /// Loads the kernels of `follow_vertices`.
    void prepare_to_follow() {
        if (!instanced_ && !parts_) state_of(bvh_).load_refit();
    }
    /// For a tree of trees: replaces the transforms of instances, by their index in the scene of the constructor, and
    /// rebuilds the top level. Throws ErrorKind::user as the constructor does; the structure is then unchanged.
    void move_instances(std::span<const std::pair<std::uint32_t, MeshInstance>> moved);

    /// Rebuilds on the device with another configuration: one tree, or a tree of trees built by the host.
    [[nodiscard]] Structure rebuilt(const Bvh::Config& config) const;

    [[nodiscard]] const Device& device() const;
    /// Triangles of all meshes, in order.
    [[nodiscard]] const TriangleBuffers& triangles() const { return triangles_; }
    /// Of a scene in parts: one part's tree, or the instances over a tree that stands for all others.
    [[nodiscard]] const Bvh& bvh() const { return bvh_; }
    [[nodiscard]] const std::optional<InstancedBvh>& instanced() const { return instanced_; }
    /// Null if the scene is not split. A structure in parts cannot be moved or rebuilt.
    [[nodiscard]] const std::shared_ptr<SceneParts>& parts() const { return parts_; }
    /// Null if the scene has none.
    [[nodiscard]] const std::shared_ptr<ScenePrimitives>& primitives() const { return primitives_; }
    /// Whether kernels may traverse `bvh()`, in the binary layout, and find everything in it.
    [[nodiscard]] bool is_one_binary_tree() const { return format().is_one_binary_tree(); }
    [[nodiscard]] StructureFormat format() const;
    /// See Bvh::State::set_cutouts.
    void set_cutouts(const Buffer<std::uint32_t>& store);
    [[nodiscard]] bool moves() const { return instanced_ && instanced_->ends().allocated(); }
    /// For one tree; for a tree of trees: triangles and bytes of all levels, the largest height that a ray descends,
    /// and the top level's cost. The bytes include those of primitives. Blocks.
    [[nodiscard]] BvhStatistics statistics() const;
    /// Of all buffers, the triangles' and those for rebuilding among them.
    [[nodiscard]] std::uint64_t bytes() const;
    /// Number of culled triangles.
    [[nodiscard]] std::uint32_t culled() const {
        return instanced_ || parts_ ? bottoms_.culled : state_of(bvh_).read_header().culled;
    }
    [[nodiscard]] Defines defines() const { return format().defines(); }
    /// Binds INSTANCE_PARAMETERS of shade/instance.clh and PRIMITIVE_PARAMETERS of shade/scene.clh.
    void bind(Kernel& kernel, unsigned& index) const;

private:
    struct Instances;
    [[nodiscard]] static Instances instances_of(const Scene& scene, std::size_t baked,
                                                const std::vector<std::uint32_t>& bottoms,
                                                const std::vector<std::uint32_t>& first_triangles);
    [[nodiscard]] BvhStatistics statistics_of_triangles() const;
    void build_parts(const Device& device, const Scene& scene, const Bvh::Config& config, unsigned parts);
    void check_placed() const;

    std::shared_ptr<SceneParts> parts_;
    std::shared_ptr<ScenePrimitives> primitives_;
    Bvh bvh_;
    std::optional<InstancedBvh> instanced_;
    std::vector<Bvh> by_host_;  // its bottom levels, if the host built them
    TriangleBuffers triangles_;
    std::size_t baked_ = 0;  // see PlacedScene
    std::size_t empty_instances_ = 0;
    BvhStatistics bottoms_;  // of all bottom levels: triangles and the largest height
};

/// Hits of either kind.
struct SceneHits {
    SceneHits() = default;
    SceneHits(const Structure& structure, std::size_t count);

    Buffer<Hit> of_triangles;
    Buffer<InstanceHit> of_instances;

    void bind(Kernel& kernel, unsigned& index) const {
        of_instances.allocated() ? kernel.set(index, of_instances) : kernel.set(index, of_triangles);
    }
    [[nodiscard]] std::size_t size() const { return std::max(of_triangles.size(), of_instances.size()); }
    [[nodiscard]] std::uint64_t bytes() const { return of_triangles.bytes() + of_instances.bytes(); }
};

/// The light of shadow rays, and the radiance of paths to which it is added: ANSWERS_PARAMETERS of
/// render/trace_shadow_rays.cl.
struct ShadowLight {
    const Buffer<LightSample>& light;
    Buffer<float>& radiance;
    void bind(Kernel& kernel, unsigned& index) const { kernel.set(index, light), kernel.set(index, radiance); }
};

/// A query of either kind, and of the primitives.
class SceneQuery {
public:
    SceneQuery() = default;
    /// `file`: see QueryKernel; for scenes of one tree.
    SceneQuery(const Structure& structure, QueryKernel::Kind kind, const QueryOptions& options, const std::string& name,
               const std::string& file = {});

    /// `times` of the rays, if something moves. The rays' tmax is lost if the scene is in parts.
    void closest(const Buffer<Ray>& rays, SceneHits& hits, std::uint32_t capacity, const Buffer<std::uint32_t>& count,
                 const Buffer<float>& times);
    /// For the file render/trace_shadow_rays.cl, of scenes without primitives.
    void shadow(const Buffer<Ray>& rays, const ShadowLight& light, std::uint32_t capacity,
                const Buffer<std::uint32_t>& count) {
        of_triangles_.run(rays, light, capacity, count);
    }
    void any(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::uint32_t capacity,
             const Buffer<std::uint32_t>& count, const Buffer<float>& times);
    /// Of its own buffers.
    [[nodiscard]] std::uint64_t bytes() const;

private:
    bool instanced_ = false;
    QueryKernel of_triangles_;
    InstanceQuery of_instances_;
    std::shared_ptr<PartsQuery> of_parts_;
    std::optional<PrimitivesQuery> of_primitives_;
};

}  // namespace claray
