// From a glTF's nodes to a scene.
#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <set>

#include "claray/error.hpp"
#include "host/base/message.hpp"
#include "host/io/gltf/gltf_animation.hpp"
#include "host/io/gltf/gltf_choice.hpp"
#include "host/io/gltf/gltf_instancing.hpp"
#include "host/io/gltf/gltf_lights.hpp"
#include "host/io/gltf/gltf_mesh.hpp"
#include "host/io/gltf/materials/gltf_material.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/strokes.hpp"

namespace claray {
namespace {

using std::to_string;

/// `name` is the node's.
void check_transform(const glm::dmat4& m, const std::string& name, const GltfFile& file) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(float(m[column][row]))) file.fail(name + ": its transform is not finite");
    if (glm::vec4(m[0][3], m[1][3], m[2][3], m[3][3]) != glm::vec4(0, 0, 0, 1))
        file.fail(name + ": its transform is not affine", "the last row of a matrix must be 0 0 0 1");
}

/// Scaled to nothing, by which glTF hides a node (section 3.5.3); what is not visible is placed like that.
bool hides(const glm::dmat4& m) { return glm::dmat3(m) == glm::dmat3(0.0); }

/// An instance's rays are transformed by the inverse, in float32: what is flatter than this is moved itself.
bool suits_instances(const glm::dmat4& m) {
    constexpr double largest_condition = 1e4;
    const auto size = [](const glm::dmat3& a) {
        return std::sqrt(glm::dot(a[0], a[0]) + glm::dot(a[1], a[1]) + glm::dot(a[2], a[2]));
    };
    const glm::dmat3 linear(m);
    return size(linear) * size(glm::inverse(linear)) < largest_condition;  // false where there is no inverse
}

/// What the camera shows of what lies before it. The image's own aspect counts, not the file's.
void set_projection(Camera& camera, const tinygltf::Camera& source, const std::string& name, const GltfFile& file) {
    if (source.type == "orthographic") {
        camera.projection = Projection::orthographic;
        camera.orthographic_height = float(2 * std::abs(source.orthographic.ymag));
        if (!(camera.orthographic_height > 0.f) || !std::isfinite(camera.orthographic_height))
            file.fail(name + ": its ymag is " + to_string(source.orthographic.ymag), "it must be above 0");
        return;
    }
    if (source.type != "perspective") file.fail(name + " has the unknown type '" + source.type + "'");
    camera.vertical_fov = glm::degrees(float(source.perspective.yfov));
    if (!(camera.vertical_fov > 0.f && camera.vertical_fov < 180.f))
        file.fail(name + ": its field of view is " + to_string(source.perspective.yfov) + " radians",
                  "it must be between 0 and pi");
}

/// A mesh of the file in a pose. Nodes that show the same shape share its meshes.
struct Shape {
    int mesh = -1;
    int skin = -1;
    std::vector<double> weights;  ///< of the morph targets; empty: none counts

    auto operator<=>(const Shape&) const = default;
};

struct PlacedShape {
    const Shape* shape = nullptr;
    glm::dmat4 world{1.0};
    const PlacedNode* node = nullptr;
};

/// Of a shape: its meshes in the scene, and how often it is shown.
struct ShapeUse {
    std::size_t count = 0;
    std::optional<std::vector<std::uint32_t>> meshes = {};
    std::vector<Strokes> strokes = {};  ///< as they are in the object
};

class Loader {
public:
    Loader(const GltfFile& file, const LoadOptions& options, Scene& scene, Warnings& warnings)
        : file_(file),
          options_(options),
          scene_(scene),
          warnings_(warnings),
          images_(file, warnings, options.images),
          materials_(file, scene, warnings, images_) {}

    void load() {
        choose_variant();
        const tinygltf::Scene* scene = chosen_scene(file_, options_.scene);
        const std::vector<PlacedNode> nodes = place_nodes(file_, scene);
        add_camera(nodes);
        for (const PlacedNode& node : nodes)
            if (node.visible) add_lights(file_, node, scene_);
        if (scene) add_environment(file_, *scene, images_, scene_, warnings_);
        const std::vector<PlacedShape> shapes = place_shapes(nodes);
        add_meshes(shapes);
        if (options_.live) name_objects(shapes), aim_camera();
        warn();
    }

private:
    void choose_variant();
    void add_camera(const std::vector<PlacedNode>& nodes);
    [[nodiscard]] const PlacedNode& chosen_camera(const std::vector<const PlacedNode*>& nodes) const;
    [[nodiscard]] const tinygltf::Camera& camera_of(const PlacedNode& node) const;
    [[nodiscard]] std::vector<std::string> names_of_cameras(const std::vector<const PlacedNode*>& nodes) const;
    [[nodiscard]] Shape shape_of(const PlacedNode& node);
    [[nodiscard]] std::vector<glm::dmat4> places_of(const PlacedNode& node, const Shape& shape) const;
    [[nodiscard]] std::vector<PlacedShape> place_shapes(const std::vector<PlacedNode>& nodes);
    void add_meshes(const std::vector<PlacedShape>& shapes);
    [[nodiscard]] std::vector<Mesh> read_shape(const Shape& shape, std::vector<Strokes>& strokes);
    void name_objects(const std::vector<PlacedShape>& shapes);
    void aim_camera();
    void add_instance(std::uint32_t mesh, const glm::dmat4& world);
    [[nodiscard]] int material_of(const tinygltf::Primitive& primitive) const;
    void warn();
    void warn_if(std::size_t count, const std::string& what) {
        if (count > 0) warnings_.push_back(to_string(count) + " " + what);
    }

    const GltfFile& file_;
    const LoadOptions& options_;
    Scene& scene_;
    Warnings& warnings_;
    GltfImages images_;
    GltfMaterials materials_;
    std::optional<std::size_t> variant_;
    std::map<Shape, ShapeUse> shapes_;
    NodeTransforms transforms_;     ///< where there are skins
    std::vector<Strokes> strokes_;  ///< in the world
    GltfLeftOut left_out_;
    std::size_t without_joints_ = 0;
};

void Loader::choose_variant() {
    static const std::string extension = "KHR_materials_variants";
    const auto found = file_.model.extensions.find(extension);
    std::vector<std::string> names;
    if (found != file_.model.extensions.end() && found->second.Has("variants")) {
        const tinygltf::Value& variants = found->second.Get("variants");
        for (std::size_t i = 0; i < variants.ArrayLen(); ++i) {
            const tinygltf::Value& name = variants.Get(i).Get("name");
            names.push_back(name.IsString() ? name.Get<std::string>() : std::string());
        }
    }
    if (!options_.variant.empty())
        variant_ = choose(file_, "variant", options_.variant, names);
    else if (!names.empty())
        warnings_.push_back("the materials have variants, " + listed(names) + ": choose one with --variant");
}

/// The material of the variant that is chosen, if the primitive has one.
int Loader::material_of(const tinygltf::Primitive& primitive) const {
    const auto found = primitive.extensions.find("KHR_materials_variants");
    if (!variant_ || found == primitive.extensions.end()) return primitive.material;
    const tinygltf::Value& mappings = found->second.Get("mappings");
    for (std::size_t i = 0; i < mappings.ArrayLen(); ++i) {
        const tinygltf::Value &variants = mappings.Get(i).Get("variants"), &material = mappings.Get(i).Get("material");
        for (std::size_t k = 0; k < variants.ArrayLen(); ++k)
            if (variants.Get(k).IsInt() && std::size_t(variants.Get(k).GetNumberAsInt()) == *variant_)
                return material.IsInt() ? material.GetNumberAsInt() : -1;
    }
    return primitive.material;
}

const tinygltf::Camera& Loader::camera_of(const PlacedNode& node) const {
    const std::vector<tinygltf::Camera>& cameras = file_.model.cameras;
    const auto index = std::size_t(node.node->camera);
    if (index >= cameras.size())
        file_.fail(node.name + " refers to camera " + to_string(index) + " of " + to_string(cameras.size()));
    return cameras[index];
}

/// Those of their nodes where these have names.
std::vector<std::string> Loader::names_of_cameras(const std::vector<const PlacedNode*>& nodes) const {
    std::vector<std::string> names;
    for (const PlacedNode* node : nodes)
        names.push_back(node->node->name.empty() ? camera_of(*node).name : node->node->name);
    return names;
}

/// By the name of its node, else by its own, else by its index in the scene.
const PlacedNode& Loader::chosen_camera(const std::vector<const PlacedNode*>& nodes) const {
    if (options_.camera.empty()) return *nodes.front();
    for (const PlacedNode* node : nodes)
        if (node->node->name == options_.camera) return *node;
    for (const PlacedNode* node : nodes)
        if (camera_of(*node).name == options_.camera) return *node;
    return *nodes[choose(file_, "camera", options_.camera, names_of_cameras(nodes))];
}

void Loader::add_camera(const std::vector<PlacedNode>& nodes) {
    std::vector<const PlacedNode*> cameras;
    for (const PlacedNode& node : nodes)
        if (node.node->camera >= 0) cameras.push_back(&node);
    if (cameras.empty() && options_.camera.empty()) return;
    const PlacedNode& node = chosen_camera(cameras);
    const tinygltf::Camera& source = camera_of(node);
    Camera camera;
    camera.position = position_of(node);
    camera.target = camera.position - axis_of(node, 2, file_);
    camera.up = axis_of(node, 1, file_);
    set_projection(camera, source, gltf_name("camera", source.name, std::size_t(node.node->camera)), file_);
    scene_.camera = camera;
    if (cameras.size() > 1 && options_.camera.empty())
        warnings_.push_back("the first of the cameras " + listed(names_of_cameras(cameras)) +
                            " is used: choose another with --file-camera");
}

/// Weights of a node stand in for those of its mesh (section 3.7.2.2).
Shape Loader::shape_of(const PlacedNode& node) {
    const std::vector<tinygltf::Mesh>& meshes = file_.model.meshes;
    Shape shape;
    shape.mesh = node.node->mesh;
    if (std::size_t(shape.mesh) >= meshes.size())
        file_.fail(node.name + " refers to mesh " + to_string(shape.mesh) + " of " + to_string(meshes.size()));
    const tinygltf::Mesh& mesh = meshes[std::size_t(shape.mesh)];
    shape.weights = node.node->weights.empty() ? mesh.weights : node.node->weights;
    shape.weights.resize(morph_targets(file_, *node.node), 0.0);
    for (const double weight : shape.weights)
        if (!std::isfinite(weight)) file_.fail(node.name + " has a weight of a morph target that is not finite");
    if (std::all_of(shape.weights.begin(), shape.weights.end(), [](double w) { return w == 0; })) shape.weights.clear();
    if (node.node->skin < 0) return shape;
    const bool has_joints = std::all_of(mesh.primitives.begin(), mesh.primitives.end(), [](const auto& primitive) {
        return primitive.attributes.count("JOINTS_0") > 0;
    });
    if (has_joints) shape.skin = node.node->skin;
    without_joints_ += !has_joints;
    return shape;
}

/// What follows joints is put where these are: the node's own transform does not count (section 3.7.3.3).
std::vector<glm::dmat4> Loader::places_of(const PlacedNode& node, const Shape& shape) const {
    if (!node.visible) return {glm::dmat4(glm::dmat3(0.0))};
    return shape.skin >= 0 ? std::vector(1, glm::dmat4(1.0)) : placements_of(file_, node);
}

std::vector<PlacedShape> Loader::place_shapes(const std::vector<PlacedNode>& nodes) {
    std::vector<PlacedShape> placed;
    for (const PlacedNode& node : nodes) {
        if (node.node->mesh < 0) continue;
        const Shape shape = shape_of(node);
        for (const glm::dmat4& world : places_of(node, shape)) {
            check_transform(world, node.name, file_);
            if (hides(world) && !options_.time) continue;  // of an animation a point is left, so that no frame is empty
            auto& [key, use] = *shapes_.try_emplace(shape).first;
            ++use.count;
            placed.push_back({&key, world, &node});
        }
    }
    return placed;
}

std::vector<Mesh> Loader::read_shape(const Shape& shape, std::vector<Strokes>& strokes) {
    const auto index = std::size_t(shape.mesh);
    const tinygltf::Mesh& source = file_.model.meshes[index];
    GltfPose pose;
    pose.weights = shape.weights;
    if (shape.skin >= 0) {
        if (transforms_.empty()) transforms_ = all_transforms(file_);
        pose.joints = read_skin(file_, std::size_t(shape.skin), transforms_);
    }
    std::vector<Mesh> meshes;
    for (std::size_t i = 0; i < source.primitives.size(); ++i) {
        const std::uint32_t used =
            materials_.index_of(material_of(source.primitives[i]), gltf_name("mesh", source.name, index));
        const Material& m = scene_.materials[used];
        const GltfLook look{used, materials_.uv_sets(used),
                            m.normal_map.used() || m.clearcoat_normal_map.used() || m.anisotropy > 0.f};
        if (std::optional<Mesh> mesh = read_primitive(file_, index, i, look, pose, left_out_))
            (is_strokes(source.primitives[i]) ? strokes : meshes).push_back(*std::move(mesh));
    }
    return meshes;
}

/// Two levels cost time, which a scene asks for only where a shape is used twice; otherwise all are put where they
/// stand.
void Loader::add_meshes(const std::vector<PlacedShape>& shapes) {
    const bool instances =
        std::any_of(shapes_.begin(), shapes_.end(), [](const auto& shape) { return shape.second.count > 1; });
    for (const auto& [shape, world, node] : shapes) {
        std::optional<std::vector<std::uint32_t>>& known = shapes_[*shape].meshes;
        if (!known) {
            known.emplace();
            for (Mesh& mesh : read_shape(*shape, shapes_[*shape].strokes)) {
                known->push_back(std::uint32_t(scene_.meshes.size()));
                scene_.meshes.push_back(instances ? std::move(mesh) : transformed(std::move(mesh), world));
            }
        }
        for (const std::uint32_t mesh : *known)
            if (instances) add_instance(mesh, world);
        for (const Strokes& strokes : shapes_[*shape].strokes) strokes_.push_back(transformed(strokes, world));
    }
    add_strokes(scene_, strokes_, options_.stroke_radius, warnings_);
}

void Loader::add_instance(std::uint32_t mesh, const glm::dmat4& world) {
    if (suits_instances(world)) {
        scene_.instances.push_back({mesh, glm::mat4(world), {}});
        return;
    }
    scene_.instances.push_back({std::uint32_t(scene_.meshes.size()), glm::mat4(1.f), {}});
    scene_.meshes.push_back(transformed(scene_.meshes[mesh], world));
}

/// Meshes that no instance places are in the world. Nodes without a name, or with one that another has, are numbered.
void Loader::name_objects(const std::vector<PlacedShape>& shapes) {
    std::map<const PlacedNode*, std::string> names;
    std::set<std::string> taken;
    const auto name_of = [&](const PlacedNode* node) -> const std::string& {
        const auto [found, is_new] = names.try_emplace(node, one_line(node->node->name));
        const std::string number = "node " + to_string(node->node - file_.model.nodes.data());
        if (is_new && found->second.empty()) found->second = number;
        if (is_new && !taken.insert(found->second).second) found->second += " (" + number + ")";
        return found->second;
    };
    if (scene_.instances.empty())
        for (std::uint32_t mesh = 0; mesh < scene_.meshes.size(); ++mesh) scene_.instances.push_back({mesh});
    std::size_t next = 0;
    for (const PlacedShape& shape : shapes)
        for (std::size_t i = 0; i < shapes_[*shape.shape].meshes->size(); ++i)
            scene_.instances[next++].name = name_of(shape.node);
}

/// The point of its axis that is nearest to the middle of the scene. A camera inside the scene looks at what is around.
void Loader::aim_camera() {
    const Bounds bounds = bounds_of(scene_);
    if (!scene_.camera || bounds.empty()) return;
    Camera& camera = *scene_.camera;
    const glm::vec3 forward = glm::normalize(camera.target - camera.position);
    const float nearest = 0.25f * glm::length(bounds.extent());
    const float distance = std::max(nearest, glm::dot(bounds.center() - camera.position, forward));
    if (distance > 0 && std::isfinite(distance)) camera.target = camera.position + distance * forward;
}

void Loader::warn() {
    warn_if(left_out_.without_positions, "primitives without positions are left out");
    warn_if(left_out_.with_clamped_colors, "primitives have vertex colours outside 0..1: they are clamped");
    warn_if(without_joints_, "nodes have skins, but their meshes have no joints: the transform of the node is used");
}

Scene scene_of(GltfFile file, Warnings& warnings, const LoadOptions& options) {
    Scene scene;
    scene.name = file.path.stem().string();
    pose(file, options, warnings);
    Loader(file, options, scene, warnings).load();
    if (scene.meshes.empty() && scene.primitives.empty())
        file.fail("it contains no triangle", "claray needs a mesh that is used by a node of the scene");
    try {
        validate(scene);
    } catch (const Error& error) {
        throw Error(error.kind(), "'" + file.path.string() + "': " + error.what());
    }
    return scene;
}

[[noreturn]] void refuse_size(const std::filesystem::path& path) {
    throw Error(ErrorKind::user, "'" + path.string() + "': there is not enough memory to load it",
                "use a smaller scene");
}

}  // namespace

Scene load_gltf_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options) try {
    return scene_of(read_gltf(path, warnings), warnings, options);
} catch (const std::bad_alloc&) {
    refuse_size(path);
}

Scene load_gltf_bytes(const std::filesystem::path& path, std::string_view bytes, Warnings& warnings,
                      const LoadOptions& options) try {
    return scene_of(read_gltf(path, bytes, warnings), warnings, options);
} catch (const std::bad_alloc&) {
    refuse_size(path);
}

std::optional<double> gltf_animation_seconds(const std::filesystem::path& path, const LoadOptions& options) {
    Warnings ignored;  // they are those of loading
    return seconds_of_animation(read_gltf(path, ignored), options);
}

std::optional<double> gltf_animation_seconds(const std::filesystem::path& path, std::string_view bytes,
                                             const LoadOptions& options) {
    Warnings ignored;
    return seconds_of_animation(read_gltf(path, bytes, ignored), options);
}

}  // namespace claray
