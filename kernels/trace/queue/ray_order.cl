// Sort keys for rays in any order, so that neighbouring rays have similar origins and directions: the origin's cell of the scene's
// box along Morton's curve, then the direction's cell of the octahedral map.
#include "claray/shared/ray_samples.h"
#include "trace/packets/columns.clh"

#define RAYS_PER_ITEM 1024
#define START_BITS 5      // per axis
#define DIRECTION_BITS 8
#define SAMPLES 256
#define NEAR 0.02f        // distance of similar origins, relative to the scene

/// Spreads a number of up to 8 bits to every other bit, and one of up to 5 bits to every third bit.
static inline uint16 every_second(uint16 x) {
    x = (x | (x << 4)) & 0x0f0fu;
    x = (x | (x << 2)) & 0x3333u;
    return (x | (x << 1)) & 0x5555u;
}
static inline uint16 every_third(uint16 x) {
    x = (x | (x << 8)) & 0x100fu;
    x = (x | (x << 4)) & 0x10c3u;
    return (x | (x << 2)) & 0x1249u;
}

static inline uint16 start_cell(float16 x, float low, float high) {
    return every_third(cells16((x - low) * ((float)(1 << START_BITS) / (high - low)), (1u << START_BITS) - 1));
}
static inline uint16 direction_cell(float16 x) {
    return every_second(cells16((x + 1.0f) * (float)(1 << (DIRECTION_BITS - 1)), (1u << DIRECTION_BITS) - 1));
}

kernel void ray_keys(global const BvhHeader* header, global const Ray* rays, uint count, global uint* keys) {
    const uint begin = (uint)get_global_id(0) * RAYS_PER_ITEM;
    for (uint at = begin; at < count && at - begin < RAYS_PER_ITEM; at += 16) {
        uint order[16];
        for (uint i = 0; i < 16; ++i) order[i] = min(at + i, count - 1);
        const Columns16 o = columns_of_rays(rays, order, 0), d = columns_of_rays(rays, order, 1);
        float16 x, y;
        octahedral16(d.x, d.y, d.z, &x, &y);
        const uint16 start = start_cell(o.x, header->lox, header->hix) << 2 | start_cell(o.y, header->loy, header->hiy) << 1 |
                             start_cell(o.z, header->loz, header->hiz);
        const uint16 key = start << (2 * DIRECTION_BITS) | direction_cell(x) << 1 | direction_cell(y);
        for (uint i = 0; i < 16 && at + i < count; ++i) keys[at + i] = ((const uint*)&key)[i];
    }
}

/// Sets `answer` to 1 if at least half of the rays differ from the next ray in both direction and origin. (Rays that leave a
/// surface in all directions start near their neighbours and are as fast unsorted.) One item.
kernel void sample_order(global const BvhHeader* header, global const Ray* rays, uint count, global uint* answer) {
    const float near = NEAR * max(max(header->hix - header->lox, header->hiy - header->loy), header->hiz - header->loz);
    uint unlike = 0;
    for (uint sample = 0; count > 1 && sample < SAMPLES; ++sample) {
        const uint i = place_of_sample(sample, count - 1u);
        const Ray a = rays[i], b = rays[i + 1];
        const float3 p = (float3)(a.dx, a.dy, a.dz), q = (float3)(b.dx, b.dy, b.dz);
        const float along = dot_product(p, q), apart = max(max(fabs(a.ox - b.ox), fabs(a.oy - b.oy)), fabs(a.oz - b.oz));
        const bool same_way = along > 0.0f && along * along > 0.8f * dot_product(p, p) * dot_product(q, q);
        unlike += !same_way && (apart == 0.0f || apart > near);
    }
    *answer = 2 * unlike >= SAMPLES;
}
