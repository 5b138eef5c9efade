// An edge-avoiding a-trous wavelet pass (Dammertz et al. 2010, "Edge-Avoiding A-Trous Wavelet Transform for fast Global
// Illumination Filtering"), guided by surfaces and by the variance of light (Schied et al. 2017, "Spatiotemporal
// Variance-Guided Filtering", section 4.4).
#include "denoise/light.clh"
#if CLARAY_CPU
#include "denoise/light_sixteen.clh"
#endif

#define LIGHT_TOLERANCE 6.0f  // of the squared difference of two pixels, in variances of both
#define ENOUGH_COMPANY 0.4f  // weight of the neighbours of the same surface, over that of the pixel itself

constant float spline[3] = {0.375f, 0.25f, 0.0625f};  // cubic B-spline

/// `kept`: the share of a pixel's own noise that is left after this pass and those before: the derivative of the filtered value by
/// the pixel's. It is the pixel's own weight, and more: the weights follow the pixel, since neighbours like it weigh more.
#if CLARAY_CPU
/// Sixteen pixels of a row per work-item.
kernel void filter_light(FilterStep step, global const float4* light, global const float4* surfaces, global const float* weights, global const float2* slopes,
                         global float4* result, global float* kept) {
    if (get_global_id(0) >= runs_per_row(step) * step.height) return;
    const PixelRun run = run_of(step, get_global_id(0));
    const int spacing = (int)step.spacing;
    const Pixels16 here = read_pixels16(step, light, run.x, run.y), surface = read_pixels16(step, surfaces, run.x, run.y);
    const int16 lit = here.w >= 0.0f;
    if (!movemask16(lit)) {
        write_pixels16(step, run, here, result);
        return;
    }
    const float16 itself = read_values16(step, weights, run.x, run.y) * (spline[0] * spline[0]), own = luminances16(here.v);
    float16 slope_x, slope_y;
    read_pairs16(step, slopes, run.x, run.y, &slope_x, &slope_y);
    const float16 inverse_tolerance = 1.0f / tolerances16(surface, slope_x, slope_y), none = (float16)(0.0f);
    float16 total = none, any_total = none, first = none, second = none;
    Pixels16 sum = {{none, none, none}, none}, any_sum = sum;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const int x = run.x + dx * spacing, y = run.y + dy * spacing;
            const Pixels16 there = read_pixels16(step, light, x, y), other = read_pixels16(step, surfaces, x, y);
            const float16 difference = luminances16(there.v) - own;
            const float16 apart = surface_distances16(surface, slope_x, slope_y, inverse_tolerance, other, (float)(dx * spacing), (float)(dy * spacing));
            const float16 brighter = difference * difference / (LIGHT_TOLERANCE * (here.w + there.w) + 1e-30f);
            const float16 near = read_values16(step, weights, x, y) * (spline[abs(dx)] * spline[abs(dy)]);
            const int16 lit_there = there.w >= 0.0f;  // where not, `brighter` may be -INFINITY
            const float16 weight = select(none, near * fadings16(apart + brighter), lit_there);
            total += weight;
            first += weight * difference, second += weight * difference * difference;
            sum.v = plus16(sum.v, scaled16(weight, there.v)), sum.w += weight * weight * there.w;
            if (step.spacing != 1u) continue;
            const float16 any = select(none, near * fadings16(brighter), lit_there);
            any_total += any;
            any_sum.v = plus16(any_sum.v, scaled16(any, there.v)), any_sum.w += any * any * there.w;
        }
    const float16 shift = first / total, spread = fmax(second / total - shift * shift, 0.0f);
    float16 derivative = fmin(itself / total + spread / (LIGHT_TOLERANCE * here.w + 1e-30f), 1.0f);
    if (step.spacing != 1u) derivative *= read_values16(step, kept, run.x, run.y);
    write_values16(run, derivative, kept);
    if (step.spacing == 1u) {  // as below
        const float16 company = clamp((total / itself - 1.0f) / ENOUGH_COMPANY, 0.0f, 1.0f), alone = 1.0f - company;
        total = alone * any_total + company * total;
        sum.v = plus16(scaled16(alone, any_sum.v), scaled16(company, sum.v)), sum.w = alone * any_sum.w + company * sum.w;
    }
    const Pixels16 filtered = {selected16(here.v, scaled16(1.0f / total, sum.v), lit), select(here.w, sum.w / (total * total), lit)};
    write_pixels16(step, run, filtered, result);
}
#else
kernel void filter_light(FilterStep step, global const float4* light, global const float4* surfaces, global const float* weights, global const float2* slopes,
                         global float4* result, global float* kept) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const int x = (int)(i % step.width), y = (int)(i / step.width), spacing = (int)step.spacing;
    const float4 here = light[i], surface = surfaces[i];
    if (!has_light(here)) {
        result[i] = here;
        return;
    }
    const float2 slope = slopes[i];
    const float own = luminance(here.xyz);
    float total = 0.0f, any_total = 0.0f;  // any: also of other surfaces
    float first = 0.0f, second = 0.0f;        // moments of the difference
    float4 sum = (float4)(0.0f), any_sum = (float4)(0.0f);
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const uint at = neighbour(step, x + dx * spacing, y + dy * spacing);
            const float4 there = light[at];
            if (!has_light(there)) continue;
            const float difference = luminance(there.xyz) - own;
            const float apart = surface_distance(surface, slope, surfaces[at], (float)(dx * spacing), (float)(dy * spacing));
            const float brighter = difference * difference / (LIGHT_TOLERANCE * (here.w + there.w) + 1e-30f);
            const float near = weights[at] * spline[abs(dx)] * spline[abs(dy)];
            const float weight = near * fading(apart + brighter), any = near * fading(brighter);
            total += weight, any_total += any;
            first += weight * difference, second += weight * difference * difference;
            sum += (float4)(weight * there.xyz, weight * weight * there.w);
            any_sum += (float4)(any * there.xyz, any * any * there.w);
        }
    const float itself = weights[i] * spline[0] * spline[0], shift = first / total;
    const float spread = fmax(second / total - shift * shift, 0.0f);
    const float derivative = fmin(itself / total + spread / (LIGHT_TOLERANCE * here.w + 1e-30f), 1.0f);
    kept[i] = step.spacing == 1u ? derivative : kept[i] * derivative;
    // A pixel at the border of two surfaces resembles neither: without neighbours that resemble it, its noise would remain. The first
    // pass then takes light of all surfaces.
    if (step.spacing == 1u) {
        const float company = clamp((total / itself - 1.0f) / ENOUGH_COMPANY, 0.0f, 1.0f);
        total = mix(any_total, total, company), sum = mix(any_sum, sum, company);
    }
    result[i] = (float4)(sum.xyz / total, sum.w / (total * total));
}
#endif
