// Denoising of frames: finds the light that a pixel's surface had in the frame before (Schied et al. 2017, "Spatiotemporal
// Variance-Guided Filtering", section 4.1), and blends it with the new frame's.
#include "denoise/light.clh"
#include "shade/camera.clh"

/// Where the camera sees a point: pixels, x to the right and y down. Returns false where it sees no point. `distance`: as nearness.
static inline bool seen_at(FilterStep step, const CameraData* c, float3 point, float2* pixel, float* distance) {
    const float3 right = (float3)(c->right_x, c->right_y, c->right_z), up = (float3)(c->up_x, c->up_y, c->up_z);
    const float3 to = point - (float3)(c->x, c->y, c->z);
    const float ahead = dot_product(to, (float3)(c->forward_x, c->forward_y, c->forward_z));
    const ProjectionPlace at = place_in_any(c->projection, dot_product(to, right) / dot_product(right, right), dot_product(to, up) / dot_product(up, up), ahead,
                                            c->half_width, c->half_height);
    *pixel = (float2)(0.5f * (at.x + 1.0f) * (float)step.width - 0.5f, 0.5f * (1.0f - at.y) * (float)step.height - 0.5f);
    *distance = has_parallel_rays(c->projection) ? ahead : length_of(to);
    return at.seen != 0u;
}

/// The pixel's surface point.
static inline float3 point_of(FilterStep step, const CameraData* c, uint x, uint y, float nearness) {
    const float across = 2.0f * ((float)x + 0.5f) / (float)step.width - 1.0f, upwards = 1.0f - 2.0f * ((float)y + 0.5f) / (float)step.height;
    const Ray ray = camera_ray(*c, across, upwards, (float2)(0.5f));
    return (float3)(ray.ox, ray.oy, ray.oz) + (float3)(ray.dx, ray.dy, ray.dz) / nearness;
}

/// Whether two pixels show the same surface. Fast motion changes a normal's mean only at edges.
static inline bool is_same_surface(float4 now, float distance, float4 before) {
    return fabs(before.w * distance - 1.0f) < 0.05f && dot_product(now.xyz, before.xyz) > 0.8f * dot_product(now.xyz, now.xyz);
}

/// `result`: the old light and its variance, means over the four nearest pixels of the same surface; `ages`: from how many samples
/// it was gathered, 0 if there is none.
kernel void reproject(FilterStep step, CameraPair cameras, global const float4* surfaces, global const float4* light,
                      global const float4* old_surfaces, global const float4* old_light, global const float* old_ages,
                      global float4* result, global float* ages) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const float4 surface = pixel_at(step, surfaces, i);
    float4 sum = (float4)(0.0f);
    float total = 0.0f, age = 0.0f, distance;
    float2 at;
    if (has_light(pixel_at(step, light, i)) && surface.w > 0.0f &&
        seen_at(step, &cameras.before, point_of(step, &cameras.now, i % step.width, i / step.width, surface.w), &at, &distance)) {
        const float2 corner = floor(at), part = at - corner;
        for (int k = 0; k < 4; ++k) {
            const int x = (int)corner.x + (k & 1), y = (int)corner.y + (k >> 1);
            if (!(x >= 0 && y >= 0 && x < (int)step.width && y < (int)step.height)) continue;
            const uint there = (uint)(y * (int)step.width + x);
            const float4 before = pixel_at(step, old_light, there);
            if (!has_light(before) || !is_same_surface(surface, distance, pixel_at(step, old_surfaces, there))) continue;
            const float weight = (k & 1 ? part.x : 1.0f - part.x) * (k >> 1 ? part.y : 1.0f - part.y);
            total += weight, sum += weight * before, age += weight * old_ages[there];
        }
    }
    const bool found = total > 0.05f;
    set_pixel(step, result, i, found ? sum / total : (float4)(0.0f));
    ages[i] = found ? age / total : 0.0f;
}

/// Of a history whose mean over the neighbours differs from the new frame's by more than noise explains, none is kept: the light
/// has changed, as when a shadow moves. A frame of more than twice the `samples` of its history needs none. `most`: samples for which a history
/// counts at most.
kernel void blend_history(FilterStep step, float samples, float most, global const float4* surfaces, global const float2* slopes, global const float4* fresh,
                          global const float4* old, global const float* old_ages, global float4* result, global float* ages) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const float4 here = pixel_at(step, fresh, i);
    set_pixel(step, result, i, here);
    ages[i] = has_light(here) ? samples : 0.0f;
    if (!has_light(here) || 2.0f * old_ages[i] < samples) return;
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    const Pixel surface = pixel_of(pixel_at(step, surfaces, i));
    const float4 before = pixel_at(step, old, i);
    const float divisor = depth_divisor(surface, slopes[i]);
    float difference = 0.0f, variance = 1e-30f;
    for (int dy = -3; dy <= 3; ++dy)
        for (int dx = -3; dx <= 3; ++dx) {
            const uint at = neighbour(step, x + dx, y + dy);
            const float4 now = pixel_at(step, fresh, at), then = pixel_at(step, old, at);
            if (!has_light(now) || old_ages[at] == 0.0f) continue;
            const float weight = fading(surface_distance(surface, slopes[i], divisor, pixel_of(pixel_at(step, surfaces, at)), (float)dx, (float)dy));
            difference += weight * (luminance(now.xyz) - luminance(then.xyz));
            variance += weight * weight * (now.w + then.w);
        }
    const float deviations = fmax(difference * difference / variance - 4.0f, 0.0f);  // squared; four are common
    const float age = fmin(old_ages[i], most) * fading(deviations), share = samples / (age + samples);
    set_pixel(step, result, i, (float4)(lerp(before.xyz, here.xyz, share), (1.0f - share) * (1.0f - share) * before.w + share * share * here.w));
    ages[i] = age + samples;
}
