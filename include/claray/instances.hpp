// Instances: a structure of structures. Many placements share a few bottom levels; only the top is built anew when they
// move.
#pragma once

#include <span>
#include <vector>

#include "claray/query.hpp"
#include "claray/shared/instance.h"

namespace claray {

/// An instance of bottom level `bottom` from the affine part of a matrix that maps the object into the world.
[[nodiscard]] Instance make_instance(const glm::mat4& object_to_world, std::uint32_t bottom = 0,
                                     std::uint32_t mask = 0xffffffffu, std::uint32_t id = 0);

/// Measured facts of a built two-level structure.
struct InstanceStatistics {
    std::uint32_t instances = 0;     ///< in the tree
    std::uint32_t culled = 0;        ///< left out: see `Instance`; also those of empty or missing bottom levels
    std::uint32_t height = 0;        ///< of the top level
    double sah_cost = 0;             ///< of the top level: 1 per box pair, 1 per instance
    float widening = 0;              ///< by how much of its distance from a ray every box grows (docs/numerics.md)
    std::uint64_t top_bytes = 0;     ///< device memory of the top level and the instances, without scratch
    std::uint64_t bottom_bytes = 0;  ///< of the bottom levels, shared ones included
};

/// A top level over instances of bottom levels, in device memory. A handle: copies share the structure.
class InstancedBvh {
public:
    struct Config {
        Builder builder = Builder::fast;  ///< of the top level
        unsigned morton_bits = 63;        ///< 30 or 63 bits a code: 10 or 21 an axis
    };

    /// Builds the top level over `instances`. A single bottom level is shared with its Bvh, whose changes are seen at
    /// the next `rebuild`; several, which must have one layout, are copied into one piece of memory. Throws
    /// ErrorKind::usage where there is no bottom level, or layouts or devices differ.
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                            const Config& config);
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, std::span<const Instance> instances) {
        return build(bottoms, instances, Config{});
    }
    /// The same for instances that are already on the device, which it keeps for `rebuild` and `refit`.
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances,
                                            const Config& config);
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances) {
        return build(bottoms, instances, Config{});
    }

    /// Over instances that move while rays are traced that have times (QueryOptions::ray_times): at time 0 they are as
    /// `instances` say, at time 1 as `ends`, of which only the transforms count, and in between their matrices run on a
    /// straight line. Boxes of the top level hold the whole way. An instance whose matrix may lose its inverse on the
    /// way, as in half a turn, is counted and left out. Those that end where they begin cost what they always do.
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                            std::span<const Instance> ends, const Config& config);
    [[nodiscard]] static InstancedBvh build(std::span<const Bvh> bottoms, const Buffer<Instance>& instances,
                                            const Buffer<Instance>& ends, const Config& config);

    /// As Bvh::build_by_host: places instances and builds the top level without compiling a kernel. Without `ends`
    /// nothing moves. Throws ErrorKind::usage on a device without float64, whose placements would have other bits.
    [[nodiscard]] static InstancedBvh build_by_host(std::span<const Bvh> bottoms, std::span<const Instance> instances,
                                                    std::span<const Instance> ends, const Config& config);

    /// Builds the top level anew, in the same memory, after `instances()` or `ends()` has changed. With Builder::fast
    /// all of it is enqueued and nothing waits for the device.
    void rebuild();
    /// Keeps the top level's tree and recomputes its boxes: faster than `rebuild`, and a worse tree the more has moved.
    /// Instances culled at the last build stay out; ones that lose their inverse can't be hit.
    void refit();
    /// Takes the bottom levels anew, in any number, after they were rebuilt, refitted or exchanged; `rebuild` or
    /// `refit` must follow.
    void replace_bottoms(std::span<const Bvh> bottoms);

    /// As Bvh::set_cutouts. An instance's `id` is then the index, in the store, of its structure's first triangle. A
    /// structure that is the only one is given the store itself.
    void set_cutouts(const Buffer<std::uint32_t>& store);

    /// Device memory of the instances, to be written by the host or by kernels.
    [[nodiscard]] const Buffer<Instance>& instances() const;
    /// The same for where they move to; not allocated where it was built without.
    [[nodiscard]] const Buffer<Instance>& ends() const;
    /// The instances as traversals read them, as the shutter opens.
    [[nodiscard]] const Buffer<PlacedInstance>& placed() const;
    [[nodiscard]] std::size_t instance_count() const;
    [[nodiscard]] Layout layout() const;  ///< of the bottom levels
    [[nodiscard]] const Device& device() const;
    /// The top level: a tree whose leaves hold, as primitives, the indices of instances.
    [[nodiscard]] const Bvh& top() const;

    [[nodiscard]] InstanceStatistics statistics() const;
    /// Checks every leaf, box and link of the top level on the device.
    [[nodiscard]] BvhValidation validate() const;

    /// Binds the kernel parameters CLARAY_INSTANCES_PARAMETERS of trace/traverse_instances.clh.
    void bind(Kernel& kernel, unsigned& index) const;
    /// Macros with which a kernel that includes trace/traverse_instances.clh must be compiled for this structure.
    [[nodiscard]] Defines defines() const;

    struct State;

private:
    std::shared_ptr<State> state_;
};

/// The first hit of every ray; enqueued, not waited for. As the queries of a Bvh; in addition an instance's mask counts
/// as a mesh's does, the lowest instance wins among equal distances, and QueryOptions::brute_force tests every instance
/// without the top level. Front faces are those of the objects, whether or not a transform mirrors them.
void closest_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<InstanceHit>& hits,
                 const QueryOptions& options = {}, const Buffer<std::uint32_t>& count = {});
/// 1 for every ray that hits anything, else 0.
void any_hit(const InstancedBvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
             const QueryOptions& options = {}, const Buffer<std::uint32_t>& count = {});

/// The same for rays in host memory: uploads, traces, downloads.
[[nodiscard]] std::vector<InstanceHit> closest_hit(const InstancedBvh& bvh, std::span<const Ray> rays,
                                                   const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const InstancedBvh& bvh, std::span<const Ray> rays,
                                                const QueryOptions& options = {});

}  // namespace claray
