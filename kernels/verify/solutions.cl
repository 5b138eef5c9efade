// What the exact step of the triangle test finds, to compare its bits: hits tell distances in float32 only.
#include "trace/triangle.clh"

#define NUMBERS_OF_TRIANGLE 9u
#define WORDS_OF_SOLUTION 5u

/// Solves ray i and triangle i: whether it hits, then t, u, v and the determinant, as words of 64 bits. A miss has zeros.
kernel void solve_triangles(global const Ray* rays, global const float* corners, uint count, global ulong* words) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const PreparedRay ray = prepare_ray(rays[i], false, 0xffffffffu);
    global const float* at = corners + NUMBERS_OF_TRIANGLE * i;
    const Solution s = solve(&ray, vload3(0, at), vload3(1, at), vload3(2, at));
    global ulong* to = words + WORDS_OF_SOLUTION * i;
    const ulong numbers[WORDS_OF_SOLUTION] = {1, as_ulong((double)s.t), as_ulong((double)s.u), as_ulong((double)s.v), as_ulong((double)s.det)};
    for (uint k = 0; k < WORDS_OF_SOLUTION; ++k) to[k] = s.hit ? numbers[k] : 0;
}
