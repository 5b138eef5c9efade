#include "host/trace/host_rays.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/in_parallel.hpp"

namespace claray {
namespace {

struct HostRay {
    glm::dvec3 origin, direction, inverse;
    HostRay(const glm::dvec3& o, const glm::dvec3& d) : origin(o), direction(d) {
        for (int k = 0; k < 3; ++k) inverse[k] = 1 / (d[k] != 0 ? d[k] : 1e-300);
    }
};

/// The slab test; `end` is the ray's end.
bool meets(const HostRay& ray, const glm::dvec3& lo, const glm::dvec3& hi, double end) {
    const glm::dvec3 a = (lo - ray.origin) * ray.inverse, b = (hi - ray.origin) * ray.inverse;
    glm::dvec3 in = glm::min(a, b), out = glm::max(a, b);
    for (int k = 0; k < 3; ++k)  // a ray parallel to both planes, which may lie in one of them
        if (ray.direction[k] == 0 && ray.origin[k] >= lo[k] && ray.origin[k] <= hi[k]) in[k] = 0, out[k] = end;
    return std::max({in.x, in.y, in.z, 0.0}) <= std::min({out.x, out.y, out.z, end});
}

/// Moeller and Trumbore 1997. Returns true and updates `hit` if the triangle is hit before `hit.distance`.
bool meets(const HostRay& ray, const LeafTriangle& t, HostHit& hit) {
    const glm::dvec3 v0(t.v0x, t.v0y, t.v0z);
    const glm::dvec3 e1 = glm::dvec3(t.v1x, t.v1y, t.v1z) - v0, e2 = glm::dvec3(t.v2x, t.v2y, t.v2z) - v0;
    const glm::dvec3 p = glm::cross(ray.direction, e2);
    const double determinant = glm::dot(e1, p);
    if (determinant == 0) return false;
    const glm::dvec3 from = ray.origin - v0, q = glm::cross(from, e1);
    const double u = glm::dot(from, p) / determinant, v = glm::dot(ray.direction, q) / determinant;
    const double distance = glm::dot(e2, q) / determinant;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && distance > 0 && distance < hit.distance)) return false;
    hit.distance = distance, hit.u = u, hit.v = v;
    hit.normal = glm::cross(e1, e2);
    return true;
}

/// Calls `at_leaf` with every leaf whose box the ray meets before `end`, which it may lower.
template <class AtLeaf>
void traverse(const HostTree& tree, std::uint32_t child, const HostRay& ray, const double& end, const AtLeaf& at_leaf) {
    if (child == CLARAY_NO_CHILD) return;
    if (child & CLARAY_LEAF) return at_leaf(tree.leaves[child & CLARAY_SLOT]);
    const BvhNode& n = tree.nodes[child];
    if (meets(ray, {n.lo0x, n.lo0y, n.lo0z}, {n.hi0x, n.hi0y, n.hi0z}, end))
        traverse(tree, n.child0, ray, end, at_leaf);
    if (meets(ray, {n.lo1x, n.lo1y, n.lo1z}, {n.hi1x, n.hi1y, n.hi1z}, end))
        traverse(tree, n.child1, ray, end, at_leaf);
}

}  // namespace

HostRays::HostRays(const Scene& scene) : scene_(scene) {
    std::uint32_t triangles = 0;
    for (const Mesh& mesh : scene.meshes) {
        first_triangles_.push_back(scene.instances.empty() ? triangles : 0);
        triangles += std::uint32_t(mesh.triangles.size());
    }
    if (scene.instances.empty()) {
        bottoms_.push_back(build_host_tree(scene.meshes));
        return;
    }
    bottoms_.resize(scene.meshes.size());
    in_parallel(bottoms_.size(), [&](std::size_t i) { bottoms_[i] = build_host_tree({&scene.meshes[i], 1}); });
    Mesh boxes;
    for (const MeshInstance& instance : scene.instances) place(instance, boxes);
    top_ = build_host_tree({&boxes, 1});
}

/// Represents a box by a triangle that spans it.
void HostRays::place(const MeshInstance& instance, Mesh& boxes) {
    const BvhHeader& header = bottoms_[instance.mesh].header;
    if (header.valid == 0) return;
    const glm::dmat4 transform(instance.transform);
    Bounds box;
    for (int corner = 0; corner < 8; ++corner)
        box.grow(
            glm::vec3(transform * glm::dvec4(corner & 1 ? header.hix : header.lox, corner & 2 ? header.hiy : header.loy,
                                             corner & 4 ? header.hiz : header.loz, 1.0)));
    const glm::vec3 pad = 1e-6f * (glm::abs(box.lo) + glm::abs(box.hi) + box.extent());  // for rounding
    const auto first = std::uint32_t(boxes.positions.size());
    boxes.positions.insert(boxes.positions.end(), {box.lo - pad, box.hi + pad, box.center()});
    boxes.triangles.emplace_back(first, first + 1, first + 2);
    placed_.push_back({instance.mesh, transform, glm::inverse(transform)});
}

std::optional<HostHit> HostRays::closest(const glm::dvec3& origin, const glm::dvec3& direction, double distance) const {
    HostHit hit;
    hit.distance = distance;
    const Placed* found = nullptr;
    const auto trace = [&](const HostTree& tree, const HostRay& ray, const Placed* placed) {
        traverse(tree, tree.header.root, ray, hit.distance, [&](const LeafTriangle& leaf) {
            if (!meets(ray, leaf, hit)) return;
            hit.mesh = placed ? placed->mesh : leaf.geometry;
            hit.triangle = leaf.primitive - first_triangles_[hit.mesh];
            found = placed;
        });
    };
    const HostRay ray(origin, direction);
    if (scene_.instances.empty()) {
        trace(bottoms_[0], ray, nullptr);
    } else {
        traverse(top_, top_.header.root, ray, hit.distance, [&](const LeafTriangle& leaf) {
            const Placed& placed = placed_[leaf.primitive];
            trace(bottoms_[placed.mesh],
                  {glm::dvec3(placed.to_object * glm::dvec4(origin, 1.0)), glm::dmat3(placed.to_object) * direction},
                  &placed);
        });
    }
    if (hit.distance == distance) return {};
    if (found) hit.normal = glm::transpose(glm::dmat3(found->to_object)) * hit.normal;
    hit.normal = glm::normalize(hit.normal);
    return hit;
}

}  // namespace claray
