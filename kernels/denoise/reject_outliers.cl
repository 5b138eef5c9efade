// Second pass of the denoiser: bounds the light of outliers, such as fireflies. The passes that follow could not remove what no
// neighbour resembles.
#include "denoise/pixels.clh"

/// `most` is the brightest of the neighbours. A dark surface may reflect as much radiance as they do: then its light is brighter.
/// `rejected`: the radiance that is taken away, which estimate_variance hands to the neighbours.
/// A run of pixels per work-item.
kernel void reject_outliers(FilterStep step, uint single, global const float4* light, global const float* weights, global float4* result,
                            global float4* rejected) {
    if (get_global_id(0) >= runs_per_row(step) * step.height) return;
    const PixelRun run = run_of(step, get_global_id(0));
    const CLARAY_LANES(Pixel) here = CLARAY_LANES(read_pixel)(step, light, run.x, run.y);
    const CLARAY_REAL weight = CLARAY_LANES(read_value)(step, weights, run.x, run.y), none = (CLARAY_REAL)(0.0f);
    CLARAY_REAL most = none;
    for (int dy = -OUTLIER_RADIUS; dy <= OUTLIER_RADIUS; ++dy)
        for (int dx = -OUTLIER_RADIUS; dx <= OUTLIER_RADIUS; ++dx) {
            const int x = run.x + dx, y = run.y + dy;
            const CLARAY_LANES(Pixel) there = CLARAY_LANES(read_pixel)(step, light, x, y);
            const CLARAY_MASK counts = there.w >= 0.0f && !CLARAY_LANES(is_itself)(step, run, dx, dy);
            if (!CLARAY_LANES(anywhere)(counts)) continue;
            const CLARAY_REAL brighter = fmax((CLARAY_REAL)(1.0f), CLARAY_LANES(read_value)(step, weights, x, y) / weight);
            most = fmax(most, select(none, CLARAY_LANES(luminance)(there.v) * brighter, counts));
        }
    const CLARAY_REAL own = CLARAY_LANES(luminance)(here.v);
    const CLARAY_REAL removed = select(none, CLARAY_LANES(unsupported)(own, most, here.w, single), here.w >= 0.0f);
    const CLARAY_REAL share = select(none, removed / own, removed > 0.0f), left = 1.0f - share;
    const CLARAY_LANES(Pixel) bounded = {CLARAY_LANES(scaled)(left, here.v), CLARAY_LANES(product_of)(left, left, here.w)};
    const CLARAY_LANES(Pixel) lost = {CLARAY_LANES(scaled)(share * weight, here.v), none};
    CLARAY_LANES(write_pixel)(step, run, bounded, result);
    CLARAY_LANES(write_pixel)(step, run, lost, rejected);
}
