#include <algorithm>
#include <cmath>

#include "host/io/assimp/child/conversion.hpp"

namespace claray::assimp {
namespace {

/// glTF 2.0, section 5.24.4.
enum Mode { points = 0, lines = 1, triangles = 4 };

std::size_t add_vectors(Glb& glb, const aiVector3D* vectors, std::size_t count) {
    static_assert(sizeof(aiVector3D) == 3 * sizeof(float));
    return glb.add_floats({&vectors->x, 3 * count}, "VEC3", 3);
}

/// glTF counts v from the top.
std::size_t add_uvs(Glb& glb, const aiVector3D* uvs, std::size_t count) {
    std::vector<float> values;
    values.reserve(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
        const bool finite = std::isfinite(uvs[i].x) && std::isfinite(uvs[i].y);
        values.insert(values.end(), {finite ? uvs[i].x : 0.f, finite ? 1.f - uvs[i].y : 0.f});
    }
    return glb.add_floats(values, "VEC2", 2);
}

/// IEC 61966-2-1: files of these formats have the colours that screens show.
float linear(float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); }

std::size_t add_colors(Glb& glb, const aiColor4D* colors, std::size_t count) {
    std::vector<float> values;
    values.reserve(4 * count);
    const auto clamped = [](float c) { return std::isfinite(c) ? std::clamp(c, 0.f, 1.f) : 1.f; };
    for (std::size_t i = 0; i < count; ++i) {
        for (const float c : {colors[i].r, colors[i].g, colors[i].b}) values.push_back(linear(clamped(c)));
        values.push_back(clamped(colors[i].a));
    }
    return glb.add_floats(values, "VEC4", 4);
}

/// Those of its faces that have the corners of its mode, and vertices that exist.
std::vector<std::uint32_t> indices_of(const aiMesh& mesh, unsigned corners) {
    std::vector<std::uint32_t> indices;
    indices.reserve(std::size_t(mesh.mNumFaces) * corners);
    for (const aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
        const std::span vertices(face.mIndices, face.mNumIndices);
        const auto exists = [&](unsigned i) { return i < mesh.mNumVertices; };
        if (vertices.size() == corners && std::all_of(vertices.begin(), vertices.end(), exists))
            indices.insert(indices.end(), vertices.begin(), vertices.end());
    }
    return indices;
}

struct Influence {
    std::uint16_t joint;
    float weight;
};

/// Sets of four joints and weights, as many as the vertex with the most joints needs.
void add_joints(Glb& glb, const aiMesh& mesh, Json& attributes) {
    constexpr std::size_t most = 16;
    std::vector<std::vector<Influence>> vertices(mesh.mNumVertices);
    for (unsigned bone = 0; bone < mesh.mNumBones && bone < 0xffff; ++bone)
        for (const aiVertexWeight& weight : std::span(mesh.mBones[bone]->mWeights, mesh.mBones[bone]->mNumWeights))
            if (weight.mVertexId < vertices.size() && std::isfinite(weight.mWeight) && weight.mWeight > 0)
                vertices[weight.mVertexId].push_back({std::uint16_t(bone), weight.mWeight});
    std::size_t longest = 1;
    for (std::vector<Influence>& vertex : vertices) {
        std::sort(vertex.begin(), vertex.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
        vertex.resize(std::min(vertex.size(), most));
        if (vertex.empty()) vertex.push_back({0, 1.f});
        longest = std::max(longest, vertex.size());
    }
    for (std::size_t set = 0; 4 * set < longest; ++set) {
        std::vector<std::uint16_t> joints;
        std::vector<float> weights;
        for (const std::vector<Influence>& vertex : vertices)
            for (std::size_t k = 4 * set; k < 4 * set + 4; ++k) {
                joints.push_back(k < vertex.size() ? vertex[k].joint : std::uint16_t(0));
                weights.push_back(k < vertex.size() ? vertex[k].weight : 0.f);
            }
        attributes["JOINTS_" + std::to_string(set)] = glb.add_joints(joints);
        attributes["WEIGHTS_" + std::to_string(set)] = glb.add_floats(weights, "VEC4", 4);
    }
}

}  // namespace

Json primitive_of(Glb& glb, const aiMesh& mesh, bool with_joints, LeftOut& left_out) {
    const bool has_triangles = (mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0,
               has_lines = (mesh.mPrimitiveTypes & aiPrimitiveType_LINE) != 0;
    const Mode mode = has_triangles ? triangles : has_lines ? lines : points;
    const std::vector<std::uint32_t> indices = indices_of(mesh, has_triangles ? 3 : has_lines ? 2 : 1);
    if (indices.empty() || !mesh.HasPositions()) return {};
    Json attributes = {{"POSITION", glb.add_bounded({&mesh.mVertices->x, 3 * mesh.mNumVertices}, "VEC3", 3)}};
    if (mesh.HasNormals() && mode == triangles)
        attributes["NORMAL"] = add_vectors(glb, mesh.mNormals, mesh.mNumVertices);
    constexpr unsigned sets = 2;
    for (unsigned set = 0; set < sets && mesh.HasTextureCoords(set); ++set)
        attributes["TEXCOORD_" + std::to_string(set)] = add_uvs(glb, mesh.mTextureCoords[set], mesh.mNumVertices);
    left_out["sets of texture coordinates beyond the second"] += mesh.HasTextureCoords(sets);
    left_out["sets of vertex colours beyond the first"] += mesh.HasVertexColors(1);
    left_out["meshes' morph targets"] += mesh.mNumAnimMeshes > 0;
    if (mesh.HasVertexColors(0)) attributes["COLOR_0"] = add_colors(glb, mesh.mColors[0], mesh.mNumVertices);
    if (with_joints) add_joints(glb, mesh, attributes);
    return {{"attributes", attributes},
            {"indices", glb.add_indices(indices)},
            {"mode", int(mode)},
            {"material", mesh.mMaterialIndex}};
}

}  // namespace claray::assimp
