// Instances: a two-level structure. Many placements share a few bottom levels. If instances move, only the top level is
// rebuilt.
#pragma once

#include <span>
#include <vector>

#include "claray/query.hpp"
#include "claray/shared/instance.h"

#pragma GCC visibility push(default)
namespace claray {

/// Returns an instance of bottom level `bottom`, from the affine part of a matrix that maps object space to world
/// space.
[[nodiscard]] Instance make_instance(const glm::mat4& object_to_world, std::uint32_t bottom = 0,
                                     std::uint32_t mask = 0xffffffffu, std::uint32_t id = 0);

/// Instances that are placed together: an instance of the group places all of its members.
struct InstanceGroup {
    std::vector<Instance> members = {};  ///< Instance::bottom: see flatten
};

/// Instances of several levels as instances of one, for InstancedBvh::build.
struct FlatInstances {
    std::vector<Instance> instances = {};
    /// How instance i is reached: the index of an instance in `roots`, then that of a member in its group, and so on:
    /// steps[offsets[i]] .. steps[offsets[i + 1] - 1].
    std::vector<std::uint32_t> offsets = {}, steps = {};
};

/// Places groups in groups, in any number of levels. Instance::bottom below `bottoms` is a structure; `bottoms` + g is
/// groups[g]. Transforms are multiplied in float64 and rounded once. A flat instance has the bits of all masks on its
/// way, and `id` and `tag` of the last instance. The order is that of a depth-first walk. The structures are shared,
/// but every flat instance takes about 300 bytes of device memory. Throws ErrorKind::usage for a group that contains
/// itself or does not exist, ErrorKind::user for more than 2^29 - 2 instances.
[[nodiscard]] FlatInstances flatten(std::span<const Instance> roots, std::span<const InstanceGroup> groups,
                                    std::uint32_t bottoms);

/// Measurements of a built two-level structure.
struct InstanceStatistics {
    std::uint32_t instances = 0;  ///< instances in the tree
    std::uint32_t culled = 0;  ///< instances left out: see `Instance`; also instances of empty or missing bottom levels
    std::uint32_t height = 0;  ///< of the top level
    double sah_cost = 0;       ///< of the top level: 1 per box pair, 1 per instance
    float widening = 0;        ///< relative growth of every box with its distance from the ray (docs/numerics.md)
    std::uint64_t top_bytes = 0;     ///< device memory of the top level and the instances, without scratch memory
    std::uint64_t bottom_bytes = 0;  ///< device memory of the bottom levels, including shared ones
};

/// A top level over instances of bottom levels, in device memory. A handle: copies share the structure.
class InstancedBvh {
public:
    struct Config {
        Builder builder = Builder::fast;  ///< builder of the top level
        unsigned morton_bits = 63;        ///< bits per Morton code: 30 or 63, which is 10 or 21 per axis
    };

    /// Builds the top level over `instances`. A single bottom level is shared with its Bvh: changes of the Bvh take
    /// effect at the next `rebuild`. Several bottom levels must have the same layout; they are copied to one block of
    /// memory. Throws ErrorKind::usage if there is no bottom level, or if layouts or devices differ.
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                            const Config& config);
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, std::span<const Instance> instances) {
        return build(bottoms, instances, Config{});
    }
    /// As above, for instances that are already on the device. The structure shares this buffer, for `rebuild` and
    /// `refit`.
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances,
                                            const Config& config);
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances) {
        return build(bottoms, instances, Config{});
    }

    /// As above, for instances that move. Rays have times (QueryOptions::ray_times): `instances` holds the transforms
    /// at time 0, `ends` those at time 1; other members of `ends` are ignored. Matrices in between are interpolated
    /// linearly. The boxes of the top level contain the whole motion. An instance is counted and left out if its matrix
    /// may become singular during the motion, as in half a turn. Instances that do not move have no additional cost.
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                            std::span<const Instance> ends, const Config& config);
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances,
                                            const Buffer<Instance>& ends, const Config& config);

    /// Rebuilds the top level in the same memory after `instances()` or `ends()` has changed. With Builder::fast the
    /// call is asynchronous.
    void rebuild();
    /// Keeps the top level's tree and recomputes its boxes. Faster than `rebuild`, but the tree gets worse with more
    /// motion. Instances culled at the last build stay out. Instances whose matrix became singular cannot be hit.
    void refit();
    /// Replaces the bottom levels, in any number, after they were rebuilt, refitted or exchanged. Call `rebuild` or
    /// `refit` afterwards.
    void replace_bottoms(std::span<const Bvh> bottoms);

    /// Device memory of the instances. The host or kernels may write to it.
    [[nodiscard]] const Buffer<Instance>& instances() const;
    /// Device memory of the transforms at time 1. Not allocated if the structure was built without `ends`.
    [[nodiscard]] const Buffer<Instance>& ends() const;
    [[nodiscard]] std::size_t instance_count() const;
    [[nodiscard]] Layout layout() const;  ///< layout of the bottom levels
    [[nodiscard]] const Device& device() const;
    /// The top level: a tree whose leaves hold instance indices as primitives.
    [[nodiscard]] const Bvh& top() const;

    [[nodiscard]] InstanceStatistics statistics() const;
    /// Checks every leaf, box and link of the top level on the device. Blocks.
    [[nodiscard]] BvhValidation validate() const;

    /// Binds the kernel parameters CLARAY_INSTANCES_PARAMETERS of trace/traverse_instances.clh, from `index` on.
    void bind(Kernel& kernel, unsigned& index) const;
    /// Returns the macros for compiling a kernel that includes trace/traverse_instances.clh for this structure.
    [[nodiscard]] Defines defines() const;

    struct State;  ///< not for users

private:
    friend struct Internals;
    std::shared_ptr<State> state_;
};

/// Finds the closest hit of every ray. Asynchronous; see closest_hit of a Bvh. In addition, the mask of an instance
/// applies like the mask of a mesh. The lowest instance index wins among equal distances. QueryOptions::brute_force
/// tests every instance without the top level. Front faces are those in object space, even if a transform mirrors them.
void closest_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<InstanceHit>& hits,
                 const QueryOptions& options = {}, const Buffer<std::uint32_t>& count = {});
/// Writes 1 for every ray that hits anything, else 0.
void any_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options = {}, const Buffer<std::uint32_t>& count = {});

/// As above, for rays in host memory: uploads, traces, downloads. Blocks.
[[nodiscard]] std::vector<InstanceHit> closest_hit(const InstancedBvh& bvh, std::span<const Ray> rays,
                                                   const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const InstancedBvh& bvh, std::span<const Ray> rays,
                                                const QueryOptions& options = {});

}  // namespace claray
#pragma GCC visibility pop
