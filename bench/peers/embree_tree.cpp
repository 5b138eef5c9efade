// Embree's builder makes a tree for claray's kernels, to compare the trees alone.
#include <algorithm>
#include <array>
#include <stdexcept>

#include "bench/peers/embree.hpp"

namespace claray::measure {
namespace {

struct Node {
    std::array<const Node*, 2> children{};
    std::array<RTCBounds, 2> boxes{};
    unsigned primitive = 0;  // of a leaf
};

void* new_node(RTCThreadLocalAllocator allocator) {
    return new (rtcThreadLocalAlloc(allocator, sizeof(Node), 16)) Node;
}

RTCBuildPrimitive bounds_of(const LeafTriangle& t, unsigned primitive) {
    const auto low = [](float a, float b, float c) { return std::min({a, b, c}); };
    const auto high = [](float a, float b, float c) { return std::max({a, b, c}); };
    return {low(t.v0x, t.v1x, t.v2x),  low(t.v0y, t.v1y, t.v2y),  low(t.v0z, t.v1z, t.v2z),  0,
            high(t.v0x, t.v1x, t.v2x), high(t.v0y, t.v1y, t.v2y), high(t.v0z, t.v1z, t.v2z), primitive};
}

/// Numbers a tree's nodes as claray does: node i lies between leaves i and i + 1.
class Numbering {
public:
    explicit Numbering(HostTree& tree) : tree_(tree), triangles_(std::move(tree.leaves)) { tree_.leaves.clear(); }

    struct Child {
        std::uint32_t reference, height, leaves;
    };

    Child place(const Node& node) {
        if (node.children[0] == nullptr) {
            tree_.leaves.push_back(triangles_.at(node.primitive));
            return {CLARAY_LEAF | std::uint32_t(tree_.leaves.size() - 1), 0, 1};
        }
        const Child a = place(*node.children[0]);
        const auto index = std::uint32_t(tree_.leaves.size() - 1);
        const Child b = place(*node.children[1]);
        const Child child{index, 1 + std::max(a.height, b.height), a.leaves + b.leaves};
        const RTCBounds &p = node.boxes[0], &q = node.boxes[1];
        BvhNode& to = tree_.nodes.at(index);
        to = {
            p.lower_x,   p.upper_x,   p.lower_y,       p.upper_y,
            q.lower_x,   q.upper_x,   q.lower_y,       q.upper_y,
            p.lower_z,   p.upper_z,   q.lower_z,       q.upper_z,
            a.reference, b.reference, CLARAY_NO_CHILD, child.height << 24 | std::min(child.leaves, CLARAY_COUNT_LIMIT)};
        for (const Child& c : {a, b})
            if (c.height > 0) tree_.nodes.at(c.reference).parent = index;
        return child;
    }

private:
    HostTree& tree_;
    std::vector<LeafTriangle> triangles_;
};

const Node* build(std::vector<RTCBuildPrimitive>& primitives, RTCBVH bvh, RTCBuildQuality quality) {
    RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.buildQuality = quality, arguments.bvh = bvh;
    arguments.maxBranchingFactor = 2, arguments.maxLeafSize = 1, arguments.maxDepth = CLARAY_MAX_HEIGHT;
    arguments.primitives = primitives.data();
    arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
    arguments.createNode = [](RTCThreadLocalAllocator allocator, unsigned, void*) { return new_node(allocator); };
    arguments.setNodeChildren = [](void* node, void** children, unsigned count, void*) {
        for (unsigned i = 0; i < std::min(count, 2u); ++i)
            static_cast<Node*>(node)->children[i] = static_cast<const Node*>(children[i]);
    };
    arguments.setNodeBounds = [](void* node, const RTCBounds** boxes, unsigned count, void*) {
        for (unsigned i = 0; i < std::min(count, 2u); ++i) static_cast<Node*>(node)->boxes[i] = *boxes[i];
    };
    arguments.createLeaf = [](RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* of, std::size_t, void*) {
        void* node = new_node(allocator);
        static_cast<Node*>(node)->primitive = of->primID;
        return node;
    };
    return static_cast<const Node*>(rtcBuildBVH(&arguments));
}

}  // namespace

HostTree embree_tree(std::span<const Mesh> meshes, RTCBuildQuality quality) {
    HostTree tree = build_host_tree(meshes);  // for its triangles and its bounds
    if (tree.leaves.size() < 2) return tree;
    std::vector<RTCBuildPrimitive> primitives;
    for (const LeafTriangle& triangle : tree.leaves)
        primitives.push_back(bounds_of(triangle, unsigned(primitives.size())));
    RTCDevice device = rtcNewDevice(nullptr);
    RTCBVH bvh = rtcNewBVH(device);
    const Node* root = build(primitives, bvh, quality);
    if (root == nullptr) throw std::runtime_error("Embree builds no tree");
    Numbering numbering(tree);
    const Numbering::Child all = numbering.place(*root);
    tree.header.root = all.reference, tree.header.height = all.height;
    rtcReleaseBVH(bvh);
    rtcReleaseDevice(device);
    return tree;
}

}  // namespace claray::measure
