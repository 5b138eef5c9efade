#include "host/io/gltf/decode/gltf_compression.hpp"

#include <cstring>
#include <nlohmann/json.hpp>

namespace claray {
namespace {

using nlohmann::json;

constexpr std::string_view moved_indices = "indices";  // of a primitive, in its Draco extension
constexpr const char* webp_uri = "data:image/webp";
constexpr std::size_t glb_header = 12, chunk_header = 8;

std::string as_little_endian(std::size_t value) {
    std::string bytes;
    for (int shift = 0; shift < 32; shift += 8) bytes += char(value >> shift & 0xff);
    return bytes;
}

std::size_t first_chunk_size(std::string_view glb) {
    std::size_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | std::uint8_t(glb[glb_header + i]);
    return value;
}

std::string with_json(std::string_view glb, std::string text) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::string_view rest = glb.substr(glb_header + chunk_header + first_chunk_size(glb));
    const std::size_t length = glb_header + chunk_header + text.size() + rest.size();
    return std::string(glb.substr(0, 8)) + as_little_endian(length) + as_little_endian(text.size()) + "JSON" + text +
           std::string(rest);
}

/// An object's extension, or null.
json* extension_of(json& object, const char* name) {
    if (!object.is_object() || !object.contains("extensions")) return nullptr;
    json& all = object["extensions"];
    return all.is_object() && all.contains(name) && all[name].is_object() ? &all[name] : nullptr;
}

json* array_of(json& object, const char* name) {
    return object.is_object() && object.contains(name) && object[name].is_array() ? &object[name] : nullptr;
}

bool has_view(json& root, const json& accessor) {
    json* accessors = array_of(root, "accessors");
    if (accessors == nullptr || !accessor.is_number_unsigned() || accessor.get<std::size_t>() >= accessors->size())
        return true;  // nonsense, which others report
    return (*accessors)[accessor.get<std::size_t>()].contains("bufferView");
}

/// Indices without a view are moved out of tinygltf's sight.
void move_indices(json& root, json& primitive) {
    json* draco = extension_of(primitive, draco_extension);
    if (draco == nullptr || !primitive.contains("indices") || has_view(root, primitive["indices"])) return;
    (*draco)[moved_indices] = primitive["indices"];
    primitive.erase("indices");
}

void give_a_byte(json& buffer) {
    json* meshopt = extension_of(buffer, meshopt_extension);
    if (meshopt == nullptr || buffer.contains("uri") || meshopt->value("fallback", json(false)) != json(true)) return;
    buffer["byteLength"] = 1;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
}

void call_webp_bytes(json& image) {
    if (!image.is_object() || !image.contains("uri") || !image["uri"].is_string()) return;
    const std::string& uri = image["uri"].get_ref<const std::string&>();
    if (uri.rfind(webp_uri, 0) == 0) image["uri"] = "data:application/octet-stream" + uri.substr(std::strlen(webp_uri));
}

}  // namespace

bool is_compression(std::string_view extension) {
    return extension == draco_extension || extension == meshopt_extension;
}

bool can_decode(std::string_view extension) {
    return (CLARAY_WITH_DRACO && extension == draco_extension) ||
           (CLARAY_WITH_MESHOPT && extension == meshopt_extension);
}

std::optional<std::string> adapted_to_tinygltf(std::string_view bytes, bool binary) {
    const std::string_view text = binary ? bytes.substr(glb_header + chunk_header, first_chunk_size(bytes)) : bytes;
    const auto mentions = [&](const char* word) { return text.find(word) != std::string_view::npos; };
    if (!mentions(draco_extension) && !mentions(meshopt_extension) && !mentions(webp_uri)) return {};
    json root = json::parse(text, nullptr, false);
    if (!root.is_object()) return {};  // tinygltf says what is wrong
    if (json* meshes = array_of(root, "meshes"))
        for (json& mesh : *meshes)
            if (json* primitives = array_of(mesh, "primitives"))
                for (json& primitive : *primitives) move_indices(root, primitive);
    if (json* buffers = array_of(root, "buffers"))
        for (json& buffer : *buffers) give_a_byte(buffer);
    if (json* images = array_of(root, "images"))
        for (json& image : *images) call_webp_bytes(image);
    std::string changed = root.dump(-1, ' ', false, json::error_handler_t::replace);
    return binary ? with_json(bytes, std::move(changed)) : changed;
}

std::size_t count_in(const GltfFile& file, const tinygltf::Value& object, const char* key, std::size_t fallback,
                     const std::string& name) {
    if (!object.IsObject() || !object.Has(key)) return fallback;
    const tinygltf::Value& value = object.Get(key);
    if (!value.IsInt() || value.GetNumberAsInt() < 0) file.fail(name + ": '" + key + "' is not an index or a size");
    return std::size_t(value.GetNumberAsInt());
}

void decompress(GltfFile& file) {
    tinygltf::Model& model = file.model;
    if (can_decode(meshopt_extension))
        for (std::size_t i = 0; i < model.bufferViews.size(); ++i)
            if (model.bufferViews[i].extensions.count(meshopt_extension) > 0)
                decode_meshopt_view(file, model.bufferViews[i], gltf_name("buffer view", model.bufferViews[i].name, i));
    if (can_decode(draco_extension))
        for (std::size_t i = 0; i < model.meshes.size(); ++i)
            for (tinygltf::Primitive& primitive : model.meshes[i].primitives)
                if (primitive.extensions.count(draco_extension) > 0)
                    decode_draco_primitive(file, primitive, gltf_name("mesh", model.meshes[i].name, i));
}

}  // namespace claray
