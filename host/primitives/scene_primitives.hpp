// The primitives of a scene on the device: one structure for each kind, over data that share a buffer with what shading
// reads (claray/shared/scene.h).
#pragma once

#include "claray/primitives/primitives.hpp"
#include "claray/scene.hpp"
#include "host/trace/query_kernel.hpp"

namespace claray {

/// Primitives of all sets of a kind, in the order of the sets.
struct PrimitivesOfKind {
    std::uint32_t first = 0;  // number of the first one in hits
    Primitives structure;
};

class ScenePrimitives {
public:
    ScenePrimitives(const Device& device, const Scene& scene);

    [[nodiscard]] const std::vector<PrimitivesOfKind>& kinds() const { return kinds_; }
    /// A PrimitiveStore and what it tells of.
    [[nodiscard]] const Buffer<float>& store() const { return store_; }
    /// The macro PRIMITIVES: bits of the kinds.
    [[nodiscard]] std::uint32_t mask() const { return mask_; }
    /// Of the store and the trees.
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
    /// The same, with what the buffers of the trees do not use.
    [[nodiscard]] std::uint64_t device_bytes() const;

private:
    std::vector<PrimitivesOfKind> kinds_;
    Buffer<float> store_;
    std::uint32_t mask_ = 0;
    std::uint64_t bytes_ = 0;
};

/// The bits of the kinds that a scene has, as ScenePrimitives::mask.
[[nodiscard]] std::uint32_t kinds_of_primitives(const Scene& scene);
/// For each primitive, in the order of numbers in hits, its material.
[[nodiscard]] std::vector<std::uint32_t> materials_of_primitives(const Scene& scene);
[[nodiscard]] std::size_t primitive_count(const Scene& scene);
/// Device memory that the primitives will need, about.
[[nodiscard]] std::uint64_t bytes_of_primitives(const Scene& scene);

/// The second pass of a query whose first one is over triangles.
class PrimitivesQuery {
public:
    /// The profiler shows its times under `name`, if there is one. `instances`: the hits are InstanceHits.
    PrimitivesQuery(const ScenePrimitives& primitives, QueryKind kind, bool instances, const std::string& name);

    /// Replaces hits by nearer ones. `Hits` binds a buffer of Hits or of InstanceHits.
    template <class Hits>
    void closest(const Buffer<Ray>& rays, Hits& hits, std::uint32_t capacity, const Buffer<std::uint32_t>& count) {
        for (Pass& pass : passes_)
            pass.kernel.run(pass.range(capacity), pass.of.structure.bvh(), arg("data", pass.of.structure.data()),
                            pass.of.structure.count(), rays, capacity, arg("count", count), pass.of.first,
                            arg("hits", hits));
    }
    /// Sets the bytes of rays that hit a primitive to 1.
    void any(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::uint32_t capacity,
             const Buffer<std::uint32_t>& count);

private:
    struct Pass {
        PrimitivesOfKind of;
        Kernel kernel;
        [[nodiscard]] Range range(std::uint32_t rays) const;
    };
    std::vector<Pass> passes_;
};

}  // namespace claray
