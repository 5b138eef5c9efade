#include "host/io/gltf/gltf_file.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/gltf/decode/gltf_compression.hpp"
#include "host/io/scene_textures.hpp"
#include "host/io/text_file.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using std::to_string;

constexpr std::string_view known_extensions[] = {
    "EXT_mesh_gpu_instancing",
    "KHR_materials_variants",
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
    "KHR_materials_volume",
    "KHR_mesh_quantization",  // integer attributes are read wherever they stand
    "KHR_texture_transform",
    // Other containers of images: where a texture has no plain one, its material says so.
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "MSFT_texture_dds",
};

bool is_known(const std::string& extension) {
    return can_decode(extension) ||
           std::find(std::begin(known_extensions), std::end(known_extensions), extension) != std::end(known_extensions);
}

std::uint32_t from_little_endian(std::string_view bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | std::uint8_t(bytes[i]);
    return value;
}

/// The JSON of a binary glTF, whose lengths are checked: tinygltf 2.7 reads up to 8 bytes behind a chunk that is cut
/// off. `bytes` loses what comes behind the file's own length.
std::string_view check_container(std::string_view& bytes, const GltfFile& file) {
    constexpr std::size_t header = 12, chunk_header = 8;
    if (bytes.size() < header + chunk_header) file.fail("the file is cut off");
    if (from_little_endian(bytes.substr(4)) != 2)
        file.fail("binary glTF of version " + to_string(from_little_endian(bytes.substr(4))), "export it as glTF 2.0");
    const std::size_t length = from_little_endian(bytes.substr(8));
    if (length > bytes.size())
        file.fail("the file is cut off: " + to_string(bytes.size()) + " of " + to_string(length) + " bytes");
    bytes = bytes.substr(0, length);
    std::string_view json;
    for (std::size_t begin = header, chunk = 0; begin < length; ++chunk) {
        if (length - begin < chunk_header) file.fail("its chunk " + to_string(chunk) + " is cut off");
        const std::size_t size = from_little_endian(bytes.substr(begin));
        if (size > length - begin - chunk_header) file.fail("its chunk " + to_string(chunk) + " is cut off");
        if (chunk == 0) json = bytes.substr(begin + chunk_header, size);
        begin += chunk_header + size;
    }
    return json;
}

/// tinygltf walks through nested values by recursion: too deep, and the stack ends.
void check_depth(std::string_view json, const GltfFile& file) {
    constexpr int deepest = 256;
    bool in_string = false;
    int depth = 0;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_string && c == '\\')
            ++i;
        else if (c == '"')
            in_string = !in_string;
        else if (!in_string && (c == '{' || c == '['))
            ++depth;
        else if (!in_string && (c == '}' || c == ']'))
            --depth;
        if (depth > deepest) file.fail("its JSON is nested deeper than " + to_string(deepest));
    }
}

/// What tinygltf asks of the file system. It reads buffers before it knows any buffer view, and images after: these are
/// said not to exist, so that only those are read, later, which a used material calls for.
struct Folder {
    const GltfFile* file;

    static bool exists(const std::string&, void* user) {
        return static_cast<const Folder*>(user)->file->model.bufferViews.empty();
    }
    static std::string expand(const std::string& name, void*) { return name; }
    static bool read(std::vector<unsigned char>* out, std::string*, const std::string& name, void* user) {
        const fs::path &gltf = static_cast<const Folder*>(user)->file->path, folder = gltf.parent_path();
        const std::string bytes =
            read_file(path_in_scene(folder, folder, name, gltf), "put the buffer next to the glTF");
        out->assign(bytes.begin(), bytes.end());
        return true;
    }
};

/// Keeps an image of a data URI as it is, encoded.
bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                  int size, void*) {
    if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
    return true;
}

/// One line of at most 200 characters: tinygltf quotes data URIs in full.
std::string one_line(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ' || text.back() == '.')) text.pop_back();
    for (char& c : text)
        if (c == '\n' || c == '\r') c = ' ';
    return text.size() > 200 ? text.substr(0, 200) + "..." : text;
}

/// Where JSON ends to be JSON, and by what: "line 1, column 30: unexpected ','". The JSON library says it as
/// "[json.exception.parse_error.101] parse error at PLACE: syntax error while parsing WHAT - REASON; HINT".
std::optional<std::string> json_error(const std::string& errors) {
    static constexpr std::string_view before = "parse error at ", between = " - ";
    const std::size_t place = errors.find(before), colon = errors.find(": ", place),
                      reason = errors.find(between, colon);
    if (place == std::string::npos || reason == std::string::npos) return {};
    const std::size_t begin = place + before.size(), words = reason + between.size();
    return "its JSON is broken at " + errors.substr(begin, colon - begin) + ": " +
           one_line(errors.substr(words, errors.find(';', words) - words));
}

void parse(std::string_view bytes, bool binary, GltfFile& file, Warnings& warnings) {
    Folder folder{&file};
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(keep_encoded, nullptr);
    tinygltf::FsCallbacks callbacks{};
    callbacks.FileExists = Folder::exists;
    callbacks.ExpandFilePath = Folder::expand;
    callbacks.ReadWholeFile = Folder::read;
    callbacks.user_data = &folder;
    parser.SetFsCallbacks(callbacks);
    std::string errors, remarks;  // remarks are about images only
    bool ok = false;
    try {
        const auto size = unsigned(bytes.size());
        ok = binary ? parser.LoadBinaryFromMemory(&file.model, &errors, &remarks,
                                                  reinterpret_cast<const unsigned char*>(bytes.data()), size)
                    : parser.LoadASCIIFromString(&file.model, &errors, &remarks, bytes.data(), size, "");
    } catch (const Error&) {
        throw;  // from a callback
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        errors = error.what();
    }
    if (!ok) file.fail(json_error(errors).value_or("not a valid glTF: " + one_line(errors)));
    if (!errors.empty()) warnings.push_back(one_line(errors));  // what it could go on without
}

void check_version(const GltfFile& file) {
    const tinygltf::Asset& asset = file.model.asset;
    if (asset.version.rfind("2.", 0) != 0 || (!asset.minVersion.empty() && asset.minVersion != "2.0"))
        file.fail("glTF of version " + one_line(asset.minVersion.empty() ? asset.version : asset.minVersion),
                  "export it as glTF 2.0");
}

void check_extensions(const GltfFile& file, Warnings& warnings) {
    for (const std::string& name : file.model.extensionsRequired)
        if (!is_known(name))
            file.fail("it requires the extension '" + one_line(name) + "', which " +
                          (is_compression(name) ? "this build of claray cannot decode" : "claray does not know"),
                      "export it without");
    for (const std::string& name : file.model.extensionsUsed)
        if (!is_known(name))
            warnings.push_back("the extension '" + one_line(name) + "' is not supported: it is ignored");
}

}  // namespace

void GltfFile::fail(const std::string& what, const std::string& remedy) const {
    throw Error(ErrorKind::user, "'" + path.string() + "': " + what, remedy);
}

std::string_view GltfFile::view(int index, const std::string& what) const {
    if (index < 0 || std::size_t(index) >= model.bufferViews.size())
        fail(what + " refers to buffer view " + to_string(index) + " of " + to_string(model.bufferViews.size()));
    const tinygltf::BufferView& view = model.bufferViews[std::size_t(index)];
    if (view.buffer < 0 || std::size_t(view.buffer) >= model.buffers.size())
        fail("buffer view " + to_string(index) + " refers to buffer " + to_string(view.buffer) + " of " +
             to_string(model.buffers.size()));
    const std::vector<unsigned char>& data = model.buffers[std::size_t(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        fail("buffer view " + to_string(index) + " leaves its buffer of " + to_string(data.size()) + " bytes");
    return {reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength};
}

GltfFile read_gltf(const fs::path& path, Warnings& warnings) {
    GltfFile file;
    file.path = path;
    const std::string whole = read_file(path, "check the path");
    std::string_view bytes = whole;
    if (bytes.empty()) file.fail("the file is empty");
    refuse_other_encodings(bytes, path);
    if (bytes.size() > std::numeric_limits<std::uint32_t>::max())
        file.fail("the file is larger than 4 GiB", "keep its buffers in files of their own");
    const bool binary = bytes.substr(0, 4) == "glTF";
    check_depth(binary ? check_container(bytes, file) : bytes, file);
    const std::optional<std::string> adapted = adapted_to_tinygltf(bytes, binary);
    parse(adapted ? std::string_view(*adapted) : bytes, binary, file, warnings);
    check_version(file);
    check_extensions(file, warnings);
    decompress(file);
    return file;
}

std::string gltf_name(const char* kind, const std::string& name, std::size_t index) {
    return std::string(kind) + " " + (name.empty() ? to_string(index) : "'" + one_line(name) + "'");
}

}  // namespace claray
