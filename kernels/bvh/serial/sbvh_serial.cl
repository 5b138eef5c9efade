// The lower levels of the best tree on CPUs: the splits of sbvh_small.cl, by one work-item, which tries 16 splits at once by
// vectors.
#include "bvh/sbvh/sbvh.clh"

#define LANES 16u

#ifndef LEAF_BLOCK
#define LEAF_BLOCK 1  // references that a leaf of the wide tree tests at once, a power of two: a cost counts whole blocks
#endif

/// References of a small node: rows of SMALL coordinates, lo.x lo.y lo.z hi.x hi.y hi.z, and their primitives. Subtrees are ranges.
typedef struct SmallNode {
    float rows[6][SMALL + LANES];
    uint primitives[SMALL];
} SmallNode;

/// Unlike fmin and fmax these do not handle NaN.
static inline float16 lesser(float16 a, float16 b) { return select(b, a, a < b); }
static inline float16 greater(float16 a, float16 b) { return select(b, a, a > b); }

typedef struct WideBox {
    float16 lo[3], hi[3];
} WideBox;

static inline WideBox no_wide_box(void) {
    const float16 most = (float16)(INFINITY), least = (float16)(-INFINITY);
    const WideBox box = {{most, most, most}, {least, least, least}};
    return box;
}

/// Grows the boxes of the lanes in `mask`.
static inline void grow_lanes(WideBox* box, const SmallNode* node, uint i, int16 mask) {
    #pragma unroll
    for (uint axis = 0; axis < 3; ++axis) {
        const float16 lo = (float16)(node->rows[axis][i]), hi = (float16)(node->rows[3 + axis][i]);
        box->lo[axis] = select(box->lo[axis], lesser(box->lo[axis], lo), mask);
        box->hi[axis] = select(box->hi[axis], greater(box->hi[axis], hi), mask);
    }
}

static inline float16 half_areas(const WideBox* box) {
    const float16 x = box->hi[0] - box->lo[0], y = box->hi[1] - box->lo[1], z = box->hi[2] - box->lo[2];
    return x * y + y * z + z * x;
}

static inline float16 whole_blocks(int16 count) { return convert_float16((count + (LEAF_BLOCK - 1)) & -LEAF_BLOCK); }

/// The costs of the splits after the centroids of 16 references on one axis; INFINITY where no reference is on the right.
static inline float16 split_costs(const SmallNode* node, uint begin, uint end, uint axis, float16 border) {
    WideBox left = no_wide_box(), right = left;
    int16 left_count = (int16)(0);
    for (uint i = begin; i < end; ++i) {
        const int16 is_left = (float16)(node->rows[axis][i] + node->rows[3 + axis][i]) <= border;
        grow_lanes(&left, node, i, is_left);
        grow_lanes(&right, node, i, ~is_left);
        left_count -= is_left;
    }
    const int16 right_count = (int16)((int)(end - begin)) - left_count;
    const float16 cost = half_areas(&left) * whole_blocks(left_count) + half_areas(&right) * whole_blocks(right_count);
    return select(cost, (float16)(INFINITY), right_count == 0);
}

/// References whose doubled centroid on `axis` is not larger go left; axis 3: those whose primitive is not larger than `number`.
typedef struct SmallSplit {
    float cost, centroid;
    uint axis, number;
} SmallSplit;

static inline SmallSplit best_split(const SmallNode* node, uint begin, uint end, bool halve) {
    SmallSplit best = {INFINITY, 0.0f, 3, 0};
    float costs[LANES], borders[LANES];
    for (uint axis = 0; axis < 3 && !halve; ++axis) {
        for (uint block = begin; block < end; block += LANES) {
            const float16 border = vload16(0, node->rows[axis] + block) + vload16(0, node->rows[3 + axis] + block);
            const float16 cost = split_costs(node, begin, end, axis, border);
            const uint lanes = min(end - block, LANES);
            if ((movemask16(cost <= best.cost) & ((1u << lanes) - 1)) == 0) continue;
            vstore16(cost, 0, costs), vstore16(border, 0, borders);
            for (uint lane = 0; lane < lanes; ++lane) {
                const bool same_place = costs[lane] == best.cost && axis == best.axis && borders[lane] < best.centroid;
                if (costs[lane] < best.cost || same_place)
                    best.cost = costs[lane], best.centroid = borders[lane], best.axis = axis;
            }
        }
    }
    if (best.axis == 3) {
        uint least = node->primitives[begin], greatest = least;
        for (uint i = begin + 1; i < end; ++i)
            least = min(least, node->primitives[i]), greatest = max(greatest, node->primitives[i]);
        best.number = (least + greatest) / 2;
    }
    return best;
}

static inline bool goes_left(const SmallNode* node, SmallSplit split, uint i) {
    if (split.axis == 3) return node->primitives[i] <= split.number;
    return node->rows[split.axis][i] + node->rows[3 + split.axis][i] <= split.centroid;
}

static inline void exchange(SmallNode* node, uint i, uint j) {
    for (uint row = 0; row < 6; ++row) {
        const float kept = node->rows[row][i];
        node->rows[row][i] = node->rows[row][j];
        node->rows[row][j] = kept;
    }
    const uint kept = node->primitives[i];
    node->primitives[i] = node->primitives[j];
    node->primitives[j] = kept;
}

/// Moves the references of the left side to the beginning of the range, and returns their end.
static inline uint part_range(SmallNode* node, SmallSplit split, uint begin, uint end) {
    while (begin < end) {
        if (goes_left(node, split, begin)) ++begin;
        else exchange(node, begin, --end);
    }
    return begin;
}

static inline Box box_of_range(const SmallNode* node, uint begin, uint end) {
    float lo[3], hi[3];
    for (uint axis = 0; axis < 3; ++axis) {
        float least = node->rows[axis][begin], greatest = node->rows[3 + axis][begin];
        for (uint i = begin + 1; i < end; ++i) {
            least = node->rows[axis][i] < least ? node->rows[axis][i] : least;
            greatest = node->rows[3 + axis][i] > greatest ? node->rows[3 + axis][i] : greatest;
        }
        lo[axis] = least, hi[axis] = greatest;
    }
    const Box box = {(float3)(lo[0], lo[1], lo[2]), (float3)(hi[0], hi[1], hi[2])};
    return box;
}

typedef struct SmallTask {
    uint begin, end, node, depth;
} SmallTask;

/// Builds the subtree of a task, whose inner nodes but the first are numbered from `next_node` on, its leaves from `next_leaf` on.
static inline void finish_subtree(SplitTask task, SmallNode* node, uint next_node, uint next_leaf, global BvhNode* nodes,
                                  global LeafTriangle* leaves) {
    SmallTask stack[SMALL];
    const SmallTask root = {0, task.count, task.node, task.depth};
    stack[0] = root;
    uint waiting = 1;
    while (waiting != 0) {
        const SmallTask current = stack[--waiting];
        const SmallSplit split = best_split(node, current.begin, current.end, current.depth >= HALVING_DEPTH);
        const uint middle = part_range(node, split, current.begin, current.end);
        const uint begins[2] = {current.begin, middle}, ends[2] = {middle, current.end};
        uint children[2];
        for (uint side = 0; side < 2; ++side) {
            const Box box = box_of_range(node, begins[side], ends[side]);
            store_child_box(&nodes[current.node], side, box);
            if (ends[side] - begins[side] == 1) {
                store_reference(&leaves[next_leaf], box, node->primitives[begins[side]]);
                children[side] = CLARAY_LEAF | next_leaf++;
            } else {
                const SmallTask below = {begins[side], ends[side], next_node, current.depth + 1};
                nodes[next_node].parent = current.node;
                children[side] = next_node++;
                stack[waiting++] = below;
            }
        }
        nodes[current.node].child0 = children[0];
        nodes[current.node].child1 = children[1];
    }
}

/// Each item builds the subtrees of a run of tasks.
kernel void finish_subtrees_serial(global const SplitTask* tasks, uint count, uint runs, global const float4* even,
                                   global const float4* odd, global BvhNode* nodes, global LeafTriangle* leaves,
                                   volatile global uint* counters) {
    const uint run = get_global_id(0);
    if (run >= runs) return;
    const uint begin = (uint)((ulong)count * run / runs), end = (uint)((ulong)count * (run + 1) / runs);
    uint references = 0;
    for (uint i = begin; i < end; ++i) references += tasks[i].count;
    uint next_leaf = atomic_add(&counters[LEAVES], references);
    uint next_node = atomic_add(&counters[NODES], references - 2 * (end - begin));  // a subtree's first node has its number
    SmallNode node;
    for (uint i = begin; i < end; ++i) {
        const SplitTask task = tasks[i];
        for (uint k = 0; k < task.count; ++k) {
            const Reference reference = load_reference(task.depth % 2 == 0 ? even : odd, task.at + k);
            node.rows[0][k] = reference.box.lo.x, node.rows[1][k] = reference.box.lo.y, node.rows[2][k] = reference.box.lo.z;
            node.rows[3][k] = reference.box.hi.x, node.rows[4][k] = reference.box.hi.y, node.rows[5][k] = reference.box.hi.z;
            node.primitives[k] = reference.primitive;
        }
        finish_subtree(task, &node, next_node, next_leaf, nodes, leaves);
        next_node += task.count - 2, next_leaf += task.count;
    }
}
