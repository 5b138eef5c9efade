// Second pass of the denoiser: bounds the light of outliers, such as fireflies. The passes that follow could not remove what no
// neighbour resembles.
#include "denoise/light.clh"
#if CLARAY_CPU
#include "denoise/light_sixteen.clh"
#endif

/// `most` is the brightest of the neighbours. A dark surface may reflect as much radiance as they do: then its light is brighter.
/// `rejected`: the radiance that is taken away, which estimate_variance hands to the neighbours.
#if CLARAY_CPU
/// Sixteen pixels of a row per work-item.
kernel void reject_outliers(FilterStep step, uint single, global const float4* light, global const float* weights, global float4* result,
                            global float4* rejected) {
    if (get_global_id(0) >= runs_per_row(step) * step.height) return;
    const PixelRun run = run_of(step, get_global_id(0));
    const Pixels16 here = read_pixels16(step, light, run.x, run.y);
    const float16 weight = read_values16(step, weights, run.x, run.y), none = (float16)(0.0f);
    float16 most = none;
    for (int dy = -OUTLIER_RADIUS; dy <= OUTLIER_RADIUS; ++dy)
        for (int dx = -OUTLIER_RADIUS; dx <= OUTLIER_RADIUS; ++dx) {
            const int x = run.x + dx, y = run.y + dy;
            const Pixels16 there = read_pixels16(step, light, x, y);
            const float16 bright = luminances16(there.v) * fmax(1.0f, read_values16(step, weights, x, y) / weight);
            most = fmax(most, select(none, bright, (there.w >= 0.0f) & ~is_itself16(step, run, dx, dy)));
        }
    // As in `unsupported`.
    const float16 own = luminances16(here.v), excess = fmax(own - MOST_OVER_NEIGHBOURS * most, 0.0f), deviation = sqrt(fmax(here.w, 0.0f));
    const float16 noise = select(none, clamp(3.0f * deviation - excess, none, excess), deviation >= LEAST_DEVIATION * own);
    const float16 removed = single ? excess : noise;
    const float16 share = select(none, removed / own, (here.w >= 0.0f) & (removed > 0.0f)), left = 1.0f - share;
    const Pixels16 bounded = {scaled16(left, here.v), here.w * left * left}, lost = {scaled16(share * weight, here.v), none};
    write_pixels16(step, run, bounded, result), write_pixels16(step, run, lost, rejected);
}
#else
kernel void reject_outliers(FilterStep step, uint single, global const float4* light, global const float* weights, global float4* result,
                            global float4* rejected) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    const float4 here = light[i];
    float most = 0.0f;
    for (int dy = -OUTLIER_RADIUS; dy <= OUTLIER_RADIUS; ++dy)
        for (int dx = -OUTLIER_RADIUS; dx <= OUTLIER_RADIUS; ++dx) {
            const uint at = neighbour(step, x + dx, y + dy);
            const float4 there = light[at];
            if (at != i && has_light(there)) most = fmax(most, luminance(there.xyz) * fmax(1.0f, weights[at] / weights[i]));
        }
    const float own = luminance(here.xyz), removed = has_light(here) ? unsupported(own, most, here.w, single) : 0.0f;
    const float share = removed > 0.0f ? removed / own : 0.0f, left = 1.0f - share;
    result[i] = (float4)(left * here.xyz, left * left * here.w);
    rejected[i] = (float4)(share * weights[i] * here.xyz, 0.0f);
}
#endif
