// Images: a progressive path tracer.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "claray/bvh.hpp"
#include "claray/effects.hpp"

namespace claray {

/// Where the random numbers come from.
enum class Sampler : std::uint32_t {
    sobol,       ///< Owen-scrambled Sobol points: less noise for the same number of samples
    independent  ///< plain Monte Carlo, to compare with
};

inline constexpr unsigned default_max_depth = 128;

struct RenderConfig {
    unsigned width = 512, height = 512;  ///< 1 to 2^14 each
    unsigned spp = 64;                   ///< samples a pixel at which to stop, >= 1
    /// Surfaces at which a path may be scattered, >= 1; 1 is direct light only. Chance ends nearly all paths earlier
    /// and keeps the mean, so that the default leaves out next to no light: see Renderer::cut_off.
    unsigned max_depth = default_max_depth;
    std::uint32_t seed = 0;
    double seconds = 0;  ///< stop after this time where > 0, but not before every pixel has a sample
    double noise = 0;    ///< stop at this noise (see RenderProgress) where > 0; asked from 16 samples a pixel on
    /// Stop when the image's error (RMSE over the mean, as ImageError::rmse) is at most this where > 0, by an estimate
    /// that holds in 95 of 100 renders; `spp` is the most that may be taken. The image is that of so many samples.
    double error = 0;
    Sampler sampler = Sampler::sobol;
    Bvh::Config bvh = {.builder = Builder::balanced};  ///< what it takes more to build pays within a few samples
    EffectOverrides effects = {};                      ///< for experiments; effects are derived from the scene
    /// The program `claray`, where it shall compile kernels while others already render; empty: rendering begins when
    /// the scene's own kernels are compiled. The image is the same.
    std::string compiler = {};
    /// Where not empty, the file that `render` writes every so many seconds and when it returns: a render that ends by
    /// whatever can go on from there.
    std::filesystem::path checkpoint = {};
    double checkpoint_seconds = 30;
    /// Where not empty, such a file to go on from. It must be of the same scene and of the same width, height, seed,
    /// depth, sampler and choice of effects; `spp` may be larger. On the same device the image is the same bit for bit
    /// as one rendered without a break.
    std::filesystem::path resume = {};
};

/// What a render has done so far.
struct RenderProgress {
    unsigned spp = 0;  ///< samples a pixel done, the mean rounded down
    unsigned spp_target = 0;
    double seconds = 0;  ///< since the first sample was begun
    double noise = 0;    ///< standard error of luminance, root mean square over pixels, over the mean; 0: not yet known
    double error = 0;    ///< estimate of ImageError::rmse, where RenderConfig::error asks for it; 0: not yet known
    double error_bound = 0;    ///< what it is less than, but for few renders: this is compared with RenderConfig::error
    unsigned error_spp = 0;    ///< samples a pixel that there were when the error was asked for, between two passes
    double cut_off = 0;        ///< as Renderer::cut_off, where RenderConfig::error asks for it: both errors contain it
    bool own_kernels = false;  ///< whether the scene's own kernels render by now (see RenderStatistics)
    std::uint64_t dropped_samples = 0;  ///< NaN, infinite or above 1e30, left out of the image
    std::uint32_t culled = 0;           ///< triangles left out: not finite, huge, or without area
};

/// Rays traced and the device time they took.
struct RayCount {
    std::uint64_t rays = 0;
    double milliseconds = 0;
    [[nodiscard]] double mrays_per_second() const { return milliseconds > 0 ? double(rays) * 1e-3 / milliseconds : 0; }
};

/// With which kernels a render began.
enum class KernelStart {
    own,      ///< those compiled for the scene's effects
    generic,  ///< those that know all effects: the cache had them, and not the scene's own
    quick     ///< those that compile fastest: the cache had none
};

struct RenderStatistics {
    double first_pixel_seconds = 0;            ///< from the renderer's set-up to the first batch of samples
    double first_pixel_processor_seconds = 0;  ///< of all threads of the process meanwhile
    KernelStart start = KernelStart::own;
    unsigned own_kernels_from = 0;  ///< samples a pixel that were done when the scene's own kernels took over
    bool own_kernels = false;       ///< whether they have
    double build_milliseconds = 0;  ///< device time of the acceleration structure
    BvhStatistics bvh;
    RayCount camera, bounce, shadow;  ///< times: of tracing alone; 0 where that is not known, as `in_paths`
    /// Rays of these that a kernel traced which does all work of a path, and its time: on GPUs, in scenes that call for
    /// few effects and have short paths.
    RayCount in_paths;
    EffectSet effects;  ///< that the scene calls for, after `RenderConfig::effects`
    std::uint64_t device_bytes = 0;
    double longest_milliseconds = 0;    ///< of all commands of this device so far
    std::string longest_command;        ///< its name
    std::uint64_t dropped_samples = 0;  ///< as in RenderProgress
    double measuring_seconds = 0;       ///< for noise and error, of those that rendering took
};

/// Per-pixel facts of the first surface that the pixel's centre sees.
struct Aovs {
    std::vector<float> depth;       ///< distance from the camera; +inf where nothing is
    std::vector<glm::vec3> normal;  ///< shading normal, towards the camera
    std::vector<glm::vec3> albedo;
    std::vector<std::uint32_t> primitive;  ///< CLARAY_MISS where nothing is
    std::vector<std::uint32_t> visits;     ///< boxes plus triangles tested: the heat map
};

/// Renders one scene on one device. The same configuration gives the same image bit for bit, run after run.
class Renderer {
public:
    /// Uploads the scene and builds its acceleration structure. Throws ErrorKind::usage for a configuration out of
    /// range, ErrorKind::user for a scene that `validate` refuses or a checkpoint that does not fit or can't be
    /// written, ErrorKind::device where memory does not suffice.
    Renderer(const Device& device, const Scene& scene, const RenderConfig& config);

    /// Adds samples until a target of the configuration is met. `progress` is called after the first batch of samples,
    /// a few times a second, and when the error was asked for; it returns false to stop, which takes one batch; the
    /// image is then valid, some pixels having more samples than others, and another call goes on where this one
    /// stopped. Returns what was reached. A checkpoint that can't be written ends nothing: see `checkpoint_error`.
    RenderProgress render(const std::function<bool(const RenderProgress&)>& progress = {});

    /// Forgets all samples and begins anew with those of another seed, to another number of samples a pixel and
    /// another depth where they are not 0 and no larger than those of the configuration. What is compiled, built and
    /// known of the device's pace stays. Throws ErrorKind::usage for a render that writes checkpoints.
    void restart(std::uint32_t seed, unsigned spp = 0, unsigned max_depth = 0);
    /// Builds the tree anew in another way, which changes no bit of the image. Does nothing, and returns false, where
    /// the scene has instances, or before it is rendered by its own kernels (see RenderStatistics).
    bool rebuild(const Bvh::Config& config);

    /// Mean linear radiance so far, row by row from the top left.
    [[nodiscard]] std::vector<glm::vec3> image() const;
    /// The share of the light that is missing since paths end after `RenderConfig::max_depth` surfaces, 0 to 1. An
    /// estimate: light from beyond is taken to fall as it does before. The first call traces some thousand paths.
    [[nodiscard]] double cut_off() const;
    [[nodiscard]] Aovs aovs() const;
    /// May wait for a kernel to be compiled.
    [[nodiscard]] RenderStatistics statistics() const;
    /// Why the last checkpoint could not be written; empty where it could.
    [[nodiscard]] const std::string& checkpoint_error() const;

    struct State;

private:
    std::shared_ptr<State> state_;
};

/// Compiles into the cache all kernels that renders of scenes with just these effects need.
void compile_kernels(const Device& device, EffectSet effects, const RenderConfig& config = {});

struct LightMapConfig {
    unsigned width = 128, height = 128;      ///< texels, 1 to 2^14 each
    unsigned spp = 256;                      ///< paths a texel
    unsigned max_depth = default_max_depth;  ///< surfaces at which a path may be scattered, the map's own included
    std::uint32_t seed = 0;
    std::uint32_t uv_set = 1;  ///< the coordinates that spread the mesh over 0..1 without overlaps
    Sampler sampler = Sampler::sobol;
    Bvh::Config bvh = {};
};

/// Irradiance of the front of a mesh, W / m^2, path traced at the centre of every texel that a triangle touches; texels
/// between the mesh's pieces continue their neighbours. Linear float32 RGB, bilinear, clamped: for Material::light_map
/// of Lambertian materials, with this `uv_set`. Light maps that the scene has are not used. `progress` gets the share
/// that is done; false stops with ErrorKind::user. Throws ErrorKind::usage for a configuration out of range,
/// ErrorKind::user where the mesh does not exist, has no such coordinates, leaves 0..1 or overlaps itself, or the scene
/// has instances.
[[nodiscard]] Texture bake_light_map(const Device& device, const Scene& scene, std::size_t mesh,
                                     const LightMapConfig& config = {},
                                     const std::function<bool(double)>& progress = {});

/// Lets the Lambertian materials of a mesh show the light map: as copies, since other meshes may have the same ones.
/// Throws ErrorKind::user where the mesh does not exist or has no coordinates in that set.
void use_light_map(Scene& scene, std::size_t mesh, Texture light_map, std::uint32_t uv_set = 1);

/// The set that the command line takes for a light map: the second where the mesh has one.
[[nodiscard]] std::uint32_t light_map_uv_set(const Scene& scene, std::size_t mesh);

}  // namespace claray
