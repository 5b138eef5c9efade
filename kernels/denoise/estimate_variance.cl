// Second pass of the denoiser. The variance that two halves of a pixel's samples tell is as noisy as its square; its mean over the
// same surface nearby is not. A single sample per pixel tells none: there the spread of the neighbours takes its place. That of
// gloss is known for each pixel.
#include "denoise/light.clh"

#ifndef MIRROR_TRUST
#define MIRROR_TRUST 0.3f  // what a mirror shows has edges that no guide tells: the filter sees this part of its variance
#endif
#ifndef VARIANCE_RADIUS
#define VARIANCE_RADIUS 3
#endif

/// The slope of nearness along one axis: the smaller difference, since the other may cross an edge.
static inline float slope_of(float before, float here, float after) {
    const float left = here - before, right = after - here;
    return fabs(left) < fabs(right) ? left : right;
}

kernel void estimate_variance(FilterStep step, uint single, global const float4* light, global const float4* surfaces, global const float* weights,
                              global const float2* gloss, global const Guide* guides, global float2* slopes, global float4* result) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    const float4 surface = surfaces[i];
    const float2 slope = (float2)(
        slope_of(surfaces[neighbour(step, x - 1, y)].w, surface.w, surfaces[neighbour(step, x + 1, y)].w),
        slope_of(surfaces[neighbour(step, x, y - 1)].w, surface.w, surfaces[neighbour(step, x, y + 1)].w));
    slopes[i] = slope;
    const float4 here = light[i];
    if (!has_light(here)) {
        result[i] = here;
        return;
    }
    float total = 0.0f, first = 0.0f, second = 0.0f, variance = 0.0f;
    for (int dy = -VARIANCE_RADIUS; dy <= VARIANCE_RADIUS; ++dy)
        for (int dx = -VARIANCE_RADIUS; dx <= VARIANCE_RADIUS; ++dx) {
            const uint at = neighbour(step, x + dx, y + dy);
            const float4 there = light[at];
            if (!has_light(there)) continue;
            const float weight = weights[at] * fading(surface_distance(surface, slope, surfaces[at], (float)dx, (float)dy));
            const float value = luminance(there.xyz) - gloss[at].x;
            total += weight, first += weight * value, second += weight * value * value, variance += weight * (there.w - gloss[at].y);
        }
    const float mean = first / total;
    const float own = luminance(here.xyz) - gloss[i].x - mean, spread = fmax(second / total - mean * mean, 0.0f);
    // Bright samples in both halves hide the noise of a pixel: what is far from the mean nearby counts as noisy, to a degree.
    const float noise = fmax(fmax(variance / total, here.w - gloss[i].y), fmin(own * own, 4.0f * variance / total));
    const float trusted = mix(1.0f, MIRROR_TRUST, guides[i].mirrored);
    result[i] = (float4)(here.xyz, trusted * ((single ? fmax(spread, own * own) : noise) + gloss[i].y));
}
