// The rays of all beams of a scan.
#include "claray/shared/types.h"
#include "sensors/poses.clh"

/// The unit vector to the left of a beam that is level, as z is up; y for a beam along z, and 0 for one
/// without a direction.
static inline float3 left_of(float3 beam) {
    const float level2 = beam.x * beam.x + beam.y * beam.y;
    if (level2 < 1e-12f) return (float3)(0.0f, beam.z == 0.0f ? 0.0f : 1.0f, 0.0f);
    const float inverse = reciprocal_root(level2);
    return (float3)(-beam.y * inverse, beam.x * inverse, 0.0f);
}

/// RAYS_PER_BEAM rays a beam, one beam after the other.
kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void send_beams(SensorSettings settings, global const SensorPose* poses, global const SensorBeam* beams, global const BeamRay* beam_rays,
                global Ray* rays) {
    FOR_EACH_BEAM(i, settings) {
        const uint sensor = i / settings.beams;
        const SensorBeam beam = beams[i - sensor * settings.beams];
        const Frame3 frame = frame_at(&poses[sensor], beam.time);
        const float3 direction = (float3)(beam.x, beam.y, beam.z), along = turned(&frame, direction);
        Ray ray = {frame.origin.x, frame.origin.y, frame.origin.z, 0.0f, along.x, along.y, along.z, settings.farthest};
        if (RAYS_PER_BEAM == 1) {
            rays[i] = ray;
            continue;
        }
        const float3 beside = left_of(direction), left = turned(&frame, beside), up = turned(&frame, cross_product(direction, beside));
        for (uint k = 0; k < RAYS_PER_BEAM; ++k) {
            const float3 d = beam_rays[k].along * along + beam_rays[k].left * left + beam_rays[k].up * up;
            ray.dx = d.x, ray.dy = d.y, ray.dz = d.z;
            rays[i * RAYS_PER_BEAM + k] = ray;
        }
    }
}
