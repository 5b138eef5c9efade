// A node of the binary tree with quantized boxes, as used in studies: on a separate grid per node, rounded outward.
#ifndef CLARAY_SHARED_QUANTIZED_NODE_H
#define CLARAY_SHARED_QUANTIZED_NODE_H

/// Words per node: origin, three exponents, twelve planes, two children (compare Ylitie, Karras and Laine 2017,
/// "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs").
#define CLARAY_QUANTIZED_WORDS(bits) (4 + 12 * (bits) / 32 + 2)

#endif
