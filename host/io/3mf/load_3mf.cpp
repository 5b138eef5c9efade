// 3MF: the Core Specification 1.3, components in other parts (Production Extension), and colours and textures
// (Materials and Properties Extension).
#include <charconv>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <memory>
#include <new>
#include <pugixml.hpp>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/3mf/zip_file.hpp"
#include "host/io/image/color.hpp"
#include "host/io/image/image_file.hpp"
#include "host/io/mesh/ply_faces.hpp"
#include "host/io/mesh/positions.hpp"
#include "host/io/obj/mtl.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/scene_textures.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

using std::to_string;

/// Without the prefix of its namespace, which files choose.
std::string_view local_name_of(std::string_view name) {
    const std::size_t colon = name.find(':');
    return colon == name.npos ? name : name.substr(colon + 1);
}

pugi::xml_node child_named(const pugi::xml_node& node, std::string_view name) {
    for (const pugi::xml_node& child : node.children())
        if (local_name_of(child.name()) == name) return child;
    return {};
}

std::string attribute_named(const pugi::xml_node& node, std::string_view name) {
    for (const pugi::xml_attribute& attribute : node.attributes())
        if (local_name_of(attribute.name()) == name) return attribute.value();
    return {};
}

/// What a group of properties says of one corner: a colour, or a place in an image.
struct CornerProperty {
    glm::vec4 color{1.f};
    glm::vec2 uv{0.f};
    std::uint32_t material = 0;
};
constexpr std::uint32_t plain_material = 0, colored_material = 1;  // materials; textures follow

/// A model part of the archive.
struct ModelPart {
    std::unique_ptr<pugi::xml_document> document;
    std::map<std::string, pugi::xml_node> objects;
    std::map<std::string, std::vector<CornerProperty>> properties;
};

class ThreeMfLoader {
public:
    ThreeMfLoader(const std::filesystem::path& path, std::string_view bytes, Warnings& warnings)
        : path_(path), zip_(bytes, path), warnings_(warnings) {
        scene_.name = path.stem().string();
        scene_.materials = {grey_lambert(scene_.name), grey_lambert("colours")};
        scene_.materials[colored_material].albedo = glm::vec3(1.f);
    }

    Scene load() {
        const std::string root = root_part();
        const pugi::xml_node model = model_of(root).document->document_element();
        // Metres, and y upwards instead of z.
        const glm::dmat4 to_world =
            glm::rotate(glm::scale(glm::dmat4(1.0), glm::dvec3(metres_of(attribute_named(model, "unit")))),
                        glm::radians(-90.0), glm::dvec3(1, 0, 0));
        for (const pugi::xml_node& item : child_named(model, "build").children())
            if (local_name_of(item.name()) == "item") place(item, root, to_world, 0);
        finish();
        return std::move(scene_);
    }

private:
    [[noreturn]] void refuse(const std::string& what) const { zip_.refuse(what); }

    /// The part that the package names, of the type of 3D models.
    [[nodiscard]] std::string root_part() const {
        const std::optional<std::string> text = zip_.read("_rels/.rels");
        pugi::xml_document relations;
        if (text && relations.load_buffer(text->data(), text->size()))
            for (const pugi::xml_node& relation : relations.document_element().children())
                if (attribute_named(relation, "Type").ends_with("/3dmodel")) return attribute_named(relation, "Target");
        return "3D/3dmodel.model";
    }

    ModelPart& model_of(const std::string& part) {
        const auto [found, is_new] = models_.try_emplace(part);
        ModelPart& model = found->second;
        if (!is_new) return model;
        const std::optional<std::string> text = zip_.read(part);
        if (!text) refuse("it has no part " + claray::quoted(part));
        model.document = std::make_unique<pugi::xml_document>();
        const pugi::xml_parse_result parsed = model.document->load_buffer(text->data(), text->size());
        if (!parsed) refuse("its part " + claray::quoted(part) + " is no XML: " + parsed.description());
        const pugi::xml_node resources = child_named(model.document->document_element(), "resources");
        for (const pugi::xml_node& resource : resources.children()) {
            const std::string id = attribute_named(resource, "id");
            if (local_name_of(resource.name()) == "object")
                model.objects.try_emplace(id, resource);
            else
                model.properties[id] = properties_of(resource, resources, model);
        }
        return model;
    }

    double metres_of(const std::string& unit) const {
        constexpr std::pair<const char*, double> units[] = {
            {"micron", 1e-6}, {"", 1e-3},       {"millimeter", 1e-3}, {"centimeter", 1e-2},
            {"inch", 0.0254}, {"foot", 0.3048}, {"meter", 1}};
        for (const auto& [name, metres] : units)
            if (unit == name) return metres;
        refuse("its unit " + claray::quoted(unit) + " is unknown");
    }

    double number(const std::string& text, const char* of) const {
        const std::optional<double> value = number_in(text);
        if (!value) refuse(claray::quoted(text) + " is no number of " + of);
        return *value;
    }
    std::size_t index(const std::string& text, std::size_t count, const char* of) const {
        const double value = number(text, of);
        if (!(value >= 0 && value < double(count)) || value != std::floor(value))
            refuse(claray::quoted(text) + " is out of range, there are " + to_string(count) + " " + of);
        return std::size_t(value);
    }

    /// #RRGGBB or #RRGGBBAA, encoded as sRGB. Programs that write an alpha of 0 mean the colour.
    glm::vec4 color_of(const std::string& text) const {
        std::uint32_t value = 0;
        const bool has_alpha = text.size() == 9;
        const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), value, 16);
        if ((!has_alpha && text.size() != 7) || text[0] != '#' || error != std::errc() ||
            end != text.data() + text.size())
            refuse(claray::quoted(text) + " is no colour");
        if (!has_alpha) value = value << 8 | 255;
        if ((value & 255) == 0) value |= 255;
        const glm::dvec3 display(value >> 24, value >> 16 & 255, value >> 8 & 255);
        return {linear_from_display(display / 255.0), float(value & 255) / 255.f};
    }

    std::vector<CornerProperty> properties_of(const pugi::xml_node& group, const pugi::xml_node& resources,
                                              ModelPart& model) {
        const std::string_view kind = local_name_of(group.name());
        std::vector<CornerProperty> result;
        const std::uint32_t image = kind == "texture2dgroup" ? texture(attribute_named(group, "texid"), resources) : 0;
        for (const pugi::xml_node& entry : group.children()) {
            const std::string_view name = local_name_of(entry.name());
            if (name == "base")
                result.push_back(
                    {.color = color_of(attribute_named(entry, "displaycolor")), .material = colored_material});
            if (name == "color")
                result.push_back({.color = color_of(attribute_named(entry, "color")), .material = colored_material});
            if (name == "tex2coord")
                result.push_back({.uv = {float(number(attribute_named(entry, "u"), "texture coordinates")),
                                         1.f - float(number(attribute_named(entry, "v"), "texture coordinates"))},
                                  .material = image});
            if (name == "composite") result.push_back(composite(entry, group, model));
            if (name == "multi") result.push_back(first_layer(entry, group, model));
        }
        return result;
    }

    const std::vector<CornerProperty>* group_of(const std::string& id, const ModelPart& model) const {
        const auto found = model.properties.find(id);
        return found == model.properties.end() ? nullptr : &found->second;
    }

    /// A mixture of base materials.
    CornerProperty composite(const pugi::xml_node& entry, const pugi::xml_node& group, const ModelPart& model) const {
        const std::vector<CornerProperty>* const bases = group_of(attribute_named(group, "matid"), model);
        const std::string values = attribute_named(entry, "values"), indices = attribute_named(group, "matindices");
        std::string_view value_words = values, index_words = indices;
        glm::vec4 sum(0.f);
        float weights = 0;
        for (std::string_view word = next_word(value_words); !word.empty() && bases; word = next_word(value_words)) {
            const std::string at(next_word(index_words));
            const auto weight = float(number(std::string(word), "a mixture"));
            sum += weight * (*bases)[index(at, bases->size(), "base materials")].color;
            weights += weight;
        }
        return {.color = weights > 0 ? glm::clamp(sum / weights, 0.f, 1.f) : glm::vec4(1.f),
                .material = colored_material};
    }

    /// Layers over layers: the first is shown.
    CornerProperty first_layer(const pugi::xml_node& entry, const pugi::xml_node& group, const ModelPart& model) {
        has_layers_ = true;
        const std::string ids = attribute_named(group, "pids"), indices = attribute_named(entry, "pindices");
        std::string_view id_words = ids, index_words = indices;
        const std::vector<CornerProperty>* const layer = group_of(std::string(next_word(id_words)), model);
        if (!layer || layer->empty()) return {};
        const std::string at(next_word(index_words));
        const double place = at.empty() ? 0 : number(at, "properties");  // some point beyond their layer
        return place >= 0 && place < double(layer->size()) ? (*layer)[std::size_t(place)]
                                                           : CornerProperty{.material = colored_material};
    }

    /// The material of an image in the archive; colours where it cannot be found.
    std::uint32_t texture(const std::string& id, const pugi::xml_node& resources) {
        for (const pugi::xml_node& node : resources.children()) {
            if (local_name_of(node.name()) != "texture2d" || attribute_named(node, "id") != id) continue;
            const std::string part = attribute_named(node, "path");
            TextureSettings settings;
            settings.wrap_u = wrap_of(attribute_named(node, "tilestyleu"));
            settings.wrap_v = wrap_of(attribute_named(node, "tilestylev"));
            const auto image = textures_.add(part, settings, [&](TexelFormat format, std::size_t room) {
                const std::optional<std::string> bytes = zip_.read(part);
                if (!bytes) return std::optional<Texture>();
                const std::string what = "'" + path_.string() + "': part " + claray::quoted(part);
                return std::optional(decode_texture(*bytes, what, format, room));
            });
            if (!image) {
                warnings_.push_back("'" + path_.string() + "': the image " + claray::quoted(part) + " is missing");
                return colored_material;
            }
            Material material = grey_lambert(part);
            material.albedo = glm::vec3(1.f);
            material.albedo_map.texture = *image;
            scene_.materials.push_back(material);
            return std::uint32_t(scene_.materials.size() - 1);
        }
        return colored_material;
    }

    static Wrap wrap_of(const std::string& style) {
        return style == "mirror" ? Wrap::mirror : style == "clamp" || style == "none" ? Wrap::clamp : Wrap::repeat;
    }

    glm::dmat4 transform_of(const pugi::xml_node& node) const {
        const std::string text = attribute_named(node, "transform");
        glm::dmat4 matrix(1.0);
        if (text.empty()) return matrix;
        std::string_view words = text;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 3; ++row)
                matrix[column][row] = number(std::string(next_word(words)), "a transform");
        return matrix;
    }

    /// An item or a component, which names an object, perhaps one of another part.
    void place(const pugi::xml_node& node, const std::string& part, const glm::dmat4& outer, int depth) {
        constexpr std::size_t most_places = 1'000'000;  // components of components may be very many
        constexpr int deepest = 64;
        if (++places_ > most_places || depth > deepest) refuse("its components are nested too deeply, or too many");
        const std::string path = attribute_named(node, "path"), id = attribute_named(node, "objectid"),
                          own = path.empty() ? part : path;
        const ModelPart& model = model_of(own);
        const auto found = model.objects.find(id);
        if (found == model.objects.end()) refuse("it has no object " + claray::quoted(id));
        const glm::dmat4 world = outer * transform_of(node);
        for (const pugi::xml_node& component : child_named(found->second, "components").children())
            if (local_name_of(component.name()) == "component") place(component, own, world, depth + 1);
        const pugi::xml_node mesh = child_named(found->second, "mesh");
        if (!mesh) return;
        const auto [known, is_new] = meshes_.try_emplace({own, id});
        if (is_new) known->second = add_mesh(found->second, mesh, model);
        if (known->second)
            scene_.instances.push_back({*known->second, glm::mat4(world), {}, attribute_named(found->second, "name")});
    }

    std::optional<std::uint32_t> add_mesh(const pugi::xml_node& object, const pugi::xml_node& source,
                                          const ModelPart& model) {
        Mesh vertices;
        vertices.name = attribute_named(object, "name");
        for (const pugi::xml_node& vertex : child_named(source, "vertices").children())
            if (local_name_of(vertex.name()) == "vertex") {
                glm::vec3 position;
                for (int k = 0; k < 3; ++k)
                    position[k] = float(number(vertex.attribute(k == 0   ? "x"
                                                                : k == 1 ? "y"
                                                                         : "z")
                                                   .value(),
                                               "vertices"));
                vertices.positions.push_back(position);
            }
        has_beams_ |= bool(child_named(source, "beamlattice"));
        const pugi::xml_node triangles = child_named(source, "triangles");
        if (!triangles || triangles.first_child().empty()) return {};
        warn_of_positions(vertices, path_, warnings_);
        scene_.meshes.push_back(mesh_of(std::move(vertices), triangles, object, model));
        return std::uint32_t(scene_.meshes.size() - 1);
    }

    Mesh mesh_of(Mesh vertices, const pugi::xml_node& source, const pugi::xml_node& object, const ModelPart& model) {
        const std::string object_id = attribute_named(object, "pid"), object_index = attribute_named(object, "pindex");
        const std::size_t count = vertices.positions.size();
        PlyCorners corners(std::move(vertices), true, true);
        std::vector<glm::uvec3> triangles;
        std::vector<std::uint32_t> materials;
        for (const pugi::xml_node& node : source.children()) {
            if (local_name_of(node.name()) != "triangle") continue;
            const std::string own_id = attribute_named(node, "pid"), first = attribute_named(node, "p1");
            const std::vector<CornerProperty>* const group = group_of(own_id.empty() ? object_id : own_id, model);
            glm::uvec3 triangle;
            std::uint32_t material = plain_material;
            for (int k = 0; k < 3; ++k) {
                static constexpr const char *vertex_names[] = {"v1", "v2", "v3"},
                                            *property_names[] = {"p1", "p2", "p3"};
                std::string at = attribute_named(node, property_names[k]);
                if (at.empty()) at = first.empty() ? object_index : first;
                CornerProperty property{.color = glm::vec4(1.f)};
                if (group && !at.empty()) property = (*group)[index(at, group->size(), "properties")];
                if (k == 0) material = property.material;
                const std::size_t vertex = index(attribute_named(node, vertex_names[k]), count, "vertices");
                triangle[k] = corners.number({std::uint32_t(vertex), property.uv, property.color});
            }
            triangles.push_back(triangle);
            materials.push_back(material);
        }
        Mesh mesh = corners.take();
        mesh.triangles = std::move(triangles), mesh.materials = std::move(materials);
        return mesh;
    }

    void finish() {
        if (scene_.meshes.empty())
            refuse(has_beams_ ? "it contains no triangle, only a beam lattice" : "it contains no triangle");
        if (has_layers_)
            warnings_.push_back("'" + path_.string() + "': of layers of properties only the first is shown");
        if (has_beams_) warnings_.push_back("'" + path_.string() + "': beam lattices are left out");
        bool lets_through = false;
        for (const Mesh& mesh : scene_.meshes)
            for (const glm::vec4& color : mesh.colors) lets_through |= color.w < 1.f;
        if (lets_through) scene_.materials[colored_material].alpha_mode = AlphaMode::blend;
        if (scene_.instances.size() == scene_.meshes.size()) put_in_place();
    }

    /// Two levels cost time, which only meshes that are shown twice are worth.
    void put_in_place() {
        for (const MeshInstance& instance : scene_.instances) {
            Mesh& mesh = scene_.meshes[instance.mesh];
            for (glm::vec3& p : mesh.positions) p = glm::vec3(instance.transform * glm::vec4(p, 1.f));
            if (glm::determinant(glm::mat3(instance.transform)) < 0)
                for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
            if (mesh.name.empty()) mesh.name = instance.name;
        }
        scene_.instances.clear();
    }

    const std::filesystem::path& path_;
    ZipFile zip_;
    Warnings& warnings_;
    Scene scene_;
    SceneTextures textures_{scene_};
    std::map<std::string, ModelPart> models_;
    std::map<std::pair<std::string, std::string>, std::optional<std::uint32_t>> meshes_;
    std::size_t places_ = 0;
    bool has_layers_ = false, has_beams_ = false;
};

}  // namespace

Scene load_3mf_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions&) try {
    const std::string bytes = read_file(path, "check the path");
    if (bytes.empty()) throw Error(ErrorKind::user, "'" + path.string() + "' is empty", "export it again");
    Scene scene = ThreeMfLoader(path, bytes, warnings).load();
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
