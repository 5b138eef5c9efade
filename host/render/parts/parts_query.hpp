// Queries of a scene in parts: one part after the other.
#pragma once

#include "host/render/parts/scene_parts.hpp"
#include "host/render/structure.hpp"

namespace claray {

/// Keeps the nearest hits of all parts, or whether any part blocks.
[[nodiscard]] KernelRequest keeper_of_nearest(const StructureFormat& structure, QueryKind kind);

class PartsQuery {
public:
    /// As SceneQuery.
    PartsQuery(const Structure& structure, QueryKernel::Kind kind, const QueryOptions& options,
               const std::string& name);

    /// As SceneQuery::closest and any. The rays' tmax is lost.
    void closest(const Buffer<Ray>& rays, SceneHits& hits, std::uint32_t capacity, const Buffer<std::uint32_t>& count,
                 const Buffer<float>& times);
    void any(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::uint32_t capacity,
             const Buffer<std::uint32_t>& count, const Buffer<float>& times);
    /// Of its own buffers.
    [[nodiscard]] std::uint64_t bytes() const;

private:
    [[nodiscard]] std::uint32_t rays_to_trace(std::uint32_t capacity, const Buffer<std::uint32_t>& count) const;

    std::shared_ptr<SceneParts> parts_;
    Structure structure_;
    Buffer<Visits> visits_, visits_of_all_;
    std::vector<QueryKernel> of_triangles_;
    std::vector<InstanceQuery> of_instances_;
    Kernel keep_;
    SceneHits found_;
    Buffer<std::uint8_t> blocked_;
};

}  // namespace claray
