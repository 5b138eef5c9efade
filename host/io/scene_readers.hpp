// The formats of scene files: a row each, which is all that the rest of claray knows of them.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "claray/io.hpp"
#include "host/io/world/scene_film.hpp"

namespace claray {

/// The members of LoadOptions that a format knows.
struct SceneChoices {
    bool animations = false;  ///< `time` and `animation`
    bool variants = false;
    bool cameras = false;
    bool scenes = false;
    bool stroke_radius = false;  ///< it has points or lines
};

/// The begin of a file, by which a reader knows its format.
struct SceneBeginning {
    std::string_view bytes;   ///< the first 64 KiB
    std::string_view text;    ///< the same, without a byte order mark and blanks before it
    std::uintmax_t size = 0;  ///< of the whole file
};

struct SceneReader {
    const char* name;        ///< "glTF", as messages write it
    const char* extensions;  ///< ".gltf .glb", in lower case; the first row with an extension reads it
    SceneChoices choices = {};
    /// Whether it is such a file. It decides for files without a known extension. Null: the extension alone decides.
    bool (*recognizes)(const SceneBeginning&) = nullptr;
    /// Adds no light, and no camera but the file's. Null: claray knows the format only to refuse it by its name.
    Scene (*load)(const std::filesystem::path&, Warnings&, const LoadOptions&) = nullptr;
    /// Of formats with animations: as claray::animation_seconds.
    std::optional<double> (*animation_seconds)(const std::filesystem::path&, const LoadOptions&) = nullptr;
    const char* remedy = "";    ///< without `load`: how to convert it
    bool states_light = false;  ///< its files state all of their light: claray adds none where there is any
    /// Of formats whose files state a picture.
    std::optional<SceneFilm> (*film)(const std::filesystem::path&) = nullptr;
};

/// All rows. The first that recognizes a file reads it.
[[nodiscard]] std::span<const SceneReader> scene_readers();
/// The reader of a file: by its extension, otherwise by its content. Null: no row is for it.
[[nodiscard]] const SceneReader* scene_reader_of(const std::filesystem::path& path);

/// Returns the film that a file states; nothing for files and formats that state none. Throws as the file's reader.
[[nodiscard]] std::optional<SceneFilm> film_of(const std::filesystem::path& path);

/// The names of the formats that are read, and their extensions: "OBJ, PLY", ".obj, .ply".
[[nodiscard]] std::string scene_format_names();
[[nodiscard]] std::string scene_extensions();

[[nodiscard]] Scene load_obj_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
[[nodiscard]] Scene load_ply_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
[[nodiscard]] Scene load_stl_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
[[nodiscard]] Scene load_gltf_without_light(const std::filesystem::path& path, Warnings& warnings,
                                            const LoadOptions& options);
[[nodiscard]] Scene load_mitsuba_without_light(const std::filesystem::path& path, Warnings& warnings,
                                               const LoadOptions& options);
[[nodiscard]] Scene load_pbrt_without_light(const std::filesystem::path& path, Warnings& warnings,
                                            const LoadOptions& options);
[[nodiscard]] std::optional<SceneFilm> pbrt_film(const std::filesystem::path& path);
[[nodiscard]] std::optional<SceneFilm> mitsuba_film(const std::filesystem::path& path);
[[nodiscard]] Scene load_usd_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
[[nodiscard]] Scene load_blend_without_light(const std::filesystem::path& path, Warnings& warnings,
                                             const LoadOptions& options);
[[nodiscard]] std::optional<double> blend_animation_seconds(const std::filesystem::path& path,
                                                            const LoadOptions& options);
[[nodiscard]] std::optional<double> usd_animation_seconds(const std::filesystem::path& path,
                                                          const LoadOptions& options);
[[nodiscard]] std::optional<double> gltf_animation_seconds(const std::filesystem::path& path,
                                                           const LoadOptions& options);
[[nodiscard]] Scene load_pcd_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
[[nodiscard]] Scene load_3mf_without_light(const std::filesystem::path& path, Warnings& warnings,
                                           const LoadOptions& options);
/// What other programs turn into the bytes of a glTF. Messages name `path`, and images are in its folder.
[[nodiscard]] Scene load_gltf_bytes(const std::filesystem::path& path, std::string_view bytes, Warnings& warnings,
                                    const LoadOptions& options);
[[nodiscard]] std::optional<double> gltf_animation_seconds(const std::filesystem::path& path, std::string_view bytes,
                                                           const LoadOptions& options);
/// FBX, COLLADA and others, by the program claray-import.
[[nodiscard]] Scene load_by_assimp_without_light(const std::filesystem::path& path, Warnings& warnings,
                                                 const LoadOptions& options);
[[nodiscard]] std::optional<double> assimp_animation_seconds(const std::filesystem::path& path,
                                                             const LoadOptions& options);

}  // namespace claray
