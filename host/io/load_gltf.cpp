// From a glTF's nodes to a scene.
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <new>

#include "claray/error.hpp"
#include "host/io/default_light.hpp"
#include "host/io/gltf_material.hpp"
#include "host/io/gltf_mesh.hpp"

namespace claray {
namespace {

using std::to_string;

/// A node of the scene, where it stands in the world.
struct PlacedNode {
    const tinygltf::Node* node = nullptr;
    std::string name;
    glm::dmat4 world{1.0};
};

glm::dmat4 local_transform(const tinygltf::Node& node, const std::string& name, const GltfFile& file) {
    const auto check = [&](const std::vector<double>& values, std::size_t expected, const char* what) {
        if (!values.empty() && values.size() != expected)
            file.fail(name + ": its " + what + " has " + to_string(values.size()) + " numbers instead of " +
                      to_string(expected));
        return !values.empty();
    };
    glm::dmat4 transform(1.0);
    if (check(node.matrix, 16, "matrix")) {
        for (int i = 0; i < 16; ++i) transform[i / 4][i % 4] = node.matrix[std::size_t(i)];
        return transform;
    }
    if (check(node.translation, 3, "translation"))
        transform[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1.0);
    if (check(node.rotation, 4, "rotation")) {
        const std::vector<double>& r = node.rotation;
        const glm::dquat q(r[3], r[0], r[1], r[2]);
        if (!(glm::length(q) > 1e-6)) file.fail(name + ": its rotation has no length");
        transform = transform * glm::mat4_cast(glm::normalize(q));
    }
    if (check(node.scale, 3, "scale"))
        for (int k = 0; k < 3; ++k) transform[k] *= node.scale[std::size_t(k)];
    return transform;
}

/// The nodes at the top: of the default scene, else of the first, else all that are no one's child.
std::vector<int> roots_of(const GltfFile& file) {
    const tinygltf::Model& model = file.model;
    if (!model.scenes.empty()) {
        const int scene = std::max(model.defaultScene, 0);
        if (std::size_t(scene) >= model.scenes.size())
            file.fail("it refers to scene " + to_string(scene) + " of " + to_string(model.scenes.size()));
        return model.scenes[std::size_t(scene)].nodes;
    }
    std::vector<bool> is_child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes)
        for (const int child : node.children)
            if (child >= 0 && std::size_t(child) < is_child.size()) is_child[std::size_t(child)] = true;
    std::vector<int> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i)
        if (!is_child[i]) roots.push_back(int(i));
    return roots;
}

/// All nodes below the roots, parents first, in the order of the file. Without recursion, for chains may be long.
std::vector<PlacedNode> place_nodes(const GltfFile& file) {
    struct Pending {
        int node;
        glm::dmat4 parent;
    };
    const std::vector<tinygltf::Node>& nodes = file.model.nodes;
    std::vector<Pending> pending;
    const auto push = [&](const std::vector<int>& children, const glm::dmat4& parent) {
        for (std::size_t i = children.size(); i-- > 0;) pending.push_back({children[i], parent});
    };
    push(roots_of(file), glm::dmat4(1.0));
    std::vector<bool> seen(nodes.size(), false);
    std::vector<PlacedNode> placed;
    while (!pending.empty()) {
        const Pending next = pending.back();
        pending.pop_back();
        if (next.node < 0 || std::size_t(next.node) >= nodes.size())
            file.fail("a scene or node refers to node " + to_string(next.node) + " of " + to_string(nodes.size()));
        const auto i = std::size_t(next.node);
        PlacedNode node{&nodes[i], gltf_name("node", nodes[i].name, i), {}};
        if (seen[i]) file.fail(node.name + " has two parents or is below itself", "nodes must form trees");
        seen[i] = true;
        node.world = next.parent * local_transform(nodes[i], node.name, file);
        push(nodes[i].children, node.world);
        placed.push_back(std::move(node));
    }
    return placed;
}

/// False where a node is scaled to nothing, by which glTF hides it (section 3.5.3).
bool check_transform(const PlacedNode& node, const GltfFile& file) {
    const glm::dmat4& m = node.world;
    double largest = 0.0;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(float(m[column][row]))) file.fail(node.name + ": its transform is not finite");
            if (column < 3 && row < 3) largest = std::max(largest, std::abs(m[column][row]));
        }
    if (glm::vec4(m[0][3], m[1][3], m[2][3], m[3][3]) != glm::vec4(0, 0, 0, 1))
        file.fail(node.name + ": its transform is not affine", "the last row of a matrix must be 0 0 0 1");
    if (largest == 0.0) return false;
    if (std::abs(glm::determinant(glm::dmat3(m) / largest)) < 1e-12)
        file.fail(node.name + ": its transform cannot be inverted", "use scales other than 0");
    return true;
}

/// Where a node stands and looks: along -z, with +y up (section 3.10.2).
glm::vec3 position_of(const PlacedNode& node) { return glm::vec3(node.world[3]); }
glm::vec3 axis_of(const PlacedNode& node, int axis, const GltfFile& file) {
    const glm::dvec3 direction(node.world[axis]);
    const double length = glm::length(direction);
    if (!(length > 0.0) || !std::isfinite(length)) file.fail(node.name + ": its transform gives it no direction");
    return glm::vec3(direction / length);
}

class Loader {
public:
    Loader(const GltfFile& file, Scene& scene, Warnings& warnings)
        : file_(file),
          scene_(scene),
          warnings_(warnings),
          materials_(file, scene, warnings),
          primitives_(file.model.meshes.size()),
          uses_(file.model.meshes.size(), 0) {}

    void load() {
        const std::vector<PlacedNode> nodes = place_nodes(file_);
        for (const PlacedNode& node : nodes) {
            if (node.node->camera >= 0) add_camera(node);
            add_light(node);
        }
        add_meshes(nodes);
        warn(nodes);
    }

private:
    void add_camera(const PlacedNode& node);
    void add_light(const PlacedNode& node);
    void add_meshes(const std::vector<PlacedNode>& nodes);
    [[nodiscard]] std::vector<const PlacedNode*> nodes_with_meshes(const std::vector<PlacedNode>& nodes);
    [[nodiscard]] std::vector<Mesh> read_mesh(std::size_t index);
    void warn(const std::vector<PlacedNode>& nodes);
    void warn_if(std::size_t count, const std::string& what) {
        if (count > 0) warnings_.push_back(to_string(count) + " " + what);
    }

    const GltfFile& file_;
    Scene& scene_;
    Warnings& warnings_;
    GltfMaterials materials_;
    std::vector<std::vector<std::uint32_t>> primitives_;  ///< of each mesh of the file: its meshes in the scene
    std::vector<std::uint32_t> uses_;                     ///< of each mesh of the file: by how many nodes
    GltfLeftOut left_out_;
    std::size_t cameras_left_out_ = 0;
};

void Loader::add_camera(const PlacedNode& node) {
    const std::vector<tinygltf::Camera>& cameras = file_.model.cameras;
    const auto index = std::size_t(node.node->camera);
    if (index >= cameras.size())
        file_.fail(node.name + " refers to camera " + to_string(index) + " of " + to_string(cameras.size()));
    if (cameras[index].type != "perspective" || scene_.camera) {
        ++cameras_left_out_;
        return;
    }
    Camera camera;
    camera.position = position_of(node);
    camera.target = camera.position - axis_of(node, 2, file_);
    camera.up = axis_of(node, 1, file_);
    camera.vertical_fov = glm::degrees(float(cameras[index].perspective.yfov));
    if (!(camera.vertical_fov > 0.f && camera.vertical_fov < 180.f))
        file_.fail(gltf_name("camera", cameras[index].name, index) + ": its field of view is " +
                       to_string(cameras[index].perspective.yfov) + " radians",
                   "it must be between 0 and pi");
    scene_.camera = camera;
}

/// KHR_lights_punctual. Its candela and lux are taken as W / sr and W / m^2, as emissive factors are as radiance.
void Loader::add_light(const PlacedNode& node) {
    const auto found = node.node->extensions.find("KHR_lights_punctual");
    if (found == node.node->extensions.end() || !found->second.Has("light")) return;
    const int index = found->second.Get("light").IsNumber() ? found->second.Get("light").GetNumberAsInt() : -1;
    const std::vector<tinygltf::Light>& lights = file_.model.lights;
    if (index < 0 || std::size_t(index) >= lights.size())
        file_.fail(node.name + " refers to light " + to_string(index) + " of " + to_string(lights.size()));
    const tinygltf::Light& source = lights[std::size_t(index)];
    const std::string name = gltf_name("light", source.name, std::size_t(index));
    Light light;
    light.name = source.name;
    if (source.type == "directional")
        light.kind = LightKind::directional;
    else if (source.type == "spot")
        light.kind = LightKind::spot;
    else if (source.type != "point")
        file_.fail(name + " is of the unknown type '" + source.type + "'", "use point, spot or directional");
    light.position = position_of(node);
    if (light.kind != LightKind::point) light.direction = -axis_of(node, 2, file_);
    for (int k = 0; k < 3; ++k)
        light.intensity[k] = float(source.intensity * (source.color.size() < 3 ? 1.0 : source.color[std::size_t(k)]));
    if (light.kind != LightKind::directional) light.range = float(source.range);
    if (light.kind == LightKind::spot) {
        light.inner_angle = float(source.spot.innerConeAngle);
        light.outer_angle = float(source.spot.outerConeAngle);
    }
    scene_.lights.push_back(light);
}

std::vector<const PlacedNode*> Loader::nodes_with_meshes(const std::vector<PlacedNode>& nodes) {
    std::vector<const PlacedNode*> found;
    for (const PlacedNode& node : nodes) {
        if (node.node->mesh < 0) continue;
        if (std::size_t(node.node->mesh) >= uses_.size())
            file_.fail(node.name + " refers to mesh " + to_string(node.node->mesh) + " of " + to_string(uses_.size()));
        if (!check_transform(node, file_)) continue;
        ++uses_[std::size_t(node.node->mesh)];
        found.push_back(&node);
    }
    return found;
}

std::vector<Mesh> Loader::read_mesh(std::size_t index) {
    const tinygltf::Mesh& source = file_.model.meshes[index];
    std::vector<Mesh> meshes;
    for (std::size_t i = 0; i < source.primitives.size(); ++i) {
        const int material = source.primitives[i].material;
        const std::uint32_t used = materials_.index_of(material, gltf_name("mesh", source.name, index));
        const Material& m = scene_.materials[used];
        const bool tangents = m.normal_map.used() || m.clearcoat_normal_map.used() || m.anisotropy > 0.f;
        if (std::optional<Mesh> mesh = read_primitive(file_, index, i, used, tangents, left_out_))
            meshes.push_back(*std::move(mesh));
    }
    return meshes;
}

/// Two levels cost time, which a scene asks for only where a mesh is used twice; otherwise all are put where they
/// stand.
void Loader::add_meshes(const std::vector<PlacedNode>& nodes) {
    const std::vector<const PlacedNode*> users = nodes_with_meshes(nodes);
    const bool instances = std::any_of(uses_.begin(), uses_.end(), [](std::uint32_t uses) { return uses > 1; });
    std::vector<bool> is_read(uses_.size(), false);
    for (const PlacedNode* node : users) {
        const auto index = std::size_t(node->node->mesh);
        if (!is_read[index]) {
            is_read[index] = true;
            for (Mesh& mesh : read_mesh(index)) {
                primitives_[index].push_back(std::uint32_t(scene_.meshes.size()));
                scene_.meshes.push_back(instances ? std::move(mesh) : transformed(std::move(mesh), node->world));
            }
        }
        for (const std::uint32_t mesh : primitives_[index])
            if (instances) scene_.instances.push_back({mesh, glm::mat4(node->world), {}});
    }
}

void Loader::warn(const std::vector<PlacedNode>& nodes) {
    std::size_t skinned = 0;
    for (const PlacedNode& node : nodes) skinned += node.node->skin >= 0;
    warn_if(left_out_.not_triangles, "primitives of points or lines are left out");
    warn_if(left_out_.without_positions, "primitives without positions are left out");
    warn_if(left_out_.with_clamped_colors, "primitives have colours at vertices beyond 0..1: they are clamped");
    warn_if(left_out_.with_targets, "primitives have morph targets, which are left out");
    warn_if(skinned, "nodes have skins: they are shown as they were before skinning");
    warn_if(file_.model.animations.size(), "animations are left out");
    warn_if(cameras_left_out_, "cameras are left out: the first perspective one is used");
}

}  // namespace

Scene load_gltf_without_light(const std::filesystem::path& path, Warnings& warnings) try {
    Scene scene;
    scene.name = path.stem().string();
    const GltfFile file = read_gltf(path, warnings);
    Loader(file, scene, warnings).load();
    if (scene.meshes.empty()) file.fail("it holds no triangle", "claray needs a mesh that a node of its scene uses");
    try {
        validate(scene);
    } catch (const Error& error) {
        throw Error(error.kind(), "'" + path.string() + "': " + error.what());
    }
    return scene;
} catch (const std::bad_alloc&) {
    throw Error(ErrorKind::user, "'" + path.string() + "': there is not enough memory to load it",
                "use a smaller scene");
}

}  // namespace claray
