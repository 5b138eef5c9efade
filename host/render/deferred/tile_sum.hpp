// Approximations::tile_sum: direct light without shadows at the first surfaces, summed over the lists of tiles
// (kernels/deferred). Lists are made anew for each batch, so that lights and cameras may move.
#pragma once

#include "claray/shared/tiles.h"
#include "host/compute/memory.hpp"
#include "host/render/scene_buffers.hpp"

namespace claray {

class TileSum {
public:
    /// `shading`: defines of the stages that shade. `everywhere`: points outside a tile are lit, too; all lights are
    /// summed up for each.
    TileSum(const SceneBuffers& scene, const Defines& shading, bool everywhere);

    [[nodiscard]] static KernelsOf<TileSum> kernels(const Device& device, const StructureFormat& structure,
                                                    const Defines& shading);

    /// Replaces the radiance of a batch's paths. `hits`: those of the camera rays in `rays`, the first array of
    /// `queue`. Asynchronous.
    void run(const Step& step, const SceneBuffers& scene, const Buffer<Ray>& rays, const Buffer<RayQueue>& queue,
             const SceneHits& hits, const Buffer<float>& radiance);

    [[nodiscard]] std::uint64_t bytes() const { return buffer_bytes(boxes_, light_bounds_, block_lists_, lists_); }

private:
    void make_room(const TileGrid& grid);

    Device device_;
    std::uint32_t most_per_tile_, most_per_block_;
    Kernel bound_, bound_lights_, list_for_blocks_, list_for_tiles_, sum_;
    Buffer<TileBoxes> boxes_;
    Buffer<float> light_bounds_;
    Buffer<std::uint32_t> block_lists_, lists_;
};

}  // namespace claray
