// A binary tree's node with boxes in few bits, as studies measure it: on a grid of the node's own, rounded outward.
#ifndef CLARAY_SHARED_QUANTIZED_NODE_H
#define CLARAY_SHARED_QUANTIZED_NODE_H

/// Words of a node: origin, three exponents, twelve planes, two children (compare Ylitie, Karras and Laine 2017,
/// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs").
#define CLARAY_QUANTIZED_WORDS(bits) (4 + 12 * (bits) / 32 + 2)

#endif
