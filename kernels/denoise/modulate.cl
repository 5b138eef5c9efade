// Last pass of the denoiser: takes from the filtered light only as much as the noise warrants, and puts albedo and glow back.
#include "denoise/light.clh"

#define BLEND_RADIUS 3
#define BLEND_PIXELS ((2 * BLEND_RADIUS + 1) * (2 * BLEND_RADIUS + 1))
#define DETAIL 4.0f
#define COMMON_DETAIL 0.3f  // as at borders of two surfaces
#define REMOVED 0.75f  // variances are maxima of two estimates, and therefore too large

/// The variance that albedo and glow of few rays bring into filtered light; the pixel's own samples have none of it.
static inline float variance_of_guide(const Guide* g, float3 filtered) {
    const float bright = luminance(filtered), scale = luminance((float3)(g->albedo_r, g->albedo_g, g->albedo_b));
    return (g->albedo_variance * bright * bright + g->glow_variance) / (scale * scale);
}

/// What is left of that share where the pixel's rays met surfaces of different normals, whose mean is short: the filter cannot tell details
/// smaller than a pixel from noise, and neighbours have others. With few samples noise is worse.
static inline float share_beside_details(const Guide* g, float doubt) {
    const float3 normal = (float3)(g->normal_x, g->normal_y, g->normal_z);
    return clamp(1.0f - DETAIL * fmax(1.0f - COMMON_DETAIL - dot(normal, normal), 0.0f) * (1.0f - doubt / CLARAY_MOST_DOUBT), 0.0f, 1.0f);
}

/// The share of the filtered light in the mixture of least expected squared error, which is E[noise removed] / E[change], the changes
/// squared (Stein 1981, "Estimation of the mean of a multivariate normal distribution"; expectations over the neighbours).
/// Where noise vanishes, so does the filter. `doubt`: how many times the variances count beyond that. The share is less where the
/// guide is noisier than the pixel.
static inline float share_of_filtered(FilterStep step, uint i, float doubt, global const float4* noisy, global const float4* filtered,
                                      global const float* kept, global const Guide* guides) {
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    float noise = 0.0f, removed = 0.0f, change = 0.0f, of_guides = 0.0f;
    for (int dy = -BLEND_RADIUS; dy <= BLEND_RADIUS; ++dy)
        for (int dx = -BLEND_RADIUS; dx <= BLEND_RADIUS; ++dx) {
            const uint at = neighbour(step, x + dx, y + dy);
            const float4 before = noisy[at];
            if (!has_light(before)) continue;
            const float3 after = filtered[at].xyz, difference = before.xyz - after;
            // Noise is taken to have the colour of light. By luminance alone, a change of colour would count as none.
            const float bright = luminance(after), colors = bright > 0.0f ? dot(after, after) / (bright * bright) : 3.0f;
            noise += before.w * colors, removed += REMOVED * (1.0f - kept[at]) * before.w * colors;
            change += dot(difference, difference);
            if (abs(dx) > 1 || abs(dy) > 1) continue;
            const Guide g = guides[at];
            of_guides += variance_of_guide(&g, after) / 9.0f;
        }
    const float warranted = removed + doubt * noise, own = fmax(noisy[i].w, 0.25f * noise / BLEND_PIXELS) + 1e-30f;
    return (change > warranted ? warranted / change : 1.0f) * own / (own + of_guides);
}

/// The light of a pixel that has found nothing alike to be filtered with, and is brighter than the filtered light of all its neighbours.
static inline float3 bounded_light(FilterStep step, uint i, uint single, float3 light, float variance, global const float4* filtered) {
    const int x = (int)(i % step.width), y = (int)(i / step.width);
    float most = 0.0f;
    for (int dy = -OUTLIER_RADIUS; dy <= OUTLIER_RADIUS; ++dy)
        for (int dx = -OUTLIER_RADIUS; dx <= OUTLIER_RADIUS; ++dx) {
            const uint at = neighbour(step, x + dx, y + dy);
            if (at != i && has_light(filtered[at])) most = fmax(most, luminance(filtered[at].xyz));
        }
    const float own = luminance(light), removed = unsupported(own, most, variance, single);
    return removed > 0.0f ? light * (1.0f - removed / own) : light;
}

/// `noisy`: the pixels and their variances. `single`: those are no estimates, and all is taken from `filtered`.
kernel void modulate(FilterStep step, uint single, float doubt, global const float4* noisy, global const float4* filtered,
                     global const float* kept, global const Guide* guides, global float* image) {
    const uint i = get_global_id(0);
    if (i >= step.width * step.height) return;
    const bool lit = has_light(noisy[i]);
    const Guide g = guides[i];
    float share = 1.0f;
    if (!single && lit) share = share_beside_details(&g, doubt) * share_of_filtered(step, i, doubt, noisy, filtered, kept, guides);
    float3 light = mix(noisy[i].xyz, filtered[i].xyz, share);
    if (lit) light = bounded_light(step, i, single, light, noisy[i].w, filtered);
    const float3 albedo = lit ? (float3)(g.albedo_r, g.albedo_g, g.albedo_b) : (float3)(1.0f);
    vstore3(light * albedo + (float3)(g.glow_r, g.glow_g, g.glow_b), i, image);
}
