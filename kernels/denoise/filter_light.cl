// An edge-avoiding a-trous wavelet pass (Dammertz et al. 2010, "Edge-Avoiding A-Trous Wavelet Transform for fast Global
// Illumination Filtering"), guided by surfaces and by the variance of light (Schied et al. 2017, "Spatiotemporal
// Variance-Guided Filtering", section 4.4).
#include "denoise/light.clh"

#ifndef LIGHT_TOLERANCE
#define LIGHT_TOLERANCE 6.0f  // of the squared difference of two pixels, in variances of both
#endif
#ifndef ENOUGH_COMPANY
#define ENOUGH_COMPANY 0.4f  // weight of the neighbours of the same surface, over that of the pixel itself
#endif

constant float spline[3] = {0.375f, 0.25f, 0.0625f};  // cubic B-spline

/// `kept`: the share of a pixel's own noise that is left after this pass and those before: the derivative of the filtered value by
/// the pixel's. It is the pixel's own weight, and more: the weights follow the pixel, since neighbours like it weigh more.
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
            const float difference = luminance(there.xyz) - own;
            const float apart = surface_distance(surface, slope, surfaces[at], (float)(dx * spacing), (float)(dy * spacing));
            const float brighter = difference * difference / (LIGHT_TOLERANCE * (here.w + there.w) + 1e-30f);
            const float near = has_light(there) ? weights[at] * spline[abs(dx)] * spline[abs(dy)] : 0.0f;
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
