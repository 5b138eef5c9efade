#include "host/io/mitsuba/mitsuba_node.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <pugixml.hpp>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/scene_textures.hpp"
#include "host/io/text_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

constexpr int most_elements_deep = 64;          // elements within elements, includes among them
constexpr std::size_t most_nodes = 20'000'000;  // of all files

bool is_vector(const MitsubaNode& node) {
    return node.values.count("x") + node.values.count("y") + node.values.count("z") > 0;
}

/// Attributes x, y, z, or `value` with three numbers or one.
glm::dvec3 vector_of(const MitsubaNode& node, const char* attribute, double missing) {
    const auto numbers = [&](const char* name) {
        const std::vector<double> found = numbers_in(node.value(name), node);
        return found.empty() ? missing : found[0];
    };
    if (is_vector(node)) return {numbers("x"), numbers("y"), numbers("z")};
    const std::vector<double> all = numbers_in(node.value(attribute), node);
    if (all.size() == 1) return glm::dvec3(all[0]);
    if (all.size() != 3) node.refuse("three numbers are expected", "write x, y and z");
    return {all[0], all[1], all[2]};
}

glm::dmat4 matrix_of(const MitsubaNode& node) {
    const std::vector<double> all = numbers_in(node.value("value"), node);
    glm::dmat4 matrix(1.0);
    if (all.size() != 16 && all.size() != 9) node.refuse("a matrix needs 9 or 16 numbers", "write it row by row");
    const int side = all.size() == 16 ? 4 : 3;
    for (int i = 0; i < side * side; ++i) matrix[i % side][i / side] = all[std::size_t(i)];
    return matrix;
}

glm::dmat4 looking(const MitsubaNode& node) {
    const glm::dvec3 origin = vector_of(node, "origin", 0), target = vector_of(node, "target", 0);
    glm::dvec3 up = node.value("up").empty() ? glm::dvec3(0) : vector_of(node, "up", 0);
    const glm::dvec3 forward = target - origin;
    if (glm::length(glm::cross(up, forward)) == 0)
        up = std::abs(forward.x) > std::abs(forward.y) ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    if (!(glm::length(glm::cross(up, forward)) > 0)) node.refuse("the view has no direction", "give another target");
    glm::dmat4 matrix(1.0);
    const glm::dvec3 z = glm::normalize(forward), x = glm::normalize(glm::cross(up, z));
    matrix[0] = glm::dvec4(x, 0), matrix[1] = glm::dvec4(glm::cross(z, x), 0);
    matrix[2] = glm::dvec4(z, 0), matrix[3] = glm::dvec4(origin, 1);
    return matrix;
}

glm::dmat4 step_of(const MitsubaNode& node) {
    const glm::dmat4 one(1.0);
    if (node.tag == "translate") return glm::translate(one, vector_of(node, "value", 0));
    if (node.tag == "scale") return glm::scale(one, vector_of(node, "value", 1));
    if (node.tag == "lookat" || node.tag == "lookAt") return looking(node);
    if (node.tag == "matrix") return matrix_of(node);
    if (node.tag != "rotate") node.refuse("the transform <" + node.tag + "> is unknown", "check its spelling");
    const std::vector<double> angle = numbers_in(node.value("angle"), node);
    const glm::dvec3 axis = vector_of(node, "value", 0);
    if (angle.empty() || !(glm::length(axis) > 0)) node.refuse("a rotation needs an axis and an angle", "give both");
    return glm::rotate(one, angle[0] * std::numbers::pi / 180, axis);
}

/// "toWorld" to "to_world", as Mitsuba reads files of versions before 2.
std::string with_underscores(std::string_view name) {
    std::string result;
    const auto is_upper = [&](std::size_t i) {
        return i < name.size() && std::isupper(static_cast<unsigned char>(name[i]));
    };
    for (std::size_t i = 0; i < name.size(); ++i) {
        if (i == 0 || !is_upper(i) || !std::islower(static_cast<unsigned char>(name[i - 1]))) {
            result += name[i];
            continue;
        }
        result += '_';
        for (; is_upper(i); ++i) result += char(std::tolower(static_cast<unsigned char>(name[i])));
        --i;
    }
    return result;
}

/// uscale and its kin become the transform of coordinates.
void move_offsets(MitsubaNode& node) {
    const bool any =
        node.property("uscale") || node.property("vscale") || node.property("uoffset") || node.property("voffset");
    if (!any) return;
    MitsubaNode to_uv{"transform", {}, "to_uv", {}, {}, {}, node.place};
    const auto text = [&](const char* name, double otherwise) { return std::to_string(node.number(name, otherwise)); };
    MitsubaNode translate{
        "translate", {}, {}, {}, {{"x", text("uoffset", 0)}, {"y", text("voffset", 0)}, {"z", "0"}}, {}, node.place};
    MitsubaNode scale{"scale", {},        {}, {}, {{"x", text("uscale", 1)}, {"y", text("vscale", 1)}, {"z", "1"}},
                      {},      node.place};
    to_uv.children = {std::move(translate), std::move(scale)};
    node.children.push_back(std::move(to_uv));
}

class Reading {
public:
    explicit Reading(const std::filesystem::path& path) : root_(path) {}

    MitsubaNode read(const std::filesystem::path& path, int depth) {
        const std::string text = read_text(path, "check the path");
        pugi::xml_document document;
        const pugi::xml_parse_result parsed =
            document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
        const auto place = [&](std::ptrdiff_t offset) {
            const auto end = text.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ptrdiff_t(text.size()));
            return "'" + path.string() + "' line " + std::to_string(1 + std::count(text.begin(), end, '\n'));
        };
        if (!parsed)
            throw Error(ErrorKind::user, place(parsed.offset) + ": " + parsed.description(), "correct the XML");
        const pugi::xml_node root = document.document_element();
        if (!root) throw Error(ErrorKind::user, "'" + path.string() + "' has no element", "export the scene again");
        const std::string outer = std::exchange(file_, path.string());
        const bool was_old = std::exchange(old_, root.attribute("version").as_double(3) < 2);
        const auto lines = std::exchange(newlines_, newlines_of(text));
        MitsubaNode node = convert(root, depth);
        file_ = outer, old_ = was_old, newlines_ = lines;
        return node;
    }

private:
    static std::vector<std::ptrdiff_t> newlines_of(const std::string& text) {
        std::vector<std::ptrdiff_t> places;
        for (std::size_t i = text.find('\n'); i != std::string::npos; i = text.find('\n', i + 1))
            places.push_back(std::ptrdiff_t(i));
        return places;
    }
    [[nodiscard]] std::string place_of(const pugi::xml_node& xml) const {
        const auto before =
            std::lower_bound(newlines_.begin(), newlines_.end(), xml.offset_debug()) - newlines_.begin();
        return "'" + file_ + "' line " + std::to_string(before + 1);
    }

    /// $name is replaced by the value of the default.
    [[nodiscard]] std::string substituted(const std::string& value, const MitsubaNode& node) const {
        if (value.find('$') == std::string::npos) return value;
        std::string result;
        for (std::size_t i = 0; i < value.size();) {
            if (value[i] != '$') {
                result += value[i++];
                continue;
            }
            std::size_t end = i + 1;
            while (end < value.size() && (std::isalnum(static_cast<unsigned char>(value[end])) || value[end] == '_'))
                ++end;
            const std::string name = value.substr(i + 1, end - i - 1);
            const auto found = defaults_.find(name);
            if (found == defaults_.end())
                node.refuse("the parameter $" + claray::quoted(name) + " has no default",
                            "add a <default> of this name");
            result += found->second;
            i = end;
        }
        return result;
    }

    MitsubaNode convert(const pugi::xml_node& xml, int depth) {
        MitsubaNode node;
        node.tag = xml.name();
        node.place = place_of(xml);
        if (depth > most_elements_deep)
            node.refuse("elements and includes are more than 64 deep", "check the includes for a loop");
        if (++count_ > most_nodes) node.refuse("the scene has more than 20 million elements", "split it");
        for (const pugi::xml_attribute& attribute : xml.attributes()) {
            const std::string name = attribute.name(), value = substituted(attribute.value(), node);
            if (name == "type")
                node.type = value;
            else if (name == "name")
                node.name = old_ ? with_underscores(value) : value;
            else if (name == "id")
                node.id = value;
            else
                node.values[name] = value;
        }
        if (node.tag == "include") return read(included(node), depth + 1);
        for (const pugi::xml_node& child : xml.children()) {
            if (child.type() != pugi::node_element) continue;
            if (std::string_view(child.name()) == "default") {
                defaults_.try_emplace(child.attribute("name").value(), child.attribute("value").value());
                continue;
            }
            MitsubaNode made = convert(child, depth + 1);
            if (made.tag != "scene") {
                node.children.push_back(std::move(made));
                continue;
            }
            for (MitsubaNode& part : made.children) node.children.push_back(std::move(part));  // of an included file
        }
        if (old_) move_offsets(node);
        return node;
    }

    [[nodiscard]] std::filesystem::path included(const MitsubaNode& node) const {
        return path_in_scene(root_.parent_path(), root_.parent_path(), node.value("filename"), root_);
    }

    std::filesystem::path root_;
    std::string file_;
    bool old_ = false;
    std::vector<std::ptrdiff_t> newlines_;
    std::map<std::string, std::string> defaults_;
    std::size_t count_ = 0;
};

}  // namespace

const MitsubaNode* MitsubaNode::property(std::string_view wanted) const {
    for (const MitsubaNode& child : children)
        if (child.name == wanted) return &child;
    return nullptr;
}

std::string MitsubaNode::value(std::string_view attribute) const {
    const auto found = values.find(std::string(attribute));
    return found == values.end() ? std::string() : found->second;
}

double MitsubaNode::number(std::string_view wanted, double otherwise) const {
    const MitsubaNode* found = property(wanted);
    if (!found || (found->tag != "float" && found->tag != "integer")) return otherwise;
    const std::vector<double> all = numbers_in(found->value("value"), *found);
    if (all.size() != 1) found->refuse("a number is expected", "give one");
    return all[0];
}

bool MitsubaNode::flag(std::string_view wanted, bool otherwise) const {
    const MitsubaNode* found = property(wanted);
    return found && found->tag == "boolean" ? found->value("value") == "true" : otherwise;
}

std::string MitsubaNode::text(std::string_view wanted, const std::string& otherwise) const {
    const MitsubaNode* found = property(wanted);
    return found && found->tag == "string" ? found->value("value") : otherwise;
}

glm::dvec3 MitsubaNode::point(std::string_view wanted, const glm::dvec3& otherwise) const {
    const MitsubaNode* found = property(wanted);
    return found ? vector_of(*found, "value", 0) : otherwise;
}

glm::dmat4 MitsubaNode::transform(std::string_view wanted) const {
    glm::dmat4 matrix(1.0);
    if (const MitsubaNode* found = property(wanted))
        for (const MitsubaNode& step : found->children) matrix = step_of(step) * matrix;
    return matrix;
}

void MitsubaNode::refuse(const std::string& what, const std::string& remedy) const {
    throw Error(ErrorKind::user, place + ": " + what, remedy);
}

std::vector<double> numbers_in(const std::string& text, const MitsubaNode& node) {
    std::string spaced = text;
    std::replace(spaced.begin(), spaced.end(), ',', ' ');
    std::replace(spaced.begin(), spaced.end(), '\n', ' ');
    std::vector<double> result;
    std::string_view rest = spaced;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
        const auto number = number_in(word);
        if (!number) node.refuse(claray::quoted(word) + " is no number", "check the value");
        result.push_back(*number);
    }
    return result;
}

MitsubaNode read_mitsuba(const std::filesystem::path& path) {
    MitsubaNode root = Reading(path).read(path, 0);
    if (root.tag != "scene") root.refuse("the file has no <scene>", "give a scene of Mitsuba 3");
    return root;
}

}  // namespace claray
