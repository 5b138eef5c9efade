#include "host/io/gltf/gltf_file.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <sstream>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/gltf/decode/data_uri.hpp"
#include "host/io/gltf/decode/gltf_compression.hpp"
#include "host/io/gltf/decode/gltf_container.hpp"
#include "host/io/gltf/decode/gltf_json.hpp"
#include "host/io/scene_textures.hpp"
#include "host/io/text_file.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using std::to_string;

constexpr std::string_view known_extensions[] = {
    "CLARAY_attenuation",
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",  // integer attributes are read wherever they stand
    "KHR_node_visibility",
    "KHR_texture_transform",
    // Other containers of images: where a texture has no plain one, its material says so.
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "MSFT_texture_dds",
    // What changes no picture: texts, other forms of the same geometry, and coarser nodes and textures beside the
    // finest.
    "EXT_mesh_manifold",
    "EXT_mesh_primitive_restart",
    "FB_geometry_metadata",
    "GODOT_single_root",
    "GRIFFEL_bim_data",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
};

bool is_known(const std::string& extension) {
    return can_decode(extension) ||
           std::find(std::begin(known_extensions), std::end(known_extensions), extension) != std::end(known_extensions);
}

/// One line of at most 200 characters: tinygltf quotes data URIs in full.
std::string in_one_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ' || text.back() == '.')) text.pop_back();
    for (char& c : text)
        if (c == '\n' || c == '\r') c = ' ';
    return text.size() > 200 ? text.substr(0, 200) + "..." : text;
}

/// What tinygltf could go on without, each once: it says the same of each object.
void warn_of_remarks(const std::string& remarks, const GltfFile& file, Warnings& warnings) {
    std::set<std::string> lines;
    std::istringstream text(remarks);
    for (std::string line; std::getline(text, line);)
        if (line.find("'inverseBindMatrices' property is missing") == std::string::npos)  // which it may be
            lines.insert(in_one_line(line));
    for (const std::string& line : lines)
        if (!line.empty())
            warnings.push_back("'" + file.path.string() + "' is not quite a valid glTF: " + line + ": it is ignored");
}

/// Reads what is neither a buffer nor an image: for files of their own, none is said to exist.
tinygltf::Model parsed_model(const GltfFile& file, Warnings& warnings) {
    tinygltf::Model model;
    tinygltf::TinyGLTF parser;
    tinygltf::FsCallbacks callbacks{};
    callbacks.FileExists = [](const std::string&, void*) { return false; };
    callbacks.ExpandFilePath = [](const std::string& name, void*) { return name; };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) {
        return false;
    };
    parser.SetFsCallbacks(callbacks);
    std::string errors, remarks;  // remarks are about images only
    bool ok = false;
    try {
        ok = parser.LoadASCIIFromString(&model, &errors, &remarks, file.json.data(), unsigned(file.json.size()), "");
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        errors = error.what();
    }
    if (!ok) file.fail("not a valid glTF: " + (errors.empty() ? "a property is missing" : in_one_line(errors)));
    warn_of_remarks(errors, file, warnings);
    return model;
}

std::string bytes_of(const GltfSource& source, const std::string& name, const GltfFile& file) {
    if (!is_data_uri(source.uri)) {
        const fs::path folder = file.path.parent_path();
        return read_file(path_in_scene(folder, folder, percent_decoded(source.uri), file.path),
                         "put the buffer next to the glTF");
    }
    if (std::optional<std::string> bytes = decode_data_uri(source.uri)) return *std::move(bytes);
    file.fail(name + ": the base64 of its data URI is damaged");
}

/// A buffer may hold more than its length, as padding.
void read_buffers(const std::vector<GltfSource>& sources, const GltfContainer& parts, GltfFile& file) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const GltfSource& source = sources[i];
        tinygltf::Buffer& buffer = file.model.buffers[i];
        const std::string name = gltf_name("buffer", buffer.name, i);
        buffer.uri = is_data_uri(source.uri) ? "data:" : source.uri;  // the bytes themselves are enough
        buffer.data.clear();
        const bool in_chunk = i == 0 && source.uri.empty() && parts.binary && !source.is_optional;
        if (source.uri.empty() && !in_chunk) continue;  // whoever needs its bytes is told
        const std::string own = in_chunk ? std::string() : bytes_of(source, name, file);
        const std::string_view bytes = in_chunk ? *parts.binary : std::string_view(own);
        if (bytes.size() < source.length)
            file.fail(name + " has " + to_string(bytes.size()) + " bytes instead of " + to_string(source.length));
        buffer.data.assign(bytes.begin(), bytes.begin() + std::ptrdiff_t(source.length));
    }
}

/// Where each mesh has as many primitives as in the file: tinygltf leaves out those that are none.
void give_back_indices(const std::vector<std::vector<int>>& indices, GltfFile& file) {
    for (std::size_t i = 0; i < indices.size(); ++i) {
        std::vector<tinygltf::Primitive>& primitives = file.model.meshes[i].primitives;
        for (std::size_t k = 0; k < primitives.size() && primitives.size() == indices[i].size(); ++k)
            if (indices[i][k] >= 0) primitives[k].indices = indices[i][k];
    }
}

/// Encoded still: only images that a used material calls for are decoded.
void name_images(const std::vector<GltfSource>& sources, GltfFile& file) {
    for (std::size_t i = 0; i < sources.size(); ++i) {
        file.model.images[i].uri = sources[i].uri;
        file.model.images[i].bufferView = sources[i].view;
    }
}

void check_version(const GltfFile& file) {
    const tinygltf::Asset& asset = file.model.asset;
    if (asset.version.rfind("2.", 0) != 0 || (!asset.minVersion.empty() && asset.minVersion != "2.0"))
        file.fail("glTF of version " + in_one_line(asset.minVersion.empty() ? asset.version : asset.minVersion),
                  "export it as glTF 2.0");
}

void check_extensions(const GltfFile& file, Warnings& warnings) {
    for (const std::string& name : file.model.extensionsRequired)
        if (!is_known(name))
            file.fail("it requires the extension '" + in_one_line(name) + "', which " +
                          (is_compression(name) ? "this build of claray cannot decode" : "claray does not know"),
                      "export it without");
    for (const std::string& name : file.model.extensionsUsed)
        if (!is_known(name))
            warnings.push_back("the extension '" + in_one_line(name) + "' is not supported: it is ignored");
}

}  // namespace

void GltfFile::fail(const std::string& what, const std::string& remedy) const {
    throw Error(ErrorKind::user, "'" + path.string() + "': " + what, remedy);
}

std::size_t GltfFile::change(const std::vector<GltfChange>& changes) {
    if (changes.empty()) return 0;
    const std::size_t left_out = write_changes(json, changes);
    Warnings known;  // from the first reading
    tinygltf::Model changed = parsed_model(*this, known);
    model.nodes = std::move(changed.nodes), model.materials = std::move(changed.materials);
    model.cameras = std::move(changed.cameras), model.lights = std::move(changed.lights);
    model.extensions = std::move(changed.extensions);
    return left_out;
}

std::string_view GltfFile::view(int index, const std::string& what) const {
    if (index < 0 || std::size_t(index) >= model.bufferViews.size())
        fail(what + " refers to buffer view " + to_string(index) + " of " + to_string(model.bufferViews.size()));
    const tinygltf::BufferView& view = model.bufferViews[std::size_t(index)];
    if (view.buffer < 0 || std::size_t(view.buffer) >= model.buffers.size())
        fail("buffer view " + to_string(index) + " refers to buffer " + to_string(view.buffer) + " of " +
             to_string(model.buffers.size()));
    const std::vector<unsigned char>& data = model.buffers[std::size_t(view.buffer)].data;
    if (data.empty() && model.buffers[std::size_t(view.buffer)].uri.empty() && view.byteLength > 0)
        fail("buffer " + to_string(view.buffer) + " has neither a URI nor a binary chunk");
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        fail("buffer view " + to_string(index) + " leaves its buffer of " + to_string(data.size()) + " bytes");
    return {reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength};
}

GltfFile read_gltf(const fs::path& path, Warnings& warnings) {
    return read_gltf(path, read_file(path, "check the path"), warnings);
}

GltfFile read_gltf(const fs::path& path, std::string_view bytes, Warnings& warnings) {
    GltfFile file;
    file.path = path;
    if (bytes.empty()) file.fail("the file is empty");
    refuse_other_encodings(bytes, path);
    const GltfContainer parts = open_container(bytes, file);
    AdaptedJson adapted = adapted_to_tinygltf(parts.json, file);
    if (adapted.text.size() > std::numeric_limits<std::uint32_t>::max())
        file.fail("its JSON is larger than 4 GiB", "keep its buffers in files of their own");
    file.json = std::move(adapted.text);
    file.model = parsed_model(file, warnings);
    check_version(file);
    check_extensions(file, warnings);
    read_buffers(adapted.buffers, parts, file);
    name_images(adapted.images, file);
    give_back_indices(adapted.indices, file);
    file.pointers = std::move(adapted.pointers), file.channels_left_out = adapted.channels_left_out;
    decompress(file);
    return file;
}

std::string gltf_name(const char* kind, const std::string& name, std::size_t index) {
    return std::string(kind) + " " + (name.empty() ? to_string(index) : "'" + in_one_line(name) + "'");
}

}  // namespace claray
