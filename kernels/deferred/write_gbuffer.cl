// The G-buffer: what deferred shading needs to know of the surface at a pixel, packed (claray/shared/gbuffer.h).
#include "claray/shared/gbuffer.h"
#include "claray/shared/path.h"
#include "claray/shared/lists/projections.h"
#include "claray/shared/types.h"
#include "shade/surface_at_hit.clh"

/// A value from 0 to 1 on the sRGB curve (IEC 61966-2-1), as a byte.
static inline uint srgb_byte(float linear) {
    const float x = clamp(linear, 0.0f, 1.0f);
    return (uint)(255.0f * (x <= 0.0031308f ? 12.92f * x : 1.055f * power_of(x, 1.0f / 2.4f) - 0.055f) + 0.5f);
}

/// Reversed depth: floats are densest at 0, where a perspective view's far distances crowd.
static inline float reversed_depth(const CameraData* camera, Ray ray, float t, float near, float far) {
    const float along = t * (ray.dx * camera->forward_x + ray.dy * camera->forward_y + ray.dz * camera->forward_z);
    return has_parallel_rays(camera->projection) ? 1.0f - along / far : near / along;  // mutant: reversed-depth
}

/// For the first `step.capacity` rays; `far` is the distance at which the depth of parallel rays is 0.
kernel void write_gbuffer(Step step, SCENE_PARAMETERS, global const Ray* rays, global const SceneHit* hits, float near, float far,
                          uint spherical, global GBufferPixel* pixels) {
    const FrameData* frame = &step.frame;
    const uint i = get_global_id(0);
    if (i >= step.capacity) return;
    const Hit hit = hit_of(hits[i] INSTANCE_BUFFERS);
    GBufferPixel pixel = {0u, CLARAY_NO_SURFACE, 0.0f};
    if (hit.primitive != CLARAY_MISS) {
        ShadingPoint at;
        surface_seen(frame, SCENE, rays[i], hits[i], &at);
        const float3 shading = at.surface.shading, albedo = albedo_of(&at.material);
        const UnitVector normal = {shading.x, shading.y, shading.z};
        pixel.albedo_material = srgb_byte(albedo.x) | srgb_byte(albedo.y) << 8 | srgb_byte(albedo.z) << 16 |
                                min(material_number_at(frame, tables, hit), 255u) << 24;
        pixel.normal = spherical ? claray_pack_spherical(normal) : claray_pack_octahedral(normal);
        pixel.depth = reversed_depth(&frame->camera, rays[i], hit.t, near, far);
    }
    pixels[i] = pixel;
}
