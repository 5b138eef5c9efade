// Memory layout of the acceleration structure, shared by builders and traversals.
#ifndef CLARAY_SHARED_BVH_NODE_H
#define CLARAY_SHARED_BVH_NODE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// A reference to a child. If the top bit is set, it is a leaf: 1nn. .... with the number of triangles minus one in nn,
/// then the first slot. Otherwise it is the index of a node.
#define CLARAY_LEAF 0x80000000u
#define CLARAY_LEAF_COUNT_SHIFT 29
#define CLARAY_LEAF_COUNT(child) ((((child) >> CLARAY_LEAF_COUNT_SHIFT) & 3u) + 1u)
#define CLARAY_SLOT 0x1fffffffu
/// No child: an empty slot of a wide node, or the root of an empty structure.
#define CLARAY_NO_CHILD 0xffffffffu

/// A stack with this many entries is enough for any tree: every level consumes a bit of the code (63) or of the index
/// that separates equal codes (32).
#define CLARAY_MAX_HEIGHT 96

/// Inner node of the binary tree. It holds the boxes of both children, so that one 64-byte line decides which children
/// to visit (Aila and Laine 2009). Node i splits the sorted leaves between i and i + 1 (Apetrei 2014), so the numbering
/// is the same on all devices. If adjacent leaves share a reference, the node between them is unused: its children are
/// CLARAY_NO_CHILD.
typedef struct BvhNode {
    float lo0x, hi0x, lo0y, hi0y;
    float lo1x, hi1x, lo1y, hi1y;
    float lo0z, hi0z, lo1z, hi1z;
    uint child0, child1;
    uint parent;        // CLARAY_NO_CHILD at the root
    uint height_count;  // hhhh hhhh cccc cccc cccc cccc cccc cccc: height, and number of leaves below (saturated)
} BvhNode;
CLARAY_LAYOUT(BvhNode, 64)

#define CLARAY_COUNT_LIMIT 0x00ffffffu

/// A triangle, in the order of the leaves.
typedef struct LeafTriangle {
    float v0x, v0y, v0z;
    uint primitive;  // index in the order of the input
    float v1x, v1y, v1z;
    uint geometry;
    float v2x, v2y, v2z;
    uint mask;
} LeafTriangle;
CLARAY_LAYOUT(LeafTriangle, 48)

#define CLARAY_WIDTH 8
#define CLARAY_BLOCK 4

/// Inner node of the wide tree, a structure of arrays: one ray tests all boxes together. Empty slots hold boxes that no
/// ray hits (lo = +inf, hi = -inf).
typedef struct WideNode {
    float lox[CLARAY_WIDTH], hix[CLARAY_WIDTH];
    float loy[CLARAY_WIDTH], hiy[CLARAY_WIDTH];
    float loz[CLARAY_WIDTH], hiz[CLARAY_WIDTH];
    uint child[CLARAY_WIDTH];   // leaf: 1 nn. .... number of triangles minus one, then the index of its TriangleBlock
    uint source[CLARAY_WIDTH];  // the corresponding child in the binary tree, from which a refit takes the box
} WideNode;
CLARAY_LAYOUT(WideNode, 256)

/// Up to four triangles of one leaf of the wide tree. Lanes beyond the leaf's count are ignored.
typedef struct TriangleBlock {
    float v0x[CLARAY_BLOCK], v0y[CLARAY_BLOCK], v0z[CLARAY_BLOCK];
    float v1x[CLARAY_BLOCK], v1y[CLARAY_BLOCK], v1z[CLARAY_BLOCK];
    float v2x[CLARAY_BLOCK], v2y[CLARAY_BLOCK], v2z[CLARAY_BLOCK];
    uint primitive[CLARAY_BLOCK];
    uint geometry[CLARAY_BLOCK];
    uint mask[CLARAY_BLOCK];
} TriangleBlock;
CLARAY_LAYOUT(TriangleBlock, 192)

/// Up to eight primitives of one leaf of the wide tree that are not triangles. Lanes without a primitive hold what no
/// ray meets.
typedef struct PrimitiveBlock {
    float shape[7][CLARAY_WIDTH];  // boxes: the rows of a WideNode; capsules: start (x, y, z), axis (x, y, z), radius
    uint primitive[CLARAY_WIDTH];
} PrimitiveBlock;
CLARAY_LAYOUT(PrimitiveBlock, 256)

/// One per structure, in device memory: the data that kernels need before the first node.
typedef struct BvhHeader {
    float lox, loy, loz, hix, hiy, hiz;  // bounds of all valid triangles; lo > hi if there are none
    uint root;                           // child reference: a node, a leaf, or CLARAY_NO_CHILD
    uint valid;                          // triangles in the leaves; a split triangle counts once per part
    uint culled;                         // triangles left out: not finite, huge, or without area
    uint height;                         // levels of inner nodes below and including the root
    uint wide_nodes, wide_blocks;        // sizes of the wide tree, if it exists
    float widening;                      // of a top level over instances: growth of its boxes per unit of distance
    uint inner_nodes;                    // of the binary tree, including unused nodes
    uint first_node, first_leaf;         // where the structure begins if several structures share one buffer
} BvhHeader;
CLARAY_LAYOUT(BvhHeader, 64)

CLARAY_SHARED_END

#endif
