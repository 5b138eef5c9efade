// File input and output: meshes, images, JSON. Part of claray_io; does not use OpenCL.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "claray/image/cryptomatte.hpp"
#include "claray/image/image_format.hpp"
#include "claray/image/picture.hpp"
#include "claray/profiler.hpp"
#include "claray/scene.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Problems that loaders found and corrected, as lines for the user. Each is fit for a terminal, as `Error::what()` is.
/// At most 20 warnings of a kind are kept, and one additional line counts the rest. Warnings are of the same kind if
/// they differ only in numbers and in quoted text.
class Warnings {
public:
    using value_type = std::string;
    using iterator = std::vector<std::string>::iterator;
    using const_iterator = std::vector<std::string>::const_iterator;

    Warnings() = default;
    Warnings(std::initializer_list<std::string> warnings) {
        for (const std::string& warning : warnings) push_back(warning);
    }

    void push_back(const std::string& warning);
    void emplace_back(const std::string& warning) { push_back(warning); }
    iterator erase(const_iterator position) { return lines_.erase(position); }
    void clear() { *this = {}; }

    [[nodiscard]] bool empty() const { return lines_.empty(); }
    [[nodiscard]] std::size_t size() const { return lines_.size(); }
    [[nodiscard]] const std::string& operator[](std::size_t i) const { return lines_[i]; }
    [[nodiscard]] const std::string& at(std::size_t i) const { return lines_.at(i); }
    [[nodiscard]] const std::string& front() const { return lines_.front(); }
    [[nodiscard]] const std::string& back() const { return lines_.back(); }
    [[nodiscard]] iterator begin() { return lines_.begin(); }
    [[nodiscard]] iterator end() { return lines_.end(); }
    [[nodiscard]] const_iterator begin() const { return lines_.begin(); }
    [[nodiscard]] const_iterator end() const { return lines_.end(); }

private:
    struct Kind {
        std::size_t count = 0;
        std::string rest;  ///< the line that counts the warnings that are not kept
    };

    std::vector<std::string> lines_;
    std::map<std::string, Kind> kinds_;
};

/// Selects one variant of a file that holds several; docs/formats.md says which formats do. A choice is a name or,
/// if no name matches, an index that counts from 0. The comments tell the default for an empty choice.
struct LoadOptions {
    std::optional<double> time = {};          ///< seconds from the begin of an animation; empty: do not animate
    std::string animation = {};               ///< default: the first; "all": all of them at once
    std::string variant = {};                 ///< a variant of KHR_materials_variants; default: the default materials
    std::string camera = {};                  ///< a camera, or a node that has one; default: the first in the scene
    std::string scene = {};                   ///< default: the file's default scene, else its first
    std::optional<float> stroke_radius = {};  ///< of points and lines; 0: leave them out; default: by the scene's size
    bool images = true;                       ///< false: a white texel stands for each, if only a pose is needed
    /// For a live view of a glTF. Instances with the names of nodes place all meshes, and the camera's target is in the
    /// middle of the scene instead of one unit before the camera.
    bool live = false;
};

/// Loads a Wavefront OBJ with its MTL and the images of used materials. Polygons are triangulated, negative indices are
/// resolved, and the faces of one group or object form one mesh. Lines and points become tubes and spheres.
/// docs/formats.md tells the meaning of each MTL key. A missing MTL or image causes a warning, and its materials are
/// grey (docs/formats.md). Throws ErrorKind::user, naming the file (and the line, if known), for a missing or empty
/// file, an index out of range, and a file without faces and points. It also throws for an image that is damaged or too
/// large.
[[nodiscard]] Scene load_obj(const std::filesystem::path& path, Warnings& warnings);

/// Loads a PLY, text or binary, as one grey mesh: the elements vertex (positions, normals, texture coordinates,
/// colours), face (colours and coordinates of its own) and tristrips. MeshLab's comments name its images. Without
/// faces, edges and vertices are tubes and spheres. Throws ErrorKind::user, naming the file and the line or the row,
/// for a missing or damaged file, an index out of range, and a file without faces and points.
[[nodiscard]] Scene load_ply(const std::filesystem::path& path, Warnings& warnings);

/// Loads an STL, text or binary, as a grey mesh for each solid. Vertices at the same position become one; normals are
/// ignored, because triangles are flat. Throws ErrorKind::user, naming the file and the line, for a missing or damaged
/// file, and a file without triangles.
[[nodiscard]] Scene load_stl(const std::filesystem::path& path, Warnings& warnings);

/// Loads glTF 2.0, as text (.gltf) or binary (.glb): triangles, points and lines (as spheres and tubes). The node
/// hierarchy is read at a time of an animation, with skins, morph targets, a camera and punctual lights. Materials are
/// metallic-roughness with the extensions in docs/formats.md; images of used materials are loaded. If no mesh is used
/// by several nodes, meshes are stored in world space; otherwise Scene::instances places them. Unsupported content is
/// left out with a warning; a missing image is grey, with a warning. Throws ErrorKind::usage, listing the names in the
/// file, for an unknown choice. Throws ErrorKind::user, naming the file and the object, for invalid content and an
/// unknown required extension. It also throws for a buffer that is missing or outside the file's folder, and for an
/// image that is damaged or too large.
[[nodiscard]] Scene load_gltf(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options = {});

/// Returns the duration of the glTF animation that `options` choose, in seconds: the time of the last key, or 0 if the
/// file does not state it. Returns nothing for other names and files without an animation. Throws as load_gltf.
[[nodiscard]] std::optional<double> animation_seconds(const std::string& name_or_path, const LoadOptions& options = {});

/// Loads a built-in scene by name, or else a file of one of the formats in docs/formats.md: by its extension, or by its
/// content if the extension is unknown. Throws ErrorKind::usage for options that the format does not support.
[[nodiscard]] Scene load_scene(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options = {});

/// The sides of surfaces that rays hit.
enum class Culling {
    by_file,  ///< as the materials say: glTF culls backs that are not double-sided, OBJ culls none
    back,     ///< cull the backs of all materials except solid glass, since light leaves it through a back
    none      ///< cull nothing
};
/// Sets Material::cull_back of all materials. Culling::by_file changes nothing.
void set_culling(Scene& scene, Culling culling);
/// Exchanges the front and the back of all triangles. In the supported formats, the vertices of a front appear
/// counter-clockwise. Use this for files with the opposite order, if backs are culled, and for glass, emissive surfaces
/// and relief.
void flip_fronts(Scene& scene);

/// Reads PNG, JPEG, WebP (8 bits, no animation), BMP, TGA, Radiance HDR, PFM or OpenEXR; the content decides the
/// format. `eight_bit` is the meaning of bytes: srgb8 or linear8. Images of 16 bits become linear float32; HDR, PFM and
/// EXR are linear float32, and colours of other primaries become those of Rec. 709. Of an EXR with layers the colours
/// without a prefix are read, else those of the first layer that has some. What its display window shows is the image.
/// Limits: 16384 pixels per side and 1 GiB decoded. Throws ErrorKind::user, naming the file, if the file is missing,
/// damaged, truncated or too large.
[[nodiscard]] Texture load_image(const std::filesystem::path& path, TexelFormat eight_bit = TexelFormat::srgb8);

/// Returns the normals of a height field, as Material::normal_map reads them: 8 bits, +y up in the image. Slopes are
/// central differences over one texel to each side, as Material::height_map has them; `strength` is the height of 1 in
/// texels. The image's first channel and its wrap modes are used.
[[nodiscard]] Texture normal_map_of(const Texture& heights, float strength = 1.f);

/// Writes the texels without conversion: .png for textures of bytes, .pfm for float32 with 1 or 3 channels. Throws like
/// write_image.
void write_texture(const std::filesystem::path& path, const Texture& texture);

/// Loads an image in latitude and longitude, an OpenEXR cube map (its attribute `envmap` tells), or a folder with the
/// faces of a cube. The files of the faces are named px nx py ny pz nz, with any extension that load_image reads.
/// Negative values count as 0 and infinite ones as the largest other, with a warning. Throws ErrorKind::user, naming
/// the file.
[[nodiscard]] Environment load_environment(const std::filesystem::path& path, Warnings& warnings);
[[nodiscard]] Environment load_environment(const std::filesystem::path& path);

/// An image of linear colours, row by row from the top left.
struct Image {
    unsigned width = 0, height = 0;
    std::vector<glm::vec3> pixels = {};
};

/// Channels of an EXR: float32 in `values`, or whole numbers in `numbers`, pixel by pixel from the top left.
struct ImageLayer {
    std::string name = {};                    ///< "depth"; empty: the image itself, whose channels have no prefix
    std::string channels = "RGB";             ///< a letter each: "RGB", "XYZ", "Z"
    std::vector<float> values = {};           ///< width * height * channels
    std::vector<std::uint32_t> numbers = {};  ///< or these
};
/// Names and texts of an EXR's header.
using ImageAttributes = std::vector<std::pair<std::string, std::string>>;
/// Writes one EXR with all layers; the channels are called NAME.LETTER, as compositors show them. Throws as
/// write_image, and ErrorKind::usage if claray was built without OpenEXR.
void write_exr(const std::filesystem::path& path, unsigned width, unsigned height,
               const std::vector<ImageLayer>& layers, const ImageAttributes& attributes = {});
/// Returns a Cryptomatte's layers: a picture of it, NAME, and two ranks each in NAME00, NAME01, ...
[[nodiscard]] std::vector<ImageLayer> layers_of(const Cryptomatte& matte);
/// Returns what the header must say of it.
[[nodiscard]] ImageAttributes attributes_of(const Cryptomatte& matte);

/// Writes an image by extension, or in the encoding's format: .png, .jpg and .webp (exposed by stops, tone mapped,
/// sRGB), .hdr (Radiance RGBE), .pfm or .exr (float32). The last three are linear and ignore exposure and tone map. The
/// data is written to a temporary file, synced and renamed, so that no partial image remains. Throws ErrorKind::usage
/// for another extension, for a WebP of more than 16383 pixels a side, and for settings that the format does not have.
/// Throws ErrorKind::user if the file cannot be written.
void write_image(const std::filesystem::path& path, const Image& image, float exposure = 0.f,
                 ToneMap tone_map = ToneMap::aces, const ImageEncoding& encoding = {});

/// Throws the errors that write_image would throw for this path. Call it before rendering.
void check_writable(const std::filesystem::path& path, const ImageEncoding& encoding = {});

/// Returns the format of a file by its extension, in upper or lower case; nothing for another extension.
[[nodiscard]] std::optional<ImageFormat> image_format_of(const std::filesystem::path& path);

/// Maps one value per pixel to false colours that are perceptually uniform (Turbo), from the least to the largest
/// finite value; other values are black. The result is linear: write it with ToneMap::none to see the original colours
/// of Turbo.
[[nodiscard]] Image false_color(unsigned width, unsigned height, const std::vector<float>& values);
/// Writes one value per pixel as .pfm with a single channel. Throws like write_image.
void write_pfm(const std::filesystem::path& path, unsigned width, unsigned height, const std::vector<float>& values);
/// Maps each identifier to a colour; consecutive identifiers get very different hues. CLARAY_MISS is black.
[[nodiscard]] Image identifier_color(unsigned width, unsigned height, const std::vector<std::uint32_t>& identifiers);

/// Writes a trace for Perfetto and chrome://tracing (Trace Event Format, JSON). Throws like write_file.
void write_trace(const std::filesystem::path& path, const std::vector<ProfileRecord>& records,
                 const std::string& device_name);

/// Writes text or bytes to `path` by temporary file, fsync and rename. Throws ErrorKind::user, naming the file, on
/// failure.
void write_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace claray
#pragma GCC visibility pop
