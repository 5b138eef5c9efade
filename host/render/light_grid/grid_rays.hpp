// The rays by which a wavefront fills a light grid. All functions are asynchronous.
#pragma once

#include "host/render/wavefront/wavefront.hpp"

namespace claray {

/// A round of rays. A probe remembers at most `most_before` earlier rays.
struct ProbeRays {
    std::uint32_t per_probe, round;
    float most_before;
};

/// Finds out which probes the parts of cells see.
void mark_cells(Wavefront& wavefront, const GridBox& cells);
/// Adds the light that one round of rays finds to the probes.
void gather_probes(Wavefront& wavefront, const GridBox& probes, const ProbeRays& rays);
/// The same for voxels, with one ray for each of their sides.
void gather_voxels(Wavefront& wavefront, const GridBox& voxels, const ProbeRays& rays);
/// The albedo of the voxel that each pixel of a batch shows, three floats each.
void show_voxels(Wavefront& wavefront, const Batch& batch, const Buffer<float>& albedo);

}  // namespace claray
