// Last pass of the denoiser: takes from the filtered light only as much as the noise warrants, and puts albedo and glow back.
#include "denoise/light.clh"

#define BLEND_RADIUS 3
#define BLEND_PIXELS ((2 * BLEND_RADIUS + 1) * (2 * BLEND_RADIUS + 1))
#define DETAIL 4.0f
#define COMMON_DETAIL 0.3f  // as at borders of two surfaces
#define REMOVED 0.75f  // variances are maxima of two estimates, and therefore too large

/// The variance that albedo and glow of few rays bring into filtered light; the pixel's own samples have none of it.
static inline float variance_of_guide(const Guide* g, float3 filtered) {
    if (g->complete) return 0.0f;
    const float bright = luminance(filtered), scale = luminance((float3)(g->albedo_r, g->albedo_g, g->albedo_b));
    return (g->albedo_variance * bright * bright + g->glow_variance) / (scale * scale);
}

/// What is left of that share where the pixel's rays met surfaces of different normals, whose mean is short: the filter cannot tell details
/// smaller than a pixel from noise, and neighbours have others. With few samples noise is worse.
static inline float share_beside_details(const Guide* g, float doubt) {
    const float3 normal = (float3)(g->normal_x, g->normal_y, g->normal_z);
    return clamp(1.0f - DETAIL * fmax(1.0f - COMMON_DETAIL - dot_product(normal, normal), 0.0f) * (1.0f - doubt / CLARAY_MOST_DOUBT), 0.0f, 1.0f);
}

/// Of each pixel: the variance of its noise, the squared change that noise warrants, the squared change, and the variance of its guide; colours are
/// summed. `doubt`: how many times the variances count beyond the noise that was removed.
kernel void measure_changes(FilterStep step, float doubt, global const float4* noisy, global const float4* filtered, global const float* kept,
                            global const Guide* guides, global float4* changes) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const float4 before = pixel_at(step, noisy, i);
    changes[i] = (float4)(0.0f);
    if (!has_light(before)) return;
    const float3 after = pixel_at(step, filtered, i).xyz, difference = before.xyz - after;
    // Noise is taken to have the colour of light. By luminance alone, a change of colour would count as none.
    const float bright = luminance(after), colors = bright > 0.0f ? dot_product(after, after) / (bright * bright) : 3.0f;
    const float noise = before.w * colors, removed = REMOVED * (1.0f - kept[i]) * noise;
    const Guide g = guides[i];
    changes[i] = (float4)(noise, removed + doubt * noise, dot_product(difference, difference), variance_of_guide(&g, after));
}

/// The share of the filtered light in the mixture of least expected squared error, which is E[noise removed] / E[change], the changes
/// squared (Stein 1981, "Estimation of the mean of a multivariate normal distribution"; expectations over the neighbours).
/// Where noise vanishes, so does the filter. The share is less where the guide is noisier than the pixel.
static inline float share_of_filtered(FilterStep step, uint i, float variance, global const float4* changes) {
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    float4 sum = (float4)(0.0f);
    float of_guides = 0.0f;
    for (int dy = -BLEND_RADIUS; dy <= BLEND_RADIUS; ++dy)
        for (int dx = -BLEND_RADIUS; dx <= BLEND_RADIUS; ++dx) sum += changes[neighbour(step, x + dx, y + dy)];
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) of_guides += changes[neighbour(step, x + dx, y + dy)].w / 9.0f;
    const float noise = sum.x, warranted = sum.y, change = sum.z, own = fmax(variance, 0.25f * noise / BLEND_PIXELS) + 1e-30f;
    return (change > warranted ? warranted / change : 1.0f) * own / (own + of_guides);
}

/// The light of a pixel that has found nothing alike to be filtered with, and is brighter than the filtered light of all its neighbours.
static inline float3 bounded_light(FilterStep step, uint i, uint single, float3 light, float variance, global const float4* filtered) {
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    const float own = luminance(light);
    float most = 0.0f;
    for (int dy = -OUTLIER_RADIUS; dy <= OUTLIER_RADIUS; ++dy)
        for (int dx = -OUTLIER_RADIUS; dx <= OUTLIER_RADIUS; ++dx) {
            const uint at = neighbour(step, x + dx, y + dy);
            const float4 there = pixel_at(step, filtered, at);
            if (at != i && has_light(there)) most = fmax(most, luminance(there.xyz));
            if (own <= MOST_OVER_NEIGHBOURS * most) return light;  // almost all pixels
        }
    const float removed = unsupported(own, most, variance, single);
    return removed > 0.0f ? light * (1.0f - removed / own) : light;
}

/// `noisy`: the pixels and their variances. `single`: those are no estimates, and all is taken from `filtered`.
kernel void modulate(FilterStep step, uint single, float doubt, global const float4* noisy, global const float4* filtered,
                     global const float4* changes, global const Guide* guides, global float* image) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const float4 before = pixel_at(step, noisy, i);
    const bool lit = has_light(before);
    const Guide g = guides[i];
    float share = 1.0f;
    if (!single && lit) share = share_beside_details(&g, doubt) * share_of_filtered(step, i, before.w, changes);
    float3 light = lerp(before.xyz, pixel_at(step, filtered, i).xyz, share);
    if (lit) light = bounded_light(step, i, single, light, before.w, filtered);
    const float3 albedo = lit ? (float3)(g.albedo_r, g.albedo_g, g.albedo_b) : (float3)(1.0f);
    vstore3(light * albedo + (float3)(g.glow_r, g.glow_g, g.glow_b), i, image);
}
