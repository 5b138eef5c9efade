#include "host/io/gltf/decode/gltf_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/base/message.hpp"
#include "host/io/gltf/decode/gltf_compression.hpp"

namespace claray {
namespace {

using nlohmann::json;
using std::to_string;

/// Where JSON ends to be JSON, and by what: "line 1, column 30: unexpected ','". The JSON library says it as
/// "[json.exception.parse_error.101] parse error at PLACE: syntax error while parsing WHAT - REASON; HINT".
std::string json_error(const std::string& text) {
    static constexpr std::string_view before = "parse error at ", between = " - ";
    const std::size_t place = text.find(before), colon = text.find(": ", place), reason = text.find(between, colon);
    if (place == std::string::npos || reason == std::string::npos)
        return "its JSON is broken: " + one_line(text.substr(text.find("] ") + 2));
    const std::size_t begin = place + before.size(), words = reason + between.size();
    return "its JSON is broken at " + text.substr(begin, colon - begin) + ": " +
           one_line(text.substr(words, text.find(';', words) - words));
}

json parsed(std::string_view text, const GltfFile& file) {
    json root;
    try {
        root = json::parse(text);
    } catch (const json::exception& error) {
        file.fail(json_error(error.what()));
    }
    if (!root.is_object()) file.fail("its JSON is no object");
    return root;
}

/// An object's extension, or null.
json* extension_of(json& object, const char* name) {
    if (!object.is_object() || !object.contains("extensions")) return nullptr;
    json& all = object["extensions"];
    return all.is_object() && all.contains(name) && all[name].is_object() ? &all[name] : nullptr;
}

/// The objects of an array; what is no object is left to tinygltf, which says so.
template <class Change>
void for_each_object(json& object, const char* name, const Change& change) {
    if (!object.is_object() || !object.contains(name) || !object[name].is_array()) return;
    for (json& element : object[name])
        if (element.is_object()) change(element);
}

bool has_view(json& root, const json& accessor) {
    if (!root.contains("accessors") || !accessor.is_number_unsigned()) return true;  // nonsense, which others report
    const json& accessors = root["accessors"];
    const auto index = accessor.get<std::size_t>();
    return !accessors.is_array() || index >= accessors.size() || accessors[index].contains("bufferView");
}

/// Indices without a view, which tinygltf refuses: they are 0, or compressed elsewhere. -1 where there are none.
int take_indices(json& root, json& primitive) {
    if (!primitive.contains("indices") || has_view(root, primitive["indices"])) return -1;
    const int indices = primitive["indices"].get<int>();
    primitive.erase("indices");
    return indices;
}

/// JSON makes no difference between 2 and 2.0, but tinygltf does.
void write_whole_numbers(json& value) {
    if (value.is_structured())
        for (json& element : value) write_whole_numbers(element);
    if (!value.is_number_float()) return;
    const double number = value.get<double>();
    constexpr double largest = 2147483647;  // tinygltf keeps whole numbers of extensions in 32 bits
    if (number == std::floor(number) && std::abs(number) <= largest && !std::signbit(number))
        value = std::uint64_t(number);
}

std::string json_text(const json& root) { return root.dump(-1, ' ', false, json::error_handler_t::replace); }

/// Takes it away: it may hold all bytes.
std::string take_uri(json& object) {
    const auto found = object.find("uri");
    const bool is_text = found != object.end() && found->is_string();
    return is_text ? std::move(found->get_ref<std::string&>()) : std::string();
}

/// The buffer that stands in its place has one byte.
GltfSource take_buffer(json& buffer, std::size_t index, const GltfFile& file) {
    GltfSource source;
    source.uri = take_uri(buffer);
    const auto length = buffer.find("byteLength");
    const double bytes = length != buffer.end() && length->is_number() ? length->get<double>() : -1;
    if (!(bytes >= 0 && bytes < 1e15)) file.fail("buffer " + to_string(index) + " has no byteLength");
    source.length = std::size_t(bytes);
    for (const char* name : meshopt_extensions)
        if (const json* meshopt = extension_of(buffer, name))
            source.is_optional |= meshopt->value("fallback", json(false)) == json(true);
    buffer["byteLength"] = 1;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    return source;
}

/// The image that stands in its place has the name of a file.
GltfSource take_image(json& image) {
    GltfSource source;
    source.uri = take_uri(image);
    const auto view = image.find("bufferView");
    if (view != image.end() && view->is_number_integer()) source.view = view->get<int>();
    image.erase("bufferView");
    image["uri"] = "image";
    return source;
}

/// The pointer of a channel, empty if it has none.
json::json_pointer pointer_of(json& target) try {
    json* extension = extension_of(target, "KHR_animation_pointer");
    return json::json_pointer(extension ? extension->value("pointer", std::string()) : std::string());
} catch (const json::exception&) {  // it is no pointer
    return json::json_pointer();
}

/// A pointer to what channels of nodes move is written as such a channel.
void name_node(json& target, const json::json_pointer& pointer) {
    const json::json_pointer node = pointer.parent_pointer();
    if (pointer.empty() || node.empty() || node.parent_pointer().to_string() != "/nodes") return;
    const std::string &path = pointer.back(), &index = node.back();
    const bool moves = path == "translation" || path == "rotation" || path == "scale" || path == "weights";
    if (!moves || index.empty() || index.size() > 9 || index.find_first_not_of("0123456789") != index.npos) return;
    target = {{"node", std::stoi(index)}, {"path", path}};
}

/// Channels that move no node become pointers, as far as they have one.
void take_pointers(json& animation, std::size_t index, AdaptedJson& to) {
    if (!animation.contains("channels") || !animation["channels"].is_array()) return;
    json kept = json::array();
    for (json& channel : animation["channels"]) {
        const bool has_target = channel.is_object() && channel.contains("target") && channel["target"].is_object();
        json::json_pointer pointer;
        if (has_target) pointer = pointer_of(channel["target"]), name_node(channel["target"], pointer);
        if (!has_target || (channel["target"].contains("node") && channel["target"].contains("path"))) {
            kept.push_back(std::move(channel));
            continue;
        }
        const auto sampler = channel.find("sampler");
        const bool has_sampler = sampler != channel.end() && sampler->is_number_unsigned();
        if (pointer.empty() || !has_sampler)
            ++to.channels_left_out;
        else
            to.pointers.push_back({index, sampler->get<int>(), pointer.to_string()});
    }
    animation["channels"] = std::move(kept);
}

/// Indices, names and the like do not move (section "Mutable Properties" of the Asset Object Model).
bool can_move(const json& root, const json::json_pointer& place) {
    static constexpr std::string_view roots[] = {"/nodes/", "/materials/", "/cameras/", "/extensions/"},
                                      fixed[] = {"camera", "children", "doubleSided", "index", "light",   "matrix",
                                                 "mesh",   "name",     "skin",        "type",  "texCoord"};
    const std::string text = place.to_string(), &last = place.back();
    const auto begins = [&](std::string_view root_name) { return text.starts_with(root_name); };
    if (std::none_of(std::begin(roots), std::end(roots), begins)) return false;
    if (std::find(std::begin(fixed), std::end(fixed), last) != std::end(fixed)) return false;
    const json::json_pointer parent = place.parent_pointer();
    return root.contains(parent) && (root.at(parent).is_object() || root.contains(place));
}

bool write_change(json& root, const GltfChange& change) try {
    const json::json_pointer place(change.place);
    if (!can_move(root, place)) return false;
    const bool is_known = root.contains(place), one = change.numbers.size() == 1;
    if (is_known && root.at(place).is_array() && root.at(place).size() != change.numbers.size()) return false;
    json& value = root[place];
    if (value.is_boolean() || place.back() == "visible")
        value = change.numbers.at(0) != 0;
    else if (one && !value.is_array())
        value = change.numbers[0];
    else
        value = change.numbers;
    return true;
} catch (const json::exception&) {  // of pointers to what cannot be
    return false;
}

}  // namespace

AdaptedJson adapted_to_tinygltf(std::string_view text, const GltfFile& file) {
    json root = parsed(text, file);
    AdaptedJson adapted;
    write_whole_numbers(root);
    for_each_object(root, "meshes", [&](json& mesh) {
        std::vector<int>& indices = adapted.indices.emplace_back();
        for_each_object(mesh, "primitives", [&](json& primitive) { indices.push_back(take_indices(root, primitive)); });
    });
    for_each_object(root, "buffers", [&](json& buffer) {
        adapted.buffers.push_back(take_buffer(buffer, adapted.buffers.size(), file));
    });
    for_each_object(root, "images", [&](json& image) { adapted.images.push_back(take_image(image)); });
    std::size_t animations = 0;
    for_each_object(root, "animations", [&](json& animation) { take_pointers(animation, animations++, adapted); });
    adapted.text = json_text(root);
    return adapted;
}

std::size_t write_changes(std::string& text, const std::vector<GltfChange>& changes) {
    json root = json::parse(text);
    const auto fails = [&](const GltfChange& change) { return !write_change(root, change); };
    const auto failed = std::size_t(std::count_if(changes.begin(), changes.end(), fails));
    write_whole_numbers(root);
    text = json_text(root);
    return failed;
}

}  // namespace claray
