// Third pass of the denoiser. The variance that two halves of a pixel's samples tell is as noisy as its square; its mean over the
// same surface nearby is not. A single sample per pixel tells none: there the spread of the neighbours takes its place. That of
// gloss is known for each pixel. Pixels also get what was rejected from outliers of the same surface.
#include "denoise/pixels.clh"

#define MIRROR_TRUST 0.3f  // what a mirror shows has edges that no guide tells: the filter sees this part of its variance
#define SINGLE_DOUBT 2.0f  // the spread of single samples misses the rare bright ones
#define VARIANCE_RADIUS 3

#if CLARAY_CPU
static inline float16 trust_in16(PixelRun run, global const Guide* guides) {
    float trust[16];
    for (uint i = 0; i < 16; ++i) trust[i] = lerp(1.0f, MIRROR_TRUST, guides[run.first + min(i, run.count - 1)].mirrored);
    return vload16(0, trust);
}
#else
static inline float trust_in(PixelRun run, global const Guide* guides) { return lerp(1.0f, MIRROR_TRUST, guides[run.first].mirrored); }
#endif

/// A run of pixels per work-item.
kernel void estimate_variance(FilterStep step, uint single, global const float4* light, global const float4* rejected, global const float4* surfaces, global const float* weights,
                              global const float2* gloss, global const Guide* guides, global float2* slopes, global float4* result) {
    if (get_global_id(0) >= runs_per_row(step) * step.height) return;
    const PixelRun run = run_of(step, get_global_id(0));
    const CLARAY_LANES(Pixel) surface = CLARAY_LANES(read_pixel)(step, surfaces, run.x, run.y);
    CLARAY_VECTOR2 slope;
    slope.x = CLARAY_LANES(slope_of)(CLARAY_LANES(read_pixel)(step, surfaces, run.x - 1, run.y).w, surface.w, CLARAY_LANES(read_pixel)(step, surfaces, run.x + 1, run.y).w);
    slope.y = CLARAY_LANES(slope_of)(CLARAY_LANES(read_pixel)(step, surfaces, run.x, run.y - 1).w, surface.w, CLARAY_LANES(read_pixel)(step, surfaces, run.x, run.y + 1).w);
    CLARAY_LANES(write_pair)(run, slope, slopes);
    const CLARAY_LANES(Pixel) here = CLARAY_LANES(read_pixel)(step, light, run.x, run.y);
    const CLARAY_MASK lit = here.w >= 0.0f;
    if (!CLARAY_LANES(anywhere)(lit)) {
        CLARAY_LANES(write_pixel)(step, run, here, result);
        return;
    }
    const CLARAY_REAL divisor = CLARAY_LANES(depth_divisor)(surface, slope), none = (CLARAY_REAL)(0.0f);
    CLARAY_REAL total = none, first = none, second = none, variance = none;
    CLARAY_VECTOR handed = CLARAY_LANES(no_vector)();
    for (int dy = -VARIANCE_RADIUS; dy <= VARIANCE_RADIUS; ++dy)
        for (int dx = -VARIANCE_RADIUS; dx <= VARIANCE_RADIUS; ++dx) {
            const int x = run.x + dx, y = run.y + dy;
            const CLARAY_LANES(Pixel) there = CLARAY_LANES(read_pixel)(step, light, x, y);
            const CLARAY_MASK lit_there = there.w >= 0.0f;
            if (!CLARAY_LANES(anywhere)(lit_there)) continue;
            const CLARAY_LANES(Pixel) other = CLARAY_LANES(read_pixel)(step, surfaces, x, y);
            const CLARAY_VECTOR2 glossy = CLARAY_LANES(read_pair)(step, gloss, x, y);
            const CLARAY_REAL near = CLARAY_LANES(fading)(CLARAY_LANES(surface_distance)(surface, slope, divisor, other, (float)dx, (float)dy));
            const CLARAY_REAL weight = select(none, near * CLARAY_LANES(read_value)(step, weights, x, y), lit_there);
            if (dx != 0 || dy != 0) handed = CLARAY_LANES(plus)(handed, CLARAY_LANES(scaled)(near, CLARAY_LANES(read_pixel)(step, rejected, x, y).v));
            const CLARAY_REAL value = CLARAY_LANES(luminance)(there.v) - glossy.x;
            total += weight, first += weight * value, second += weight * value * value, variance += weight * (there.w - glossy.y);
        }
    const CLARAY_VECTOR2 glossy = CLARAY_LANES(read_pair)(step, gloss, run.x, run.y);
    const CLARAY_REAL mean = first / total, of_mean = variance / total;
    // Bright samples in both halves hide the noise of a pixel: what is far from the mean nearby counts as noisy, to a degree.
    // What a pixel gets from outliers is as uncertain as it is large; with more samples the variance around tells it.
    const CLARAY_REAL own = CLARAY_LANES(luminance)(here.v) - glossy.x - mean, spread = fmax(second / total - mean * mean, none);
    const CLARAY_REAL given = CLARAY_LANES(luminance)(handed) / total;
    const CLARAY_REAL noise = single ? SINGLE_DOUBT * fmax(spread, own * own) + given * given
                                     : fmax(fmax(of_mean, here.w - glossy.y), fmin(own * own, 4.0f * of_mean));
    CLARAY_LANES(Pixel) known;
    known.v = CLARAY_LANES(chosen)(here.v, CLARAY_LANES(plus)(here.v, CLARAY_LANES(vector_over)(handed, total)), lit);
    known.w = select(here.w, CLARAY_LANES(trust_in)(run, guides) * (noise + glossy.y), lit);
    CLARAY_LANES(write_pixel)(step, run, known, result);
}
