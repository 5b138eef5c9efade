// The queues of rays that the path tracer's stages fill and empty, and the arrays that go with them.
#pragma once

#include "claray/shared/path.h"
#include "host/render/kernels/stage_kernels.hpp"

namespace claray {

/// The queues of a render take at most so large a part of the device's memory.
constexpr std::uint64_t share_of_wavefront = 16;

/// Floats of each path among the radiance, without the lessons of a path guide. With a light tree the normals at the
/// paths' surfaces follow.
[[nodiscard]] inline std::uint32_t floats_of_paths(const SceneTables& where) {
    return where.light_tree == CLARAY_NO_TABLE ? 3 : 6;
}

/// Floats of each path behind all of these, with so many layers of light.
[[nodiscard]] std::uint32_t floats_of_layers(unsigned layers);

/// A queue of the rays of one depth, and its arrays that other stages than shade_surface read.
struct RayArrays {
    RayArrays() = default;
    RayArrays(const Device& device, std::size_t room, bool moves);

    Buffer<RayQueue> queue;
    Buffer<Ray> rays;
    Buffer<PathState> states;
    Buffer<float> times;  // of the rays; not allocated if only the camera can move
};

/// The same for shadow rays.
struct ShadowArrays {
    ShadowArrays() = default;
    ShadowArrays(const Device& device, std::size_t room, bool moves, bool casts_shadows);

    Buffer<ShadowQueue> queue;
    Buffer<Ray> rays;
    Buffer<LightSample> light;
    Buffer<float> times;
    Buffer<std::uint8_t> occluded;
};

/// Of all queues, on the device: 0 before a batch.
struct QueueLengths {
    explicit QueueLengths(const Device& device);
    [[nodiscard]] Buffer<std::uint32_t>& of_rays(std::uint32_t depth) { return rays[depth % CLARAY_RAY_QUEUES]; }
    [[nodiscard]] Buffer<std::uint32_t>& of_shadow_rays(std::uint32_t depth) {
        return shadow_rays[depth % CLARAY_SHADOW_QUEUES];
    }

    Buffer<QueueLength> all;
    Buffer<std::uint32_t> rays[CLARAY_RAY_QUEUES], shadow_rays[CLARAY_SHADOW_QUEUES];
};

struct Queues {
    /// `most_paths` of a render.
    Queues(const SceneBuffers& scene, const StageConfig& config, std::uint64_t most_paths);

    /// For another number of paths.
    void limit(const SceneBuffers& scene, const StageConfig& config, std::uint64_t most_paths);
    /// Allocates what this many paths need, at most `capacity`.
    void make_room(std::uint32_t paths, const SceneBuffers& scene, const StageConfig& config,
                   std::size_t floats_per_path);
    /// From the next batch on, light is split into layers by this table (claray/shared/lists/lobes.h).
    void split_light(const std::vector<std::uint32_t>& table);
    /// The next batch needs other buffers.
    void outdate() { rays[0].rays = {}; }
    /// Paths for which there are buffers.
    [[nodiscard]] std::uint32_t room() const { return std::uint32_t(rays[0].rays.size()); }
    [[nodiscard]] RayArrays& of_depth(std::uint32_t depth) { return rays[depth % 2]; }
    [[nodiscard]] std::uint64_t bytes() const {
        return buffer_bytes(rays[0].queue, rays[1].queue, shadow.queue, shadow.occluded, hits, radiance, lengths.all,
                            sorted);
    }

    std::uint32_t capacity = 0;  // the most paths of a batch
    QueueLengths lengths;
    RayArrays rays[2];
    ShadowArrays shadow;
    SceneHits hits;
    Buffer<std::uint32_t> sorted;    // numbers of rays, for each shader
    Buffer<float> radiance;          // of each path; then the table of layers, and the layers
    std::vector<float> layer_table;  // its words; empty: light is not split
};

}  // namespace claray
