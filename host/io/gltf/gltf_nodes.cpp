#include "host/io/gltf/gltf_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "host/io/gltf/gltf_choice.hpp"

namespace claray {
namespace {

using std::to_string;

glm::dmat4 local_transform(const tinygltf::Node& node, const std::string& name, const GltfFile& file) {
    const auto check = [&](const std::vector<double>& values, std::size_t expected, const char* what) {
        if (!values.empty() && values.size() != expected)
            file.fail(name + ": its " + what + " has " + to_string(values.size()) + " numbers instead of " +
                      to_string(expected));
        return !values.empty();
    };
    if (check(node.matrix, 16, "matrix")) {
        glm::dmat4 transform(1.0);
        for (int i = 0; i < 16; ++i) transform[i / 4][i % 4] = node.matrix[std::size_t(i)];
        return transform;
    }
    glm::dvec3 translation(0.0), scale(1.0);
    glm::dvec4 rotation(0.0, 0.0, 0.0, 1.0);
    const auto read = [](auto& vector, const std::vector<double>& values) {
        for (int k = 0; k < int(values.size()); ++k) vector[k] = values[std::size_t(k)];
    };
    if (check(node.translation, 3, "translation")) read(translation, node.translation);
    if (check(node.rotation, 4, "rotation")) read(rotation, node.rotation);
    if (check(node.scale, 3, "scale")) read(scale, node.scale);
    if (!(glm::length(rotation) > 1e-6)) file.fail(name + ": its rotation has length 0");
    return transform_of(translation, rotation, scale);
}

bool is_visible(const tinygltf::Node& node) {
    const auto found = node.extensions.find("KHR_node_visibility");
    if (found == node.extensions.end() || !found->second.Has("visible")) return true;
    const tinygltf::Value& visible = found->second.Get("visible");
    return !visible.IsBool() || visible.Get<bool>();
}

std::string name_of_node(const GltfFile& file, std::size_t node) {
    return gltf_name("node", file.model.nodes[node].name, node);
}

std::vector<int> parentless(const GltfFile& file) {
    const std::vector<tinygltf::Node>& nodes = file.model.nodes;
    std::vector<bool> is_child(nodes.size(), false);
    for (const tinygltf::Node& node : nodes)
        for (const int child : node.children)
            if (child >= 0 && std::size_t(child) < is_child.size()) is_child[std::size_t(child)] = true;
    std::vector<int> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i)
        if (!is_child[i]) roots.push_back(int(i));
    return roots;
}

/// All nodes at and below the roots. Without recursion, for chains may be long.
std::vector<PlacedNode> place_below(const std::vector<int>& roots, const GltfFile& file) {
    struct Pending {
        int node;
        glm::dmat4 parent;
        bool visible;
    };
    const std::vector<tinygltf::Node>& nodes = file.model.nodes;
    std::vector<Pending> pending;
    const auto push = [&](const std::vector<int>& children, const glm::dmat4& parent, bool visible) {
        for (std::size_t i = children.size(); i-- > 0;) pending.push_back({children[i], parent, visible});
    };
    push(roots, glm::dmat4(1.0), true);
    std::vector<bool> seen(nodes.size(), false);
    std::vector<PlacedNode> placed;
    while (!pending.empty()) {
        const Pending next = pending.back();
        pending.pop_back();
        if (next.node < 0 || std::size_t(next.node) >= nodes.size())
            file.fail("a scene or node refers to node " + to_string(next.node) + " of " + to_string(nodes.size()));
        const auto i = std::size_t(next.node);
        PlacedNode node{&nodes[i], name_of_node(file, i), {}, next.visible && is_visible(nodes[i])};
        if (seen[i]) file.fail(node.name + " has two parents or is its own descendant", "nodes must form trees");
        seen[i] = true;
        node.world = next.parent * local_transform(nodes[i], node.name, file);
        push(nodes[i].children, node.world, node.visible);
        placed.push_back(std::move(node));
    }
    return placed;
}

}  // namespace

glm::dmat4 transform_of(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale) {
    glm::dmat4 transform = glm::mat4_cast(glm::normalize(glm::dquat(rotation.w, rotation.x, rotation.y, rotation.z)));
    for (int k = 0; k < 3; ++k) transform[k] *= scale[k];
    transform[3] = glm::dvec4(translation, 1.0);
    return transform;
}

const tinygltf::Scene* chosen_scene(const GltfFile& file, const std::string& choice) {
    const std::vector<tinygltf::Scene>& scenes = file.model.scenes;
    if (!choice.empty()) return &scenes[choose(file, "scene", choice, names_of(scenes))];
    if (scenes.empty()) return nullptr;
    const int scene = std::max(file.model.defaultScene, 0);
    if (std::size_t(scene) >= scenes.size())
        file.fail("it refers to scene " + to_string(scene) + " of " + to_string(scenes.size()));
    return &scenes[std::size_t(scene)];
}

std::vector<PlacedNode> place_nodes(const GltfFile& file, const tinygltf::Scene* scene) {
    return place_below(scene ? scene->nodes : parentless(file), file);
}

glm::vec3 axis_of(const PlacedNode& node, int axis, const GltfFile& file) {
    const glm::dvec3 direction(node.world[axis]);
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length))
        file.fail(node.name + ": its transform scales its direction to 0 or infinity; use scales other than 0");
    return glm::vec3(direction / length);
}

NodeTransforms all_transforms(const GltfFile& file) {
    NodeTransforms transforms(file.model.nodes.size());
    for (const PlacedNode& placed : place_below(parentless(file), file))
        transforms[std::size_t(placed.node - file.model.nodes.data())] = placed.world;
    return transforms;
}

}  // namespace claray
