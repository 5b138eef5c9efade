// Triangle meshes on the host.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "claray/error.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// An indexed triangle mesh: one geometry of a scene. `normals`, `uvs`, `uvs1`, `tangents` and `colors` are per vertex
/// and may be empty.
struct Mesh {
    std::string name = {};
    std::vector<glm::vec3> positions = {};
    std::vector<glm::vec3> normals = {};  ///< unit length; empty: flat shading
    std::vector<glm::vec2> uvs = {};      ///< (0, 0) is the top left corner of an image
    std::vector<glm::vec2> uvs1 = {};     ///< second set of coordinates
    std::vector<glm::vec4> tangents =
        {};  ///< unit length, w = +-1: sign of the bitangent; empty: computed from the uvs
    /// Linear RGB multiplies the material's albedo; alpha multiplies its opacity. 0..1; empty: white.
    std::vector<glm::vec4> colors = {};
    std::vector<glm::uvec3> triangles = {};     ///< indices into `positions`
    std::vector<std::uint32_t> materials = {};  ///< per triangle, indices into Scene::materials; empty: material 0
    std::uint32_t mask = 0xffffffffu;           ///< a ray sees the mesh if its mask and this one share a bit
};

/// Axis-aligned box of all finite positions; `lo > hi` if there are none.
struct Bounds {
    glm::vec3 lo{3.402823466e38f}, hi{-3.402823466e38f};

    void grow(const glm::vec3& point) { lo = glm::min(lo, point), hi = glm::max(hi, point); }
    [[nodiscard]] bool empty() const { return lo.x > hi.x; }
    [[nodiscard]] glm::vec3 center() const { return 0.5f * lo + 0.5f * hi; }
    [[nodiscard]] glm::vec3 extent() const { return hi - lo; }
};

/// Returns the box of all finite positions of the mesh, in the units of the mesh.
[[nodiscard]] Bounds bounds_of(const Mesh& mesh);

}  // namespace claray
#pragma GCC visibility pop
