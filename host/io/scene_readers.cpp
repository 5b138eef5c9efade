#include "host/io/scene_readers.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <span>

#include "host/io/little_endian.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

bool is_gltf(const SceneBeginning& file) { return file.text.starts_with("glTF") || file.text.starts_with('{'); }

bool is_ply(const SceneBeginning& file) { return file.text.starts_with("ply\n") || file.text.starts_with("ply\r"); }

/// A binary STL has no mark but its size: 84 bytes, and 50 for each triangle.
bool is_stl(const SceneBeginning& file) {
    if (file.text.starts_with("solid")) return true;
    if (file.bytes.size() < 84) return false;
    return file.size == 84 + 50 * little_endian(file.bytes, 80, 4);
}

/// Whether the first word, behind empty lines and comments, is one of the statements.
bool begins_with_one_of(std::span<const std::string_view> statements, std::string_view text) {
    for (std::size_t end = 0; !text.empty(); text.remove_prefix(std::min(end + 1, text.size()))) {
        end = std::min(text.find_first_of("\r\n"), text.size());
        std::string_view line = text.substr(0, end);
        const std::string_view word = next_word(line);
        if (!word.empty()) return std::find(statements.begin(), statements.end(), word) != statements.end();
    }
    return false;
}

/// A statement of an OBJ, before anything that is none.
bool is_obj(const SceneBeginning& file) {
    constexpr std::array<std::string_view, 10> statements = {"v", "vt", "vn",     "f",      "g",
                                                             "o", "s",  "usemtl", "mtllib", "l"};
    return begins_with_one_of(statements, file.text);
}

bool is_mitsuba(const SceneBeginning& file) {
    return file.text.starts_with('<') && file.text.find("<scene") != std::string_view::npos;
}

/// A statement that pbrt's files begin with, behind comments.
bool is_pbrt(const SceneBeginning& file) {
    constexpr std::array<std::string_view, 12> statements = {"Film",    "Camera",      "LookAt",     "Integrator",
                                                             "Sampler", "PixelFilter", "Transform",  "Scale",
                                                             "Option",  "ColorSpace",  "WorldBegin", "AttributeBegin"};
    return begins_with_one_of(statements, file.text);
}

bool is_fbx(const SceneBeginning& file) {
    return file.bytes.starts_with("Kaydara FBX Binary") || file.text.starts_with("; FBX");
}

bool is_collada(const SceneBeginning& file) {
    return file.text.starts_with('<') && file.text.substr(0, 4096).find("<COLLADA") != file.text.npos;
}

/// Its first chunk is all of it.
bool is_3ds(const SceneBeginning& file) {
    return file.bytes.starts_with("MM") && file.bytes.size() >= 6 && little_endian(file.bytes, 2, 4) == file.size;
}

/// OFF, and with letters for what its vertices have besides: COFF, STCNOFF.
bool is_off(const SceneBeginning& file) {
    std::string_view rest = file.text;
    for (const char* letters : {"ST", "C", "N"})
        if (rest.starts_with(letters)) rest.remove_prefix(std::string_view(letters).size());
    return rest.starts_with("OFF") && rest.size() > 3 && std::isspace(static_cast<unsigned char>(rest[3])) != 0;
}

/// A zip archive that begins with the parts of a 3MF, or names its model.
bool is_3mf(const SceneBeginning& file) {
    return file.bytes.starts_with("PK\3\4") && (file.bytes.find("3D/3dmodel.model") != file.bytes.npos ||
                                                file.bytes.find("3D/3DModel.model") != file.bytes.npos);
}

bool is_pcd(const SceneBeginning& file) {
    return file.text.starts_with("# .PCD") || file.text.starts_with("VERSION 0.7") ||
           file.text.starts_with("VERSION .7");
}

constexpr const char* use_a_mesh = "export a mesh, such as a PLY with faces, from the program that made them";

/// Text, an archive of it, or binary ("crate").
bool is_usd(const SceneBeginning& file) {
    return file.bytes.starts_with("PXR-USDC") || file.text.starts_with("#usda ") ||
           (file.bytes.starts_with("PK\3\4") && file.bytes.substr(0, 256).find(".usd") != file.bytes.npos);
}

/// Blender's own mark, or what compresses it, which the extension tells.
bool is_blend(const SceneBeginning& file) { return file.bytes.starts_with("BLENDER"); }

constexpr SceneChoices strokes = {.stroke_radius = true};
constexpr SceneChoices all = {true, true, true, true, true};
constexpr SceneChoices converted = {.animations = true, .cameras = true, .stroke_radius = true};

/// A row of a format that claray-import reads.
constexpr SceneReader assimp_reader(const char* name, const char* extensions,
                                    bool (*recognizes)(const SceneBeginning&) = nullptr) {
    return {name, extensions, converted, recognizes, load_by_assimp_without_light, assimp_animation_seconds};
}

/// Vaguer tests of the content stand behind stricter ones.
constexpr SceneReader readers[] = {
    {"glTF", ".gltf .glb", all, is_gltf, load_gltf_without_light, gltf_animation_seconds},
    {"PLY", ".ply", strokes, is_ply, load_ply_without_light},
    {"STL", ".stl", {}, is_stl, load_stl_without_light},
    assimp_reader("COLLADA", ".dae .zae", is_collada),
    {"Mitsuba", ".xml", {}, is_mitsuba, load_mitsuba_without_light, nullptr, "", true, mitsuba_film},
    {"pbrt", ".pbrt", {}, is_pbrt, load_pbrt_without_light, nullptr, "", true, pbrt_film},
    assimp_reader("FBX", ".fbx", is_fbx),
    assimp_reader("3DS", ".3ds", is_3ds),
    assimp_reader("OFF", ".off", is_off),
    assimp_reader("DirectX", ".x"),
    assimp_reader("LightWave", ".lwo"),
    assimp_reader("AC3D", ".ac"),
    assimp_reader("Blitz3D", ".b3d"),
    assimp_reader("MilkShape 3D", ".ms3d"),
    assimp_reader("Quake", ".md2 .md3 .md5mesh"),
    assimp_reader("X3D", ".x3d"),
    assimp_reader("trueSpace", ".cob"),
    {"3MF", ".3mf", {}, is_3mf, load_3mf_without_light},
    {"PCD", ".pcd", strokes, is_pcd, load_pcd_without_light},
    {.name = "a file of Gaussian splats", .extensions = ".splat .ksplat .spz .sog", .remedy = use_a_mesh},
    {"USD", ".usd .usda .usdc .usdz", converted, is_usd, load_usd_without_light, usd_animation_seconds},
    {"Blender", ".blend", converted, is_blend, load_blend_without_light, blend_animation_seconds},
    {"OBJ", ".obj", strokes, is_obj, load_obj_without_light},
};

/// Calls take(extension) for each.
template <class Take>
void for_each_extension(const SceneReader& reader, Take&& take) {
    std::string_view rest = reader.extensions;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) take(word);
}

bool has_extension(const SceneReader& reader, const std::filesystem::path& path) {
    const std::string extension = lower_case(path.extension().string());
    bool found = false;
    for_each_extension(reader, [&](std::string_view known) { found |= known == extension; });
    return found;
}

/// The beginning of a regular file, empty for anything else.
std::string beginning_of(const std::filesystem::path& path) {
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(path, unreadable)) return {};
    std::string bytes(std::size_t(1) << 16, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), std::streamsize(bytes.size()));
    bytes.resize(std::size_t(file.gcount()));
    return bytes;
}

const SceneReader* reader_by_content(const std::filesystem::path& path) {
    const std::string bytes = beginning_of(path);
    if (bytes.empty()) return nullptr;
    SceneBeginning file{bytes, bytes, std::filesystem::file_size(path)};
    if (file.text.starts_with("\xef\xbb\xbf")) file.text.remove_prefix(3);
    file.text.remove_prefix(std::min(file.text.find_first_not_of(" \t\r\n"), file.text.size()));
    const auto found = std::find_if(std::begin(readers), std::end(readers), [&](const SceneReader& reader) {
        return reader.recognizes && reader.recognizes(file);
    });
    return found == std::end(readers) ? nullptr : &*found;
}

void append(std::string& list, std::string_view word) {
    if (!list.empty()) list += ", ";
    list += word;
}

}  // namespace

std::span<const SceneReader> scene_readers() { return readers; }

const SceneReader* scene_reader_of(const std::filesystem::path& path) {
    const auto found = std::find_if(std::begin(readers), std::end(readers),
                                    [&](const SceneReader& reader) { return has_extension(reader, path); });
    return found == std::end(readers) ? reader_by_content(path) : &*found;
}

std::optional<SceneFilm> film_of(const std::filesystem::path& path) {
    const SceneReader* reader = scene_reader_of(path);
    return reader && reader->film ? reader->film(path) : std::nullopt;
}

std::string scene_format_names() {
    std::string names;
    for (const SceneReader& reader : readers)
        if (reader.load) append(names, reader.name);
    return names;
}

std::string scene_extensions() {
    std::string extensions;
    for (const SceneReader& reader : readers)
        if (reader.load) for_each_extension(reader, [&](std::string_view extension) { append(extensions, extension); });
    return extensions;
}

}  // namespace claray
