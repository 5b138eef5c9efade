// The acceleration structure's memory layout, as builders write it and traversals read it.
#ifndef CLARAY_SHARED_BVH_NODE_H
#define CLARAY_SHARED_BVH_NODE_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// A reference to a child: with the top bit set a leaf, 1nn. .... its triangles less one, then its first slot;
/// otherwise the index of a node.
#define CLARAY_LEAF 0x80000000u
#define CLARAY_LEAF_COUNT_SHIFT 29
#define CLARAY_LEAF_COUNT(child) ((((child) >> CLARAY_LEAF_COUNT_SHIFT) & 3u) + 1u)
#define CLARAY_SLOT 0x1fffffffu
/// No child: an empty slot of a wide node, or the root of an empty structure.
#define CLARAY_NO_CHILD 0xffffffffu

/// A stack of this many entries is enough for any tree of ours: every level consumes a bit of the code (63) or of
/// the index that separates equal codes (32).
#define CLARAY_MAX_HEIGHT 96

/// Inner node of the binary tree: the boxes of both children, so that one 64-byte line decides where to go (Aila and
/// Laine 2009). Node i splits the sorted leaves between i and i + 1 (Apetrei 2014), so numbering is the same
/// everywhere. A number between the leaves that share a reference is free: its children are CLARAY_NO_CHILD.
typedef struct BvhNode {
    float lo0x, hi0x, lo0y, hi0y;
    float lo1x, hi1x, lo1y, hi1y;
    float lo0z, hi0z, lo1z, hi1z;
    uint child0, child1;
    uint parent;        // CLARAY_NO_CHILD at the root
    uint height_count;  // hhhh hhhh cccc cccc cccc cccc cccc cccc: height, and leaves below (saturated)
} BvhNode;
CLARAY_LAYOUT(BvhNode, 64)

#define CLARAY_COUNT_LIMIT 0x00ffffffu

/// A triangle in the order of the leaves.
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

/// Inner node of the wide tree, structure of arrays: one ray tests all boxes at once. Empty slots hold boxes that no
/// ray meets (lo = +inf, hi = -inf).
typedef struct WideNode {
    float lox[CLARAY_WIDTH], hix[CLARAY_WIDTH];
    float loy[CLARAY_WIDTH], hiy[CLARAY_WIDTH];
    float loz[CLARAY_WIDTH], hiz[CLARAY_WIDTH];
    uint child[CLARAY_WIDTH];   // a leaf: 1 nn. .... its triangles less one, then the index of its TriangleBlock
    uint source[CLARAY_WIDTH];  // the child of the binary tree that this slot stands for: where its box comes from in a
                                // refit
} WideNode;
CLARAY_LAYOUT(WideNode, 256)

/// Up to four triangles of one leaf of the wide tree. Lanes beyond the leaf's count are not looked at.
typedef struct TriangleBlock {
    float v0x[CLARAY_BLOCK], v0y[CLARAY_BLOCK], v0z[CLARAY_BLOCK];
    float v1x[CLARAY_BLOCK], v1y[CLARAY_BLOCK], v1z[CLARAY_BLOCK];
    float v2x[CLARAY_BLOCK], v2y[CLARAY_BLOCK], v2z[CLARAY_BLOCK];
    uint primitive[CLARAY_BLOCK];
    uint geometry[CLARAY_BLOCK];
    uint mask[CLARAY_BLOCK];
} TriangleBlock;
CLARAY_LAYOUT(TriangleBlock, 192)

/// One per structure, in device memory: what kernels need to know before the first node.
typedef struct BvhHeader {
    float lox, loy, loz, hix, hiy, hiz;  // bounds of all valid triangles; lo > hi where there is none
    uint root;                           // child reference: a node, a leaf, or CLARAY_NO_CHILD
    uint valid;                          // triangles in the leaves, one that was split counted for each of its parts
    uint culled;                         // triangles left out: not finite, huge, or without area
    uint height;                         // levels of inner nodes below and including the root
    uint wide_nodes, wide_blocks;        // of the wide tree, where there is one
    float scale;                         // cells of the Morton grid per unit of length
    uint inner_nodes;                    // of the binary tree, numbers that are free counted
    uint unused0, unused1;
} BvhHeader;
CLARAY_LAYOUT(BvhHeader, 64)

CLARAY_SHARED_END

#endif
