// Closest hits by one plain loop over a k-d tree or an octree: the same tests of triangles as trace_variant.cl, one ray per item at
// a time. A ray visits the children of a cell in order, each with the distances at which it enters and leaves (Havran 2000, "Heuristic
// Ray Shooting Algorithms"). Distances to planes are padded, so that no cell is missed.
#ifndef SPLIT_AXES
#define SPLIT_AXES 1  // planes of a node: 1 (k-d tree) or 3 (octree)
#endif
#ifndef STACK
#define STACK 64  // entries: children but one a level, and one
#endif
#define CHILDREN (1 << SPLIT_AXES)

#include "claray/shared/study_nodes.h"
#include "trace/traverse_binary.clh"
#include "trace/query.clh"

typedef struct CellEntry {
    uint node;
    float enter, leave;
} CellEntry;

#define PLANE_PAD (16.0f * UNIT_ROUNDOFF)  // of a distance: two roundings and a reciprocal of 2.5 ulp

static inline float component(float3 v, uint axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// The ray's distances on the near and the far side of a plane; returns whether the near side is the upper one.
static inline bool cut_span(const PreparedRay* ray, float plane, uint axis, float2 span, float2* near, float2* far) {
    const float from = component(ray->origin, axis), t = (plane - from) * component(ray->reciprocal, axis);
    *near = *far = span;
    if (t < 0.0f) *far = (float2)(INFINITY, -INFINITY);  // mutant: cell-planes
    if (t > 0.0f) near->y = fmin(span.y, t * (1.0f + PLANE_PAD)), far->x = fmax(span.x, t * (1.0f - PLANE_PAD));
    return from > plane;  // from the plane itself, or along it (NaN), the ray reaches both sides
}

/// The distances at which the ray is in the box of all triangles.
static inline float2 span_of_all(const PreparedRay* ray, float tmax, global const BvhHeader* header) {
    const float3 at_lo = ((float3)(header->lox, header->loy, header->loz) - ray->origin) * ray->reciprocal;
    const float3 at_hi = ((float3)(header->hix, header->hiy, header->hiz) - ray->origin) * ray->reciprocal;
    const int3 backwards = ray->reciprocal < 0.0f;
    const float3 near = select(at_lo, at_hi, backwards), far = select(at_hi, at_lo, backwards);
    const float enter = fmax(fmax(near.x, near.y), near.z), leave = fmin(fmin(far.x, far.y), far.z);
    return (float2)(fmax(enter * (1.0f - PLANE_PAD), ray->tmin), fmin(leave * (1.0f + PLANE_PAD), tmax));
}

/// Pushes the children that the ray meets before `tbest`, the nearest on top. Numbered from the ray's origin, a child never lies
/// behind one of a higher number.
static inline void push_children(const PreparedRay* ray, const CellNode* node, float2 span, float tbest, CellEntry* stack, uint* depth) {
    float2 near[SPLIT_AXES], far[SPLIT_AXES];
    uint nearest = 0;
    for (uint k = 0; k < SPLIT_AXES; ++k) {
        const uint axis = SPLIT_AXES == 1 ? node->axis : k;
        if (cut_span(ray, node->plane[axis], axis, span, &near[k], &far[k])) nearest |= 1u << k;
    }
    for (int number = CHILDREN - 1; number >= 0; --number) {
        float enter = span.x, leave = span.y;
        for (uint k = 0; k < SPLIT_AXES; ++k) {
            const float2 part = (number >> k & 1) != 0 ? far[k] : near[k];
            enter = fmax(enter, part.x), leave = fmin(leave, part.y);
        }
        if (!(enter <= leave && enter <= tbest)) continue;
        const CellEntry entry = {node->first + ((uint)number ^ nearest), enter, leave};
        stack[(*depth)++] = entry;
    }
}

static inline Hit trace_cells_ray(global const BvhHeader* header, global const CellNode* nodes, global const uint* lists,
                                  global const LeafTriangle* leaves, const PreparedRay* ray, float tmax, Visits* visits) {
    Candidate best = no_candidate(tmax);
    CellEntry stack[STACK];
    uint depth = 0;
    const float2 all = span_of_all(ray, tmax, header);
    if (CLARAY_COUNT_VISITS) ++visits->nodes;
    if (header->valid != 0 && all.x <= all.y) {
        const CellEntry root = {0, all.x, all.y};
        stack[depth++] = root;
    }
    while (depth != 0) {
        const CellEntry entry = stack[--depth];
        if (entry.enter > best.far) continue;
        const CellNode node = nodes[entry.node];
        if (node.count == CLARAY_CELL_HAS_CHILDREN) {
            if (CLARAY_COUNT_VISITS) visits->nodes += CHILDREN;
            push_children(ray, &node, (float2)(entry.enter, entry.leave), best.far, stack, &depth);
            continue;
        }
        if (CLARAY_COUNT_VISITS) visits->triangles += node.count;
        for (uint i = 0; i < node.count; ++i) try_leaf(ray, leaves, lists[node.first + i], &best);
    }
    return finish_candidate(ray, leaves, best, tmax, false);
}

kernel __attribute__((reqd_work_group_size(GROUP_SIZE, 1, 1)))
void trace_cells(global const BvhHeader* header, global const CellNode* nodes, global const uint* lists,
                 global const LeafTriangle* leaves, global const Ray* rays, uint count, global Hit* hits, global Visits* visits) {
    FOR_EACH_RAY(i, count) {
        const Ray ray = rays[i];
        Visits visited = {0, 0};
        Hit hit = no_hit(ray.tmax);
        if (ray_valid(ray)) {
            const PreparedRay prepared = prepare_ray(ray, false, 0xffffffffu);
            hit = trace_cells_ray(header, nodes, lists, leaves, &prepared, ray.tmax, &visited);
        }
        hits[i] = hit;
        if (CLARAY_COUNT_VISITS) visits[i] = visited;
    }
}
