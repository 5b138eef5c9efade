#include "host/io/gltf/gltf_skin.hpp"

#include <cmath>

#include "host/io/gltf/gltf_accessor.hpp"

namespace claray {
namespace {

using std::to_string;

glm::dmat4 matrix_at(const std::vector<float>& numbers, std::size_t index) {
    glm::dmat4 matrix(1.0);
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = double(numbers[16 * index + std::size_t(i)]);
    return matrix;
}

bool is_finite_matrix(const glm::dmat4& m) {
    for (int i = 0; i < 16; ++i)
        if (!std::isfinite(m[i / 4][i % 4])) return false;
    return true;
}

/// What a vertex follows: the mean of its joints.
glm::dmat4 blend(const std::vector<JointSet>& sets, std::size_t vertex, const JointMatrices& matrices,
                 const GltfFile& file, const std::string& name) {
    glm::dmat4 sum(0.0);
    double total = 0;
    for (const JointSet& set : sets)
        for (int k = 0; k < 4; ++k) {
            const double weight = double(set.weights[vertex][k]), joint = double(set.joints[vertex][k]);
            if (weight == 0) continue;
            const std::string what = name + ": vertex " + to_string(vertex);
            if (!std::isfinite(weight)) file.fail(what + " has a weight that is not finite");
            if (!(joint >= 0 && joint < double(matrices.size())))
                file.fail(what + " follows joint " + to_string(std::int64_t(joint)) + " of " +
                          to_string(matrices.size()));
            sum += weight * matrices[std::size_t(joint)];
            total += weight;
        }
    return total > 0 ? sum / total : glm::dmat4(1.0);
}

/// Of length 1, or 0 where it has none.
glm::vec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : glm::vec3(0.f);
}

/// The matrix by which normals go, but for a positive factor; it exists where there is no inverse.
glm::dmat3 for_normals(const glm::dmat3& m) {
    const double side = glm::determinant(m) < 0 ? -1.0 : 1.0;
    return side * glm::dmat3(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
}

}  // namespace

JointMatrices read_skin(const GltfFile& file, std::size_t index, const NodeTransforms& nodes) {
    const std::vector<tinygltf::Skin>& skins = file.model.skins;
    if (index >= skins.size())
        file.fail("a node refers to skin " + to_string(index) + " of " + to_string(skins.size()));
    const tinygltf::Skin& skin = skins[index];
    const std::string name = gltf_name("skin", skin.name, index);
    std::vector<float> inverses;
    if (skin.inverseBindMatrices >= 0)
        inverses = read_numbers(file, skin.inverseBindMatrices, 16, name + ": its inverse bind matrices");
    if (skin.inverseBindMatrices >= 0 && inverses.size() / 16 < skin.joints.size())
        file.fail(name + " has " + to_string(inverses.size() / 16) + " inverse bind matrices for " +
                  to_string(skin.joints.size()) + " joints");
    JointMatrices matrices;
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        const int joint = skin.joints[i];
        if (joint < 0 || std::size_t(joint) >= nodes.size())
            file.fail(name + " refers to node " + to_string(joint) + " of " + to_string(nodes.size()));
        const std::optional<glm::dmat4>& world = nodes[std::size_t(joint)];
        if (!world) file.fail(name + ": its joint " + to_string(i) + " is its own descendant", "nodes must form trees");
        matrices.push_back(*world);
        if (!inverses.empty()) matrices.back() *= matrix_at(inverses, i);
        if (!is_finite_matrix(matrices.back()))
            file.fail(name + ": the matrix of joint " + to_string(i) + " is not finite");
    }
    return matrices;
}

void follow_joints(Mesh& mesh, const std::vector<JointSet>& sets, const JointMatrices& matrices, const GltfFile& file,
                   const std::string& name) {
    std::vector<double> sides(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const glm::dmat4 matrix = blend(sets, i, matrices, file, name);
        const glm::dmat3 linear(matrix);
        sides[i] = glm::sign(glm::determinant(linear));
        mesh.positions[i] = glm::vec3(matrix * glm::dvec4(glm::dvec3(mesh.positions[i]), 1.0));
        if (!mesh.normals.empty()) mesh.normals[i] = unit(for_normals(linear) * glm::dvec3(mesh.normals[i]));
        if (mesh.tangents.empty()) continue;
        glm::vec4& tangent = mesh.tangents[i];
        tangent = glm::vec4(unit(linear * glm::dvec3(glm::vec3(tangent))), sides[i] < 0 ? -tangent.w : tangent.w);
    }
    for (glm::uvec3& t : mesh.triangles)
        if (sides[t.x] + sides[t.y] + sides[t.z] < 0) std::swap(t.y, t.z);
}

}  // namespace claray
