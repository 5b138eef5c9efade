// The command line of `claray render`, parsed and checked.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "host/cli/options/view_options.hpp"

namespace claray::cli {

/// The frames of an animation, one image each.
struct FrameRange {
    unsigned first = 0, last = 0;
};

/// How colours are stored beside an alpha.
enum class AlphaStorage { by_format, straight, premultiplied };

struct RenderOptions {
    std::string scene;
    std::filesystem::path output;  // "-": standard output
    std::string format;            // of image_formats, or "y4m"; empty: by the extension
    ImageEncoding encoding;        // but for its format
    std::string device;
    RenderConfig config;
    bool has_size = false;  // by --size
    ViewOptions view;
    std::optional<float> exposure;  // stops; empty: chosen if the surfaces would be mostly white or black
    bool auto_exposure = false;     // always chosen
    std::optional<double> iso;      // with the time, the exposure
    double shutter_time = 0;        // seconds
    ToneMap tone_map = ToneMap::aces;
    std::optional<AlphaStorage> alpha;
    std::vector<std::string> holdouts, catchers;  // names of materials
    bool full_frame = false;                      // of a region
    std::optional<DenoiserKind> denoiser;
    std::vector<std::string> aovs;
    std::vector<std::string> light_maps;  // "0=floor.pfm"
    std::filesystem::path trace;
    bool stats = false, json = false, quiet = false;
    bool wait_for_kernels = false;
    bool asks_for_guiding = false;                      // by --guide, without which it is wanted, too
    double fps = 0;                                     // 0: one image
    unsigned frames = 300;                              // at that rate
    double orbit = 0;                                   // degrees over these frames
    std::string frames_text;                            // as the command line has it: a number, or a range
    std::optional<FrameRange> animation;                // a picture each
    unsigned turntable = 0;                             // frames of a turn of the camera; 0: none
    double frame_rate = 24;                             // of the animation
    bool picks_settings = false, picks_builder = true;  // by target; the builder only without --builder
};

/// The views of a G-buffer, OUTPUT.NAME.png.
inline constexpr const char* gbuffer_views[] = {"gbuffer-albedo", "gbuffer-material", "gbuffer-normal", "gbuffer-depth",
                                                "gbuffer-position"};

/// --size WIDTHxHEIGHT, each 1 .. 16384.
void add_size_option(CLI::App& command, unsigned& width, unsigned& height, const char* description);

constexpr const char* cheaper_answers =
    "Cheaper answers, which change the image: tile-sum (all lights without extent at the "
    "first surface, without shadows and nothing else, as deferred shading does it); light-grid "
    "(a grid of probes answers what light surfaces receive from each other); flat, gouraud: see "
    "--shading; no-shadows: see --shadows";
/// --approximate NAME,NAME... or nothing
void add_approximate_option(CLI::App& command, Approximations& approximate, const char* description = cheaper_answers);
/// --guide and --no-guide
void add_guide_flag(CLI::App& command, bool& guide);
/// --shading and --shadows: short for values of --approximate. Call after add_approximate_option.
void add_shading_options(CLI::App& command, Approximations& approximate);
/// --grid-voxels, --grid-side, --grid-coefficients, --grid-levels, --grid-gather
void add_light_grid_options(CLI::App& command, LightGridConfig& grid);

/// "0..47" -> {0, 47}. Throws ErrorKind::usage for other text and for more than a million frames.
[[nodiscard]] FrameRange parse_frames(const std::string& text);

/// The file of a frame: the number replaces %d or %04d in the name, or precedes the extension, as in out.0007.png.
/// Throws ErrorKind::usage for any other % in the name.
[[nodiscard]] std::filesystem::path numbered(const std::filesystem::path& output, unsigned frame);

/// Whether the frames of an animation become a video without compression: by --format y4m, by the extension, or on
/// standard output without --format.
[[nodiscard]] bool is_y4m(const RenderOptions& options);
/// Whether the frames of an animation go to one stream: a video, or images one behind the other on standard output.
[[nodiscard]] bool is_stream(const RenderOptions& options);
/// How images are encoded. Without --format those on standard output are PNGs; elsewhere the extension decides.
[[nodiscard]] ImageEncoding encoding_of(const RenderOptions& options);
/// The format of the image; nothing for a video and for unknown extensions.
[[nodiscard]] std::optional<ImageFormat> format_of(const RenderOptions& options);

/// Whether an image or a video has colours that exposure and tone map choose: not radiance.
[[nodiscard]] bool is_shaped(const RenderOptions& options);

/// Puts light maps on meshes. Throws ErrorKind::usage for text that is not MESH=FILE.
void use_light_maps(Scene& scene, const std::vector<std::string>& light_maps);

/// The Cryptomatte with this name; null: it is another AOV.
[[nodiscard]] const MatteRow* matte_named(const std::string& aov);

/// Whether an AOV becomes a layer of the image's own file: all but gbuffer and voxels, of an .exr.
[[nodiscard]] bool is_layer(const RenderOptions& options, const std::string& aov);

/// out.png, depth -> {out.depth.png, out.depth.pfm}
[[nodiscard]] std::pair<std::filesystem::path, std::filesystem::path> aov_paths(const std::filesystem::path& output,
                                                                                const std::string& name);
/// Called before rendering: throws the errors that writing the output files would throw.
void check_outputs(const RenderOptions& options);

}  // namespace claray::cli
