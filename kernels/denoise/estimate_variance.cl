// Third pass of the denoiser. The variance that two halves of a pixel's samples tell is as noisy as its square; its mean over the
// same surface nearby is not. A single sample per pixel tells none: there the spread of the neighbours takes its place. That of
// gloss is known for each pixel. Pixels also get what was rejected from outliers of the same surface.
#include "denoise/light.clh"
#if CLARAY_CPU
#include "denoise/light_sixteen.clh"
#endif

#define MIRROR_TRUST 0.3f  // what a mirror shows has edges that no guide tells: the filter sees this part of its variance
#define SINGLE_DOUBT 2.0f  // the spread of single samples misses the rare bright ones
#define VARIANCE_RADIUS 3

/// The slope of nearness along one axis: the smaller difference, since the other may cross an edge.
static inline float slope_of(float before, float here, float after) {
    const float left = here - before, right = after - here;
    return fabs(left) < fabs(right) ? left : right;
}

#if CLARAY_CPU
static inline float16 slopes_of16(float16 before, float16 here, float16 after) {
    const float16 left = here - before, right = after - here;
    return select(right, left, fabs(left) < fabs(right));
}

/// Sixteen pixels of a row per work-item.
kernel void estimate_variance(FilterStep step, uint single, global const float4* light, global const float4* rejected, global const float4* surfaces, global const float* weights,
                              global const float2* gloss, global const Guide* guides, global float2* slopes, global float4* result) {
    if (get_global_id(0) >= runs_per_row(step) * step.height) return;
    const PixelRun run = run_of(step, get_global_id(0));
    const Pixels16 surface = read_pixels16(step, surfaces, run.x, run.y), here = read_pixels16(step, light, run.x, run.y);
    const float16 slope_x = slopes_of16(read_pixels16(step, surfaces, run.x - 1, run.y).w, surface.w, read_pixels16(step, surfaces, run.x + 1, run.y).w);
    const float16 slope_y = slopes_of16(read_pixels16(step, surfaces, run.x, run.y - 1).w, surface.w, read_pixels16(step, surfaces, run.x, run.y + 1).w);
    float of_x[16], of_y[16], trust[16];
    vstore16(slope_x, 0, of_x), vstore16(slope_y, 0, of_y);
    for (uint i = 0; i < run.count; ++i) slopes[run.first + i] = (float2)(of_x[i], of_y[i]);
    if (!movemask16(here.w >= 0.0f)) {
        write_pixels16(step, run, here, result);
        return;
    }
    for (uint i = 0; i < 16; ++i) trust[i] = mix(1.0f, MIRROR_TRUST, guides[run.first + min(i, run.count - 1)].mirrored);
    const float16 inverse_tolerance = 1.0f / tolerances16(surface, slope_x, slope_y), none = (float16)(0.0f);
    float16 total = none, first = none, second = none, variance = none, glossy, gloss_variance;
    Vectors handed = {none, none, none};
    for (int dy = -VARIANCE_RADIUS; dy <= VARIANCE_RADIUS; ++dy)
        for (int dx = -VARIANCE_RADIUS; dx <= VARIANCE_RADIUS; ++dx) {
            const int x = run.x + dx, y = run.y + dy;
            const Pixels16 there = read_pixels16(step, light, x, y), other = read_pixels16(step, surfaces, x, y);
            read_pairs16(step, gloss, x, y, &glossy, &gloss_variance);
            const float16 near = fadings16(surface_distances16(surface, slope_x, slope_y, inverse_tolerance, other, (float)dx, (float)dy));
            const float16 weight = select(none, near * read_values16(step, weights, x, y), there.w >= 0.0f);
            if (dx != 0 || dy != 0) handed = plus16(handed, scaled16(near, read_pixels16(step, rejected, x, y).v));
            const float16 value = luminances16(there.v) - glossy;
            total += weight, first += weight * value, second += weight * value * value, variance += weight * (there.w - gloss_variance);
        }
    read_pairs16(step, gloss, run.x, run.y, &glossy, &gloss_variance);
    const float16 mean = first / total, of_mean = variance / total;
    const float16 own = luminances16(here.v) - glossy - mean, spread = fmax(second / total - mean * mean, 0.0f);
    const float16 given = luminances16(handed) / total;
    const float16 noise = single ? SINGLE_DOUBT * fmax(spread, own * own) + given * given : fmax(fmax(of_mean, here.w - gloss_variance), fmin(own * own, 4.0f * of_mean));
    const Pixels16 known = {selected16(here.v, plus16(here.v, scaled16(1.0f / total, handed)), here.w >= 0.0f), select(here.w, vload16(0, trust) * (noise + gloss_variance), here.w >= 0.0f)};
    write_pixels16(step, run, known, result);
}
#else
kernel void estimate_variance(FilterStep step, uint single, global const float4* light, global const float4* rejected, global const float4* surfaces, global const float* weights,
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
    float3 handed = (float3)(0.0f);
    for (int dy = -VARIANCE_RADIUS; dy <= VARIANCE_RADIUS; ++dy)
        for (int dx = -VARIANCE_RADIUS; dx <= VARIANCE_RADIUS; ++dx) {
            const uint at = neighbour(step, x + dx, y + dy);
            const float4 there = light[at];
            if (!has_light(there)) continue;
            const float near = fading(surface_distance(surface, slope, surfaces[at], (float)dx, (float)dy)), weight = near * weights[at];
            if (dx != 0 || dy != 0) handed += near * rejected[at].xyz;
            const float value = luminance(there.xyz) - gloss[at].x;
            total += weight, first += weight * value, second += weight * value * value, variance += weight * (there.w - gloss[at].y);
        }
    const float mean = first / total;
    const float own = luminance(here.xyz) - gloss[i].x - mean, spread = fmax(second / total - mean * mean, 0.0f);
    // Bright samples in both halves hide the noise of a pixel: what is far from the mean nearby counts as noisy, to a degree.
    // What a pixel gets from outliers is as uncertain as it is large; with more samples the variance around tells it.
    const float given = luminance(handed) / total;
    const float noise = fmax(fmax(variance / total, here.w - gloss[i].y), fmin(own * own, 4.0f * variance / total));
    const float trusted = mix(1.0f, MIRROR_TRUST, guides[i].mirrored);
    result[i] = (float4)(here.xyz + handed / total, trusted * ((single ? SINGLE_DOUBT * fmax(spread, own * own) + given * given : noise) + gloss[i].y));
}
#endif
