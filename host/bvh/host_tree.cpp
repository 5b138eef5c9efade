#include "host/bvh/host_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace claray {
namespace {

constexpr float coordinate_limit = 1e18f;  // COORDINATE_LIMIT of kernels/bvh/triangles.clh
constexpr float infinity = std::numeric_limits<float>::infinity();

struct Box {
    glm::vec3 lo{infinity}, hi{-infinity};
    void grow(const Box& other) { lo = glm::min(lo, other.lo), hi = glm::max(hi, other.hi); }
    void grow(glm::vec3 point) { lo = glm::min(lo, point), hi = glm::max(hi, point); }
};

/// The rules of kernels/bvh/triangles.clh: finite, not huge, no two equal vertices.
bool is_valid(const std::array<glm::vec3, 3>& corners) {
    for (const glm::vec3& v : corners)
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(v[axis]) <= coordinate_limit)) return false;
    return corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
}

class MedianSplits {
public:
    explicit MedianSplits(std::span<const Mesh> meshes) {
        std::uint32_t primitive = 0;
        for (std::size_t geometry = 0; geometry < meshes.size(); ++geometry)
            for (const glm::uvec3& t : meshes[geometry].triangles)
                add(meshes[geometry], t, primitive++, std::uint32_t(geometry));
        tree_.header.valid = std::uint32_t(references_.size());
        tree_.header.culled = primitive - tree_.header.valid;
    }

    HostTree build() {
        BvhHeader& header = tree_.header;
        const std::uint32_t count = header.valid;
        header.root = CLARAY_NO_CHILD;
        Child root;
        if (count > 0) {
            tree_.nodes.resize(count - 1);
            root = build(0, count, CLARAY_NO_CHILD);
            header.root = root.reference, header.height = root.height, header.inner_nodes = count - 1;
        }
        header.lox = root.box.lo.x, header.loy = root.box.lo.y, header.loz = root.box.lo.z;
        header.hix = root.box.hi.x, header.hiy = root.box.hi.y, header.hiz = root.box.hi.z;
        for (const Reference& reference : references_) tree_.leaves.push_back(reference.triangle);
        return std::move(tree_);
    }

private:
    struct Reference {
        glm::vec3 centroid;
        Box box;
        LeafTriangle triangle;
    };
    struct Child {
        std::uint32_t reference = CLARAY_NO_CHILD, height = 0;
        Box box;
    };

    void add(const Mesh& mesh, glm::uvec3 t, std::uint32_t primitive, std::uint32_t geometry) {
        std::array<glm::vec3, 3> v{};
        Box box;
        for (int i = 0; i < 3; ++i) v[i] = mesh.positions[t[i]] + 0.f, box.grow(v[i]);  // no -0, as on the device
        if (!is_valid(v)) return;
        references_.push_back({0.5f * (box.lo + box.hi), box,
                               LeafTriangle{v[0].x, v[0].y, v[0].z, primitive, v[1].x, v[1].y, v[1].z, geometry, v[2].x,
                                            v[2].y, v[2].z, mesh.mask}});
    }

    /// Partitions so that the first half is below the second.
    void split(std::uint32_t begin, std::uint32_t middle, std::uint32_t end) {
        Box box;
        for (std::uint32_t i = begin; i < end; ++i) box.grow(references_[i].centroid);
        const glm::vec3 size = box.hi - box.lo;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto at = [&](std::uint32_t i) { return references_.begin() + i; };
        std::nth_element(at(begin), at(middle), at(end), [axis](const Reference& a, const Reference& b) {
            if (a.centroid[axis] != b.centroid[axis]) return a.centroid[axis] < b.centroid[axis];
            return a.triangle.primitive < b.triangle.primitive;
        });
    }

    Child build(std::uint32_t begin, std::uint32_t end, std::uint32_t parent) {
        if (end - begin == 1) return {CLARAY_LEAF | begin, 0, references_[begin].box};
        const std::uint32_t middle = begin + (end - begin) / 2, index = middle - 1;
        split(begin, middle, end);
        const Child a = build(begin, middle, index), b = build(middle, end, index);
        Child child{index, 1 + std::max(a.height, b.height), a.box};
        child.box.grow(b.box);
        const std::uint32_t height_count = child.height << 24 | std::min(end - begin, CLARAY_COUNT_LIMIT);
        tree_.nodes[index] = {a.box.lo.x,  a.box.hi.x,  a.box.lo.y, a.box.hi.y,  b.box.lo.x, b.box.hi.x,
                              b.box.lo.y,  b.box.hi.y,  a.box.lo.z, a.box.hi.z,  b.box.lo.z, b.box.hi.z,
                              a.reference, b.reference, parent,     height_count};
        return child;
    }

    std::vector<Reference> references_;
    HostTree tree_;
};

}  // namespace

HostTree build_host_tree(std::span<const Mesh> meshes) { return MedianSplits(meshes).build(); }

}  // namespace claray
