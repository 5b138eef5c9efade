// Boxes of all shapes, near and far from the origin, and a ray to a point on a face, an edge or a corner of each, or past it. Tests
// the box tests of the traversals, which read nodes from arrays as in a tree.
#include "claray/shared/rng.h"
#include "trace/packets/slabs.clh"

static inline float uniform(uint random) { return (float)(random >> 8) * 0x1p-24f; }
static inline float both_ways(uint random) { return (float)(random >> 8) * 0x1p-23f - 1.0f; }

/// Bit 0: the binary traversal's test reports a hit; bit 1: the same with known signs; bits 2 and 3: the wide traversal's test in
/// the first and the last slot.
kernel void graze_boxes(uint count, uint first, uint seed, global BvhHeader* headers, global WideNode* nodes, global Ray* rays,
                        global float* boxes, global uint* found) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    SamplePair r[8];
    for (uint k = 0; k < 8; ++k) r[k] = independent_pair(first + i, hash_word(seed * 64u + k));
    const float scales[4] = {0.0f, 1.0f, 1e3f, 1e6f};
    const float offset = scales[r[0].x >> 30];
    float lo[3], hi[3], o[3], d[3];
    const uint face = (r[0].y >> 8) % 3u, sharp = (r[0].y >> 4) & 3u;  // sharp: 0 on a face, 1 and 2 on an edge, 3 at a corner
    for (uint axis = 0; axis < 3; ++axis) {
        const uint a = axis == 0 ? r[1].x : axis == 1 ? r[1].y : r[2].x, b = axis == 0 ? r[2].y : axis == 1 ? r[3].x : r[3].y;
        const uint c = axis == 0 ? r[4].x : axis == 1 ? r[4].y : r[5].x, e = axis == 0 ? r[5].y : axis == 1 ? r[6].x : r[6].y;
        const float middle = offset * both_ways(a), half_size = ((b & 7u) == 0u ? 0.0f : 1.0f) * uniform(b) * ((b & 24u) == 0u ? 1e-3f : 1.0f);
        lo[axis] = middle - half_size, hi[axis] = middle + half_size;
        const bool at_border = axis == face || sharp == 3u || (sharp != 0u && axis == (face + sharp) % 3u);
        const float inside = clamp(lo[axis] + uniform(c) * (hi[axis] - lo[axis]), lo[axis], hi[axis]);
        float target = at_border ? ((c & 1u) ? hi[axis] : lo[axis]) : inside;
        if (axis == face && (r[7].x & 1u)) target += (target - middle) * power_of_two(-(int)(r[7].y >> 27));  // past it, by any distance
        o[axis] = middle + (3.0f + ((e & 1u) ? offset : 0.0f)) * both_ways(e);
        d[axis] = target - o[axis];
        if ((e & 126u) == 0u) o[axis] = target, d[axis] = (e & 128u) ? -0.0f : 0.0f;  // along a face
    }
    if (d[0] == 0.0f && d[1] == 0.0f && d[2] == 0.0f) d[0] = 1.0f;
    const Ray ray = {o[0], o[1], o[2], 0.0f, d[0], d[1], d[2], 1e30f};
    rays[i] = ray;
    for (uint axis = 0; axis < 3; ++axis) boxes[6 * i + axis] = lo[axis], boxes[6 * i + 3 + axis] = hi[axis];

    const PreparedRay prepared = prepare_ray(ray, false, 0xffffffffu);
    BvhHeader header = headers[i];
    header.lox = lo[0], header.loy = lo[1], header.loz = lo[2], header.hix = hi[0], header.hiy = hi[1], header.hiz = hi[2];
    headers[i] = header;
    const Slabs slabs = prepare_slabs(&prepared, &headers[i]);
    int enter;
    uint bits = meets_box(&slabs, ray.tmax, lo[0], hi[0], lo[1], hi[1], lo[2], hi[2], ANY_SIGNS, &enter) ? 1u : 0u;
    bits |= meets_box(&slabs, ray.tmax, lo[0], hi[0], lo[1], hi[1], lo[2], hi[2], signs_of(&prepared), &enter) ? 2u : 0u;
    global WideNode* node = &nodes[i];
    for (uint k = 0; k < CLARAY_WIDTH; ++k) {
        const bool used = k == 0 || k == CLARAY_WIDTH - 1;
        node->lox[k] = used ? lo[0] : INFINITY, node->hix[k] = used ? hi[0] : -INFINITY;
        node->loy[k] = used ? lo[1] : INFINITY, node->hiy[k] = used ? hi[1] : -INFINITY;
        node->loz[k] = used ? lo[2] : INFINITY, node->hiz[k] = used ? hi[2] : -INFINITY;
    }
    float8 enters;
    const uint met = enter_boxes(&prepared, near_planes(&prepared), ray.tmax, node, &enters);
    bits |= (met & 1u) << 2 | ((met >> (CLARAY_WIDTH - 1)) & 1u) << 3;
    found[i] = bits;
}
