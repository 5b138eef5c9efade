// Files in, files out: meshes, images, JSON. Part of claray_io; knows no device.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "claray/profiler.hpp"
#include "claray/scene.hpp"
#include "claray/warnings.hpp"

namespace claray {

/// What to load of a file that holds more than one picture; of the formats that are read, glTF does. A choice is a name
/// or, where nothing has that name, an index that counts from 0. Empty: what the member says.
struct LoadOptions {
    std::optional<double> time = {};          ///< seconds from an animation's begin; empty: nothing is animated
    std::string animation = {};               ///< the first; "all": all of them at once
    std::string variant = {};                 ///< of KHR_materials_variants; the default materials
    std::string camera = {};                  ///< a camera, or a node that has one; the first in the scene
    std::string scene = {};                   ///< the file's default, else its first
    std::optional<float> stroke_radius = {};  ///< of points and lines; 0 leaves them out; by the scene's size
};

/// Loads a Wavefront OBJ with its MTL and the images that used materials name. Polygons become triangles, negative
/// indices are resolved, faces of one group or object are one mesh. docs/formats.md says what each MTL key becomes. A
/// missing MTL is a warning and gives grey Lambert. Throws ErrorKind::user naming the file (and line, where known) for
/// a missing or empty file, an index out of range, no face at all, and an image that is missing, broken, too large or
/// outside the OBJ's folder.
[[nodiscard]] Scene load_obj(const std::filesystem::path& path, Warnings& warnings);

/// Loads glTF 2.0, as text (.gltf) or binary (.glb): triangles, points and lines (as
/// spheres and tubes), the node hierarchy at a time of an animation, skins and
/// morph targets, a camera, punctual lights, metallic-roughness materials with the extensions in docs/formats.md, and
/// the images that used materials name. Meshes that no node uses twice are placed in the world; otherwise
/// Scene::instances places them. What is left out is warned of. Throws ErrorKind::usage, with the names that the file
/// has, for a choice that is none of them; ErrorKind::user naming the file and the object for whatever the format
/// forbids, an extension that is required and unknown, and an image or buffer that is missing, broken, too large or
/// outside the file's folder.
[[nodiscard]] Scene load_gltf(const std::filesystem::path& path, Warnings& warnings, const LoadOptions& options = {});

/// A built-in scene by name, or else a file by its extension (.obj, .gltf, .glb). Throws ErrorKind::usage for options
/// that the format has no choice for.
[[nodiscard]] Scene load_scene(const std::string& name_or_path, Warnings& warnings, const LoadOptions& options = {});

/// Which sides of surfaces are there.
enum class Culling {
    by_file,  ///< as the materials say: glTF culls the backs of what is not double-sided, OBJ none
    back,     ///< fronts alone, of all materials but solid glass, which light leaves by a back
    none      ///< both, of all materials
};
void set_culling(Scene& scene, Culling culling);
/// Exchanges the front and the back of all triangles. The formats read say that a front's vertices appear
/// counter-clockwise; files that say otherwise need this where backs are culled, and for glass, lamps and relief.
void flip_fronts(Scene& scene);

/// Reads PNG, JPEG, WebP (8 bits, no animation), BMP, TGA, Radiance HDR or PFM, told by content. `eight_bit` says what
/// bytes mean: srgb8 or linear8; images of 16 bits become linear float32, HDR and PFM are float32 as they are. At most
/// 16384 pixels a side and 1 GiB decoded. Throws ErrorKind::user naming the file where it is missing, broken, cut off
/// or too large.
[[nodiscard]] Texture load_image(const std::filesystem::path& path, TexelFormat eight_bit = TexelFormat::srgb8);

/// Writes the texels as they are: .png for textures of bytes, .pfm for float32 of 1 or 3 channels. Throws like
/// write_image.
void write_texture(const std::filesystem::path& path, const Texture& texture);

/// An image in latitude and longitude; or a folder with the faces of a cube, px nx py ny pz nz with any extension that
/// load_image reads.
[[nodiscard]] Environment load_environment(const std::filesystem::path& path);

/// Linear colour, row by row from the top left.
struct Image {
    unsigned width = 0, height = 0;
    std::vector<glm::vec3> pixels;
};

enum class ToneMap {
    none,  ///< clamp to 0..1
    aces   ///< filmic curve (Narkowicz 2015 fit to ACES)
};

/// The exact piecewise sRGB curve (IEC 61966-2-1) of a linear value, clamped to 0..1, as an 8-bit value.
[[nodiscard]] std::uint8_t srgb_from_linear(float linear);
[[nodiscard]] float linear_from_srgb(std::uint8_t value);

/// By extension: .png (tone mapped, sRGB, 8 bits), .hdr (Radiance RGBE) or .pfm (float32), the latter two linear and
/// untouched by exposure (in stops) and tone map. Written to a temporary file, synced, renamed: there is never half
/// an image. Throws ErrorKind::usage for another extension, ErrorKind::user where the file can't be written.
void write_image(const std::filesystem::path& path, const Image& image, float exposure = 0.f,
                 ToneMap tone_map = ToneMap::aces);

/// Throws what write_image would for this path, before any time is spent on rendering.
void check_writable(const std::filesystem::path& path);

/// One value per pixel in perceptually even false colours (Turbo), least to largest finite value; others are black.
/// Linear like every Image: write it with ToneMap::none to see Turbo's own colours.
[[nodiscard]] Image false_color(unsigned width, unsigned height, const std::vector<float>& values);
/// One value per pixel as .pfm with a single channel.
void write_pfm(const std::filesystem::path& path, unsigned width, unsigned height, const std::vector<float>& values);
/// A colour per identifier, neighbours far apart in hue; CLARAY_MISS is black.
[[nodiscard]] Image identifier_color(unsigned width, unsigned height, const std::vector<std::uint32_t>& identifiers);

/// Writes a trace that Perfetto and chrome://tracing open (Trace Event Format, JSON).
void write_trace(const std::filesystem::path& path, const std::vector<ProfileRecord>& records,
                 const std::string& device_name);

/// Writes text or bytes to `path` by temporary file, fsync and rename.
void write_file(const std::filesystem::path& path, const std::string& bytes);

}  // namespace claray
