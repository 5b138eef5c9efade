// An edge-avoiding a-trous wavelet pass (Dammertz et al. 2010, "Edge-Avoiding A-Trous Wavelet Transform for fast Global
// Illumination Filtering"), guided by surfaces and by the variance of light (Schied et al. 2017, "Spatiotemporal
// Variance-Guided Filtering", section 4.4).
#include "denoise/pixels.clh"

#define LIGHT_TOLERANCE 6.0f  // of the squared difference of two pixels, in variances of both
#define ENOUGH_COMPANY 0.4f  // weight of the neighbours of the same surface, over that of the pixel itself

constant float spline[3] = {0.375f, 0.25f, 0.0625f};  // cubic B-spline

/// `kept`: the share of a pixel's own noise that is left after this pass and those before: the derivative of the filtered value by
/// the pixel's. It is the pixel's own weight, and more: the weights follow the pixel, since neighbours like it weigh more.
/// A run of pixels per work-item.
kernel void filter_light(FilterStep step, global const float4* light, global const float4* surfaces, global const float* weights, global const float2* slopes,
                         global float4* result, global float* kept) {
    if (get_global_id(0) >= runs_per_row(step) * step.height) return;
    const PixelRun run = run_of(step, get_global_id(0));
    const int spacing = (int)step.spacing;
    const CLARAY_LANES(Pixel) here = CLARAY_LANES(read_pixel)(step, light, run.x, run.y);
    const CLARAY_MASK lit = here.w >= 0.0f;
    if (!CLARAY_LANES(anywhere)(lit)) {
        CLARAY_LANES(write_pixel)(step, run, here, result);
        return;
    }
    const CLARAY_LANES(Pixel) surface = CLARAY_LANES(read_pixel)(step, surfaces, run.x, run.y);
    const CLARAY_REAL itself = CLARAY_LANES(product_of)(CLARAY_LANES(read_value)(step, weights, run.x, run.y), spline[0], spline[0]);
    const CLARAY_VECTOR2 slope = CLARAY_LANES(read_pair)(step, slopes, run.x, run.y);
    const CLARAY_REAL divisor = CLARAY_LANES(depth_divisor)(surface, slope), own = CLARAY_LANES(luminance)(here.v), none = (CLARAY_REAL)(0.0f);
    CLARAY_REAL total = none, any_total = none;  // any: also of other surfaces
    CLARAY_REAL first = none, second = none;     // moments of the difference
    CLARAY_LANES(Pixel) sum = {CLARAY_LANES(no_vector)(), none}, any_sum = sum;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const int x = run.x + dx * spacing, y = run.y + dy * spacing;
            const CLARAY_LANES(Pixel) there = CLARAY_LANES(read_pixel)(step, light, x, y);
            const CLARAY_MASK lit_there = there.w >= 0.0f;  // where not, `brighter` may be -INFINITY
            if (!CLARAY_LANES(anywhere)(lit_there)) continue;
            const CLARAY_LANES(Pixel) other = CLARAY_LANES(read_pixel)(step, surfaces, x, y);
            const CLARAY_REAL difference = CLARAY_LANES(luminance)(there.v) - own;
            const CLARAY_REAL apart = CLARAY_LANES(surface_distance)(surface, slope, divisor, other, (float)(dx * spacing), (float)(dy * spacing));
            const CLARAY_REAL brighter = difference * difference / (LIGHT_TOLERANCE * (here.w + there.w) + 1e-30f);
            const CLARAY_REAL near = CLARAY_LANES(product_of)(CLARAY_LANES(read_value)(step, weights, x, y), spline[abs(dx)], spline[abs(dy)]);
            const CLARAY_REAL weight = select(none, near * CLARAY_LANES(fading)(apart + brighter), lit_there);
            total += weight;
            first += weight * difference, second += weight * difference * difference;
            sum.v = CLARAY_LANES(plus)(sum.v, CLARAY_LANES(scaled)(weight, there.v)), sum.w += weight * weight * there.w;
            if (step.spacing != 1u) continue;
            const CLARAY_REAL any = select(none, near * CLARAY_LANES(fading)(brighter), lit_there);
            any_total += any;
            any_sum.v = CLARAY_LANES(plus)(any_sum.v, CLARAY_LANES(scaled)(any, there.v)), any_sum.w += any * any * there.w;
        }
    const CLARAY_REAL shift = first / total, spread = fmax(second / total - shift * shift, none);
    CLARAY_REAL derivative = fmin(itself / total + spread / (LIGHT_TOLERANCE * here.w + 1e-30f), (CLARAY_REAL)(1.0f));
    if (step.spacing != 1u) derivative *= CLARAY_LANES(read_value)(step, kept, run.x, run.y);
    CLARAY_LANES(write_value)(run, derivative, kept);
    // A pixel at the border of two surfaces resembles neither: without neighbours that resemble it, its noise would remain. The first
    // pass then takes light of all surfaces.
    if (step.spacing == 1u) {
        const CLARAY_REAL company = clamp((total / itself - 1.0f) / ENOUGH_COMPANY, 0.0f, 1.0f);
        total = CLARAY_LANES(blend)(any_total, total, company);
        sum.v = CLARAY_LANES(blend_vectors)(any_sum.v, sum.v, company), sum.w = CLARAY_LANES(blend)(any_sum.w, sum.w, company);
    }
    CLARAY_LANES(Pixel) filtered;
    filtered.v = CLARAY_LANES(chosen)(here.v, CLARAY_LANES(vector_over)(sum.v, total), lit);
    filtered.w = select(here.w, sum.w / (total * total), lit);
    CLARAY_LANES(write_pixel)(step, run, filtered, result);
}
