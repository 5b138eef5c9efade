// The lower levels of the best tree: a group builds the whole subtree of a node with at most SMALL references. It tries the splits
// after each reference by the surface area heuristic, but none through triangles.
#include "bvh/sbvh/sbvh.clh"

/// References of a small node while they are sorted into subtrees: rows of SMALL coordinates, lo.x lo.y lo.z hi.x hi.y hi.z.
typedef local const float* SmallBoxes;

static inline Box small_box(SmallBoxes rows, uint i) {
    const Box box = {(float3)(rows[i], rows[SMALL + i], rows[2 * SMALL + i]),
                     (float3)(rows[3 * SMALL + i], rows[4 * SMALL + i], rows[5 * SMALL + i])};
    return box;
}

static inline float doubled_centroid(SmallBoxes rows, uint axis, uint i) {
    return rows[axis * SMALL + i] + rows[(3 + axis) * SMALL + i];
}

static inline Box box_of_range(SmallBoxes rows, uint begin, uint end) {
    Box box = small_box(rows, begin);
    for (uint i = begin + 1; i < end; ++i) box = box_union(box, small_box(rows, i));
    return box;
}

/// A split after the centroid of one reference on one axis; axis 3: after primitive `number`.
typedef struct SmallSplit {
    float cost, centroid;
    uint axis, number;
} SmallSplit;

/// The best split after reference i of a range over all axes: references whose doubled centroid is not larger go left.
static inline SmallSplit split_behind(SmallBoxes rows, uint begin, uint end, uint i) {
    SmallSplit best = {INFINITY, 0.0f, 3, 0};
    for (uint axis = 0; axis < 3; ++axis) {
        const float border = doubled_centroid(rows, axis, i);
        Box left = empty_box(), right = left;
        uint left_count = 0;
        for (uint j = begin; j < end; ++j) {
            const Box box = small_box(rows, j);
            if (doubled_centroid(rows, axis, j) <= border) {
                left = box_union(left, box);
                ++left_count;
            } else {
                right = box_union(right, box);
            }
        }
        const uint right_count = end - begin - left_count;
        if (right_count == 0) continue;
        const float cost = half_area(left) * (float)left_count + half_area(right) * (float)right_count;
        if (cost < best.cost) best.cost = cost, best.centroid = border, best.axis = axis;
    }
    return best;
}

static inline bool better(SmallSplit a, SmallSplit b) {
    if (a.cost != b.cost) return a.cost < b.cost;
    if (a.axis != b.axis) return a.axis < b.axis;
    return a.centroid < b.centroid;
}

static inline uint middle_number(local const uint* primitives, uint count) {
    uint least = primitives[0], greatest = least;
    for (uint i = 1; i < count; ++i) least = min(least, primitives[i]), greatest = max(greatest, primitives[i]);
    return (least + greatest) / 2;
}

typedef struct SmallTask {
    uint begin, end, node, depth;
} SmallTask;

/// One group of SMALL items per task: all splits of a subtree, each the best one.
kernel __attribute__((reqd_work_group_size(SMALL, 1, 1)))
void finish_subtrees(global const SplitTask* tasks, global const float4* even, global const float4* odd,
                     global BvhNode* nodes, global LeafTriangle* leaves, volatile global uint* counters) {
    local float rows[6 * SMALL], sorted_rows[6 * SMALL];
    local uint primitives[SMALL], sorted_primitives[SMALL];
    local SmallSplit splits[SMALL];
    local SmallTask stack[SMALL];
    local SmallSplit best;
    local uint goes_left[SMALL];
    const uint item = get_local_id(0);
    const SplitTask task = tasks[get_group_id(0)];
    if (item < task.count) {
        const Reference reference = load_reference(task.depth % 2 == 0 ? even : odd, task.at + item);
        for (uint axis = 0; axis < 3; ++axis) {
            rows[axis * SMALL + item] = component(reference.box.lo, axis);
            rows[(3 + axis) * SMALL + item] = component(reference.box.hi, axis);
        }
        primitives[item] = reference.primitive;
    }
    const SmallTask root = {0, task.count, task.node, task.depth};
    uint depth = 1, next_node = 0, next_leaf = 0;  // numbers are reserved once, since all wait for an atomic addition
    if (item == 0) {
        stack[0] = root;
        next_node = atomic_add(&counters[NODES], task.count - 2), next_leaf = atomic_add(&counters[LEAVES], task.count);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    while (depth != 0) {
        const SmallTask current = stack[--depth];
        const uint count = current.end - current.begin, i = current.begin + item;
        const bool mine = item < count;
        if (mine) splits[item] = split_behind(rows, current.begin, current.end, i);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item == 0) {
            best = splits[0];
            for (uint k = 1; k < count; ++k)
                if (better(splits[k], best)) best = splits[k];
            if (current.depth >= HALVING_DEPTH) best.axis = 3;
            if (best.axis == 3) best.number = middle_number(primitives + current.begin, count);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        if (mine) {
            const uint axis = min(best.axis, 2u);
            goes_left[item] = best.axis == 3 ? primitives[i] <= best.number : doubled_centroid(rows, axis, i) <= best.centroid;
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        uint left_count = 0, before = 0;
        for (uint k = 0; k < count; ++k) {
            if (k < item) before += goes_left[k];
            left_count += goes_left[k];
        }
        if (mine) {
            const uint place = current.begin + (goes_left[item] ? before : left_count + item - before);
            for (uint row = 0; row < 6; ++row) sorted_rows[row * SMALL + place] = rows[row * SMALL + i];
            sorted_primitives[place] = primitives[i];
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        if (mine) {
            for (uint row = 0; row < 6; ++row) rows[row * SMALL + i] = sorted_rows[row * SMALL + i];
            primitives[i] = sorted_primitives[i];
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        const uint inner = (left_count > 1 ? 1 : 0) + (count - left_count > 1 ? 1 : 0);
        if (item == 0) {
            const uint middle = current.begin + left_count;
            SmallTask sides[2] = {{current.begin, middle, 0, current.depth + 1}, {middle, current.end, 0, current.depth + 1}};
            uint place = depth;
            global BvhNode* node = &nodes[current.node];
            uint children[2];
            for (uint side = 0; side < 2; ++side) {
                const Box box = box_of_range(rows, sides[side].begin, sides[side].end);
                store_child_box(node, side, box);
                if (sides[side].end - sides[side].begin == 1) {
                    store_reference(&leaves[next_leaf], box, primitives[sides[side].begin]);
                    children[side] = CLARAY_LEAF | next_leaf++;
                } else {
                    sides[side].node = children[side] = next_node++;
                    nodes[sides[side].node].parent = current.node;
                    stack[place++] = sides[side];
                }
            }
            node->child0 = children[0];
            node->child1 = children[1];
        }
        depth += inner;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
