#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/io/assimp/child/conversion.hpp"

namespace claray::assimp {
namespace {

/// Column by column.
Json matrix_of(const aiMatrix4x4& m) {
    return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

bool is_finite(const aiMatrix4x4& m) {
    return std::all_of(&m.a1, &m.a1 + 16, [](ai_real value) { return std::isfinite(value); });
}

std::span<aiNode* const> children_of(const aiNode& node) { return {node.mChildren, node.mNumChildren}; }

/// Assimp leaves FBX in its own unit, in centimetres times `UnitScaleFactor`; other formats have metres, or tell none.
double metres_of(const aiScene& scene) {
    double factor = 0;
    float single = 0;
    if (scene.mMetaData == nullptr) return 1;
    if (!scene.mMetaData->Get("UnitScaleFactor", factor) && scene.mMetaData->Get("UnitScaleFactor", single))
        factor = double(single);
    return factor > 0 && std::isfinite(factor) ? 0.01 * factor : 1;
}

class Nodes {
public:
    Nodes(Glb& glb, const aiScene& scene, LeftOut& left_out) : glb_(glb), scene_(scene), left_out_(left_out) {
        for (const aiAnimation* animation : std::span(scene.mAnimations, scene.mNumAnimations))
            for (const aiNodeAnim* channel : std::span(animation->mChannels, animation->mNumChannels))
                moving_[channel->mNodeName.C_Str()] = true;
    }

    void add_all() {
        const double metres = metres_of(scene_);
        const std::size_t root = glb_.push("nodes", {{"name", "file"}, {"scale", {metres, metres, metres}}});
        number(*scene_.mRootNode, root);
        // Skins name nodes that stand anywhere.
        for (const auto& [node, index] : shown_) show_meshes(*node, index);
        add_cameras_and_lights(glb_, scene_, by_name_, metres, left_out_);
        add_animations(glb_, scene_, by_name_, left_out_);
        glb_.push("scenes", {{"nodes", {root}}});
    }

private:
    void number(const aiNode& node, std::size_t parent) {
        const std::string name = node.mName.C_Str();
        Json object = {{"name", name}};
        const bool moves = moving_.contains(name);
        if (!is_finite(node.mTransformation))
            ++left_out_["transforms that are not finite"];
        else if (moves)
            add_parts(object, node.mTransformation);
        else if (!node.mTransformation.IsIdentity())
            object["matrix"] = matrix_of(node.mTransformation);
        const std::size_t index = glb_.push("nodes", std::move(object));
        glb_.root["nodes"][parent]["children"].push_back(index);
        by_name_.try_emplace(name, index);
        shown_.emplace_back(&node, index);
        for (const aiNode* child : children_of(node)) number(*child, index);
    }

    /// glTF animates nodes without a matrix.
    static void add_parts(Json& object, const aiMatrix4x4& matrix) {
        aiVector3D scale, position;
        aiQuaternion rotation;
        matrix.Decompose(scale, rotation, position);
        object["translation"] = {position.x, position.y, position.z};
        object["rotation"] = {rotation.x, rotation.y, rotation.z, rotation.w};
        object["scale"] = {scale.x, scale.y, scale.z};
    }

    /// What is bent by bones has a node of its own for each mesh, because a skin of glTF belongs to a node.
    void show_meshes(const aiNode& node, std::size_t index) {
        std::vector<unsigned> rigid;
        for (const unsigned mesh : std::span(node.mMeshes, node.mNumMeshes)) {
            if (mesh >= scene_.mNumMeshes) continue;
            const std::optional<std::size_t> skin = skin_of(*scene_.mMeshes[mesh]);
            if (!skin) {
                rigid.push_back(mesh);
            } else if (const std::optional<std::size_t> bent = mesh_of({mesh}, true)) {
                const std::size_t child = glb_.push("nodes", {{"mesh", *bent}, {"skin", *skin}});
                glb_.root["nodes"][index]["children"].push_back(child);
            }
        }
        if (const std::optional<std::size_t> mesh = mesh_of(rigid, false)) glb_.root["nodes"][index]["mesh"] = *mesh;
    }

    [[nodiscard]] std::optional<std::size_t> mesh_of(const std::vector<unsigned>& meshes, bool with_joints) {
        const auto [known, is_new] = meshes_.try_emplace({meshes, with_joints});
        if (!is_new) return known->second;
        Json primitives = Json::array();
        for (const unsigned mesh : meshes) {
            const auto [primitive, is_first] = primitives_.try_emplace({mesh, with_joints});
            if (is_first) primitive->second = primitive_of(glb_, *scene_.mMeshes[mesh], with_joints, left_out_);
            if (!primitive->second.is_null()) primitives.push_back(primitive->second);
        }
        if (!primitives.empty())
            known->second = glb_.push(
                "meshes", {{"name", scene_.mMeshes[meshes[0]]->mName.C_Str()}, {"primitives", std::move(primitives)}});
        return known->second;
    }

    /// None where the mesh has no bones, or one of them is no node.
    [[nodiscard]] std::optional<std::size_t> skin_of(const aiMesh& mesh) {
        const std::span bones(mesh.mBones, mesh.mNumBones);
        if (bones.empty() || bones.size() > 0xffff) return {};
        Json joints = Json::array();
        std::vector<float> matrices;
        for (const aiBone* bone : bones) {
            const auto node = by_name_.find(bone->mName.C_Str());
            if (node == by_name_.end() || !is_finite(bone->mOffsetMatrix)) {
                ++left_out_["skins with bones that are no nodes"];
                return {};
            }
            joints.push_back(node->second);
            for (const Json& value : matrix_of(bone->mOffsetMatrix)) matrices.push_back(value.get<float>());
        }
        return glb_.push("skins", {{"joints", joints}, {"inverseBindMatrices", glb_.add_floats(matrices, "MAT4", 16)}});
    }

    Glb& glb_;
    const aiScene& scene_;
    LeftOut& left_out_;
    std::map<std::string, bool> moving_;
    std::map<std::string, std::size_t> by_name_;
    std::vector<std::pair<const aiNode*, std::size_t>> shown_;
    std::map<std::pair<std::vector<unsigned>, bool>, std::optional<std::size_t>> meshes_;
    std::map<std::pair<unsigned, bool>, Json> primitives_;
};

}  // namespace

void add_nodes(Glb& glb, const aiScene& scene, LeftOut& left_out) { Nodes(glb, scene, left_out).add_all(); }

}  // namespace claray::assimp
