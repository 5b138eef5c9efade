// Nodes of trees that only studies trace.
#ifndef CLARAY_SHARED_STUDY_NODES_H
#define CLARAY_SHARED_STUDY_NODES_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// A node of the binary tree with quantized boxes, on a separate grid per node, rounded outward. Words per node:
/// origin, three exponents, twelve planes, two children (compare Ylitie, Karras and Laine 2017, "Efficient Incoherent
/// Ray Traversal on GPUs Through Compressed Wide BVHs").
#define CLARAY_QUANTIZED_WORDS(bits) (4 + 12 * (bits) / 32 + 2)

/// A cell of space. A k-d tree cuts it by one plane into two children, an octree by three into eight. Bit k of a
/// child's place among its siblings is set if it is above the plane of axis k (k-d tree: above the plane).
typedef struct CellNode {
    float plane[3];  // by axis; of a k-d tree only plane[axis]
    uint first;      // the first child; of a leaf, the first entry of its list of triangles
    uint count;      // of a leaf: triangles that reach it; of others CLARAY_CELL_HAS_CHILDREN
    uint axis;       // of a k-d tree
} CellNode;
CLARAY_LAYOUT(CellNode, 24)

#define CLARAY_CELL_HAS_CHILDREN 0xffffffffu

CLARAY_SHARED_END

#endif
