// Rendering: a progressive path tracer.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "claray/bvh.hpp"
#include "claray/effects.hpp"
#include "claray/image/picture.hpp"
#include "claray/shared/gbuffer.h"
#include "claray/shared/lists/aovs.h"

#pragma GCC visibility push(default)
namespace claray {

/// The source of random numbers.
enum class Sampler : std::uint32_t {
    sobol,       ///< Owen-scrambled Sobol points: less noise for the same number of samples
    independent  ///< plain Monte Carlo, for comparison
};

/// What removes noise from an image.
enum class DenoiserKind {
    automatic,  ///< Open Image Denoise if it is installed, else claray's own
    claray,     ///< kernels of claray: fast, and less strong as noise vanishes
    oidn        ///< Intel's Open Image Denoise, a neural network on the CPU, loaded at run time
};
/// Returns the denoiser that `automatic` stands for here; other kinds unchanged.
[[nodiscard]] DenoiserKind picked_denoiser(DenoiserKind kind);
/// Throws ErrorKind::user if Open Image Denoise is not installed.
void require_oidn();

inline constexpr unsigned default_max_depth = 128;

/// Cheaper answers to what light arrives at a surface. Each changes the image: `claray accuracy --only bias` shows by
/// how much.
struct Approximations {
    /// Camera rays end at their first surface. There all lights without extent are summed up, without shadows, from
    /// lists of those that reach the surfaces of 16x16 pixels. Nothing else lights surfaces: no lamp, no sky, no other
    /// surface. This is deferred shading, for very many lights that move.
    bool tile_sum = false;
    /// Where a path meets a diffuse surface, a grid of probes answers what light arrives from all other surfaces; the
    /// path ends. Lights still cast exact shadows. See LightGridConfig. Cannot be used together with tile_sum.
    bool light_grid = false;
    /// Flat shading: where a camera ray meets a surface, the triangle's centroid is lit and seen in place of the hit,
    /// with the triangle's normal. One colour per face. Mirrors, glass and the textures of all surfaces stay per pixel.
    bool flat = false;
    /// Gouraud shading: the triangle's vertices are lit and seen with their normals, highlights included, and their
    /// colours are interpolated. Vertices without normals take the triangle's. Mirrors, glass and textures as for flat.
    /// With tile_sum the three colours are computed; otherwise each path picks one by its share, and shadows, lamps and
    /// bounces take part. Without flat and gouraud, normals are interpolated: Phong shading.
    bool gouraud = false;
    /// Lights shine through everything: no shadow rays. A sky without an image is found by bounces and stays hidden.
    bool no_shadows = false;

    bool operator==(const Approximations&) const = default;
    [[nodiscard]] bool any() const { return *this != Approximations{}; }
};
/// The grid of Approximations::light_grid. Every probe holds the light that arrives at its place as spherical
/// harmonics: Greger et al. 1998, "The irradiance volume". A surface blends those of the eight probes around it that it
/// sees. Where a surface sees none of them, the path goes on.
struct LightGridConfig {
    /// Voxels instead of probes: each holds what the surfaces within it reflect, as a virtual point light with 4
    /// coefficients (Kaplanyan and Dachsbacher 2010). Surfaces receive light from the voxels next to them only, as fast
    /// games do it, and the image is much darker than with probes.
    bool voxels = false;
    unsigned side = 16;         ///< probes per axis, 2 to 64; the coarsest level spans the scene
    unsigned coefficients = 9;  ///< per colour: 4 (bands 0 and 1) or 9 (up to band 2)
    unsigned levels = 1;        ///< 1 to 4; each finer one has a quarter of the spacing and follows the camera
    unsigned gather = 0;        ///< surfaces that a path meets before the grid answers; 1 is final gathering
    unsigned rays = 64;         ///< per probe and update, 8 to 4096
    /// Updates before the first image; each follows the light by one more bounce. After a change of the scene each call
    /// of Renderer::render makes one, three times as many in all.
    unsigned updates = 16;
    bool operator==(const LightGridConfig&) const = default;
};

/// Returns all approximations.
[[nodiscard]] Approximations all_approximations();
/// Returns those among `among` that have an effect in this scene, one at a time.
[[nodiscard]] std::vector<Approximations> approximations_for(const Scene& scene,
                                                             const Approximations& among = all_approximations());
/// Returns the names of the approximations that are used, separated by commas: "tile-sum"; "nothing" if none is.
[[nodiscard]] std::string to_string(const Approximations& approximations);
/// Returns the members of `grid`, separated by spaces.
[[nodiscard]] std::string to_string(const LightGridConfig& grid);
/// Parses the output of `to_string`. Throws ErrorKind::usage for an unknown one.
[[nodiscard]] Approximations parse_approximations(const std::string& text);

/// A part of an image, in pixels from its top left. A width of 0: the whole image.
struct Region {
    unsigned x = 0, y = 0, width = 0, height = 0;
    bool operator==(const Region&) const = default;
};

struct RenderConfig {
    unsigned width = 512, height = 512;  ///< pixels, 1 to 2^14 each
    unsigned spp = 64;                   ///< samples per pixel at which rendering stops, >= 1
    /// Largest number of surfaces at which a path is scattered, >= 1; 1 is direct light only. Russian roulette ends
    /// nearly all paths earlier without bias, so that the default loses almost no light: see Renderer::cut_off.
    unsigned max_depth = default_max_depth;
    /// If > 0: samples whose largest colour component is above this are scaled down to it. This removes rare bright
    /// pixels ("fireflies") and darkens the image: `claray accuracy SCENE --only bias` measures by how much.
    float sample_clamp = 0;
    std::uint32_t seed = 0;
    double seconds = 0;  ///< if > 0: stop after this time, but not before every pixel has a sample
    double noise = 0;    ///< if > 0: stop at this noise (see RenderProgress), from 16 samples per pixel on
    /// If > 0: stop when the image's error (RMSE over the mean, as ImageError::rmse) is at most this, by an estimate
    /// that holds in 95 of 100 renders. `spp` is then the upper limit, and the image is that of the samples taken.
    double error = 0;
    /// Takes more samples where the estimated error is large: `spp` is then the mean over the pixels. After 16 samples
    /// per pixel, the samples of those half tiles (of 8x8 pixels) are doubled that gain most by a sample. The image is
    /// the mean of all samples. Its expectation is that of a uniform render but for second-order effects, because the
    /// error of a pixel is estimated from other pixels (docs/accuracy.md). Cannot be used with
    /// Approximations::tile_sum.
    bool adaptive = false;
    /// Paths learn from the image's first samples where light comes from, and choose directions of diffuse reflection
    /// accordingly, where these samples promise less noise. The expectation of the image is the same. Ignored on GPUs,
    /// up to 8 samples per pixel, below 16,384 pixels, with hot spots and with approximations.
    bool guide = true;
    double report_seconds = 0.2;  ///< approximate time between two calls of the `progress` of Renderer::render
    Sampler sampler = Sampler::sobol;
    Bvh::Config bvh = {};  ///< Builder::automatic is `balanced` for scenes with instances
    /// Splits the tree into so many parts by space; 0: as many as the device's memory requires. The image is the same.
    /// Parts for which there is no room wait in host memory, and are copied to the device for each set of rays.
    unsigned parts = 0;
    EffectOverrides effects = {};     ///< changes, for experiments, the effects that are derived from the scene
    Approximations approximate = {};  ///< none: the image has no error but noise
    LightGridConfig light_grid = {};  ///< for Approximations::light_grid
    /// Path of the program `claray`, to compile kernels in the background while other kernels already render; empty:
    /// rendering starts after the scene's own kernels are compiled. The image is the same.
    std::string compiler = {};
    /// If not empty: a file that `render` writes periodically (`checkpoint_seconds`) and before it returns. An
    /// interrupted render can continue from it.
    std::filesystem::path checkpoint = {};
    double checkpoint_seconds = 30;
    /// If not empty: a checkpoint from which to continue. Scene, width, height, seed, depth, sampler and effect
    /// overrides must be the same; `spp` may be larger. On the same device, the image is equal bit for bit to an
    /// uninterrupted render.
    std::filesystem::path resume = {};
    /// Renders these pixels only, with the same bits as the whole image has there: images, AOVs and maps are those of
    /// the region. Not with adaptive sampling, tile_sum, denoising or several devices.
    Region region = {};
    /// The background is transparent, and Material::role counts. `Renderer::image` is then premultiplied by
    /// `Renderer::alpha`. The background still lights the scene, and is seen in mirrors and through glass, which is
    /// opaque. Not with checkpoints or several devices.
    bool alpha = false;
    /// Keeps the light of the image by how its first surface sends it to the camera: see Renderer::light_layers. Not
    /// with alpha, approximations, checkpoints or several devices.
    bool lobes = false;
    /// Keeps the light of groups of lights: "NAME=light,light" each. A light is named by the name of a Light or of an
    /// emissive Material, by its number as "light:N" or "material:N", or as "sky", which is sky and environment.
    std::vector<std::string> light_groups = {};

    /// Those of the images that are rendered.
    [[nodiscard]] unsigned image_width() const { return region.width > 0 ? region.width : width; }
    [[nodiscard]] unsigned image_height() const { return region.width > 0 ? region.height : height; }
};

/// Progress of a render.
struct RenderProgress {
    unsigned spp = 0;  ///< samples per pixel, the mean rounded down
    unsigned spp_target = 0;
    double seconds = 0;  ///< since the first sample
    /// Standard error of luminance, root mean square over pixels, over the mean; 0: unknown. With Sobol samples 0.9 to
    /// 1.5 times the true one (docs/accuracy.md).
    double noise = 0;
    double error = 0;               ///< estimate of ImageError::rmse, if RenderConfig::error is set; 0: unknown
    double error_bound = 0;         ///< upper bound of the error in most renders; compared with RenderConfig::error
    double error_of_fireflies = 0;  ///< the part of the squared error that single bright pixels have, 0 to 1
    /// Returns false if fireflies make the error estimate uncertain: others may follow, or be missing.
    [[nodiscard]] bool error_is_sure() const { return error_of_fireflies < 0.2; }
    unsigned error_spp = 0;    ///< samples per pixel at the time of the error estimate, between two passes
    double cut_off = 0;        ///< as Renderer::cut_off, if RenderConfig::error is set; included in both errors
    bool own_kernels = false;  ///< whether the scene's own kernels are in use (see RenderStatistics)
    /// Whether sampling pauses while this process compiles the scene's own kernels, because waiting for them saves
    /// time.
    bool waits_for_kernels = false;
    std::uint64_t dropped_samples = 0;  ///< NaN, infinite or above 1e30; left out of the image
    std::uint32_t culled = 0;           ///< triangles left out: not finite, huge, or without area
};

/// Number of rays traced and the device time for tracing them.
struct RayCount {
    std::uint64_t rays = 0;
    double milliseconds = 0;
    [[nodiscard]] double mrays_per_second() const { return milliseconds > 0 ? double(rays) * 1e-3 / milliseconds : 0; }
};

/// The kernels with which a render started.
enum class KernelStart {
    own,      ///< compiled for the scene's effects
    generic,  ///< support all effects; used if they were in the cache and the scene's own kernels were not
    quick     ///< compile fastest; used if the cache had none
};

struct RenderStatistics {
    double first_pixel_seconds = 0;            ///< from the renderer's construction to the first batch of samples
    double first_pixel_processor_seconds = 0;  ///< CPU time of all threads of the process in that period
    KernelStart start = KernelStart::own;
    unsigned own_kernels_from = 0;  ///< samples per pixel that were done when the scene's own kernels took over
    bool own_kernels = false;       ///< whether the scene's own kernels are in use
    double build_milliseconds = 0;  ///< device time of building the acceleration structure
    BvhStatistics bvh;
    std::uint32_t primitives = 0;     ///< of the scene's PrimitiveSets
    RayCount camera, bounce, shadow;  ///< times of tracing only; 0 if unknown, as for `in_paths`
    /// Rays of the above that were traced by a kernel which processes whole paths, and its time. Used on GPUs for
    /// scenes with few effects and short paths.
    RayCount in_paths;
    EffectSet effects;                    ///< effects of the scene, after `RenderConfig::effects`
    std::uint64_t device_bytes = 0;       ///< of this renderer's buffers, with those for rebuilding the tree
    std::uint64_t most_device_bytes = 0;  ///< the most that all buffers on this device have been at once
    unsigned parts = 1;                   ///< of the tree, see RenderConfig::parts
    std::uint64_t bytes_paged = 0;        ///< copied to the device because parts took turns
    double longest_milliseconds = 0;      ///< longest command of this device so far
    std::string longest_command;          ///< its name
    std::uint64_t dropped_samples = 0;    ///< as in RenderProgress
    double measuring_seconds = 0;         ///< part of the rendering time that was used to estimate noise and error
    bool adapted = false;                 ///< whether adaptive sampling gave some pixels more samples than others
    bool guided = false;                  ///< whether paths were guided, or will be by what was learnt so far
};

/// The types of a pixel by the kinds of AOVs (claray/shared/lists/aovs.h).
namespace aov_kinds {
using distance = float;
using direction = glm::vec3;
using color = glm::vec3;
using place = glm::vec3;
using coordinates = glm::vec2;
using movement = glm::vec2;
using share = float;
using identifier = std::uint32_t;
using count = std::uint32_t;
}  // namespace aov_kinds

/// Data of the first surface that is visible at each pixel's centre, such as `depth`: claray/shared/lists/aovs.h lists
/// them. Each is a vector of width * height elements, row by row from the top left.
struct Aovs {
#define CLARAY_MEMBER(name, kind, letters, meaning) std::vector<aov_kinds::kind> name = {};
    CLARAY_AOVS(CLARAY_MEMBER)
#undef CLARAY_MEMBER
};

/// How a picture shows an AOV.
enum class AovKind { distance, share, direction, color, place, coordinates, movement, identifier, count };

struct AovRow {
    const char* name;
    AovKind kind;
    const char* letters;  ///< channels of an EXR's layer, one letter each
    const char* meaning;
};
inline constexpr AovRow aov_rows[] = {
#define CLARAY_ROW(name, kind, letters, meaning) {#name, AovKind::kind, letters, meaning},
    CLARAY_AOVS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// A layer of the light of an image.
struct LightLayer {
    std::string name;
    std::vector<glm::vec3> pixels;  ///< row by row from the top left
};

/// Calls visit(const AovRow&, pixels) for each AOV; `pixels` is the member of `aovs`.
template <class AovsOrConst, class Visit>
void for_each_aov(AovsOrConst& aovs, Visit&& visit) {
    const AovRow* row = aov_rows;
#define CLARAY_VISIT(name, kind, letters, meaning) visit(*row++, aovs.name);
    CLARAY_AOVS(CLARAY_VISIT)
#undef CLARAY_VISIT
}

/// How unit vectors become two 16-bit numbers.
enum class NormalPacking {
    octahedral,  ///< wrong by at most 0.0037 degrees, 0.0013 in the mean
    spherical    ///< azimuth and polar angle: at most 0.0031 degrees, 0.0014 in the mean
};

/// What deferred shading keeps of the surface at each pixel's centre: 12 bytes (claray/shared/gbuffer.h).
struct GBuffer {
    unsigned width = 0, height = 0;
    NormalPacking normals = NormalPacking::octahedral;
    std::vector<GBufferPixel> pixels;  ///< row by row from the top left
    /// The inverse of the view and projection. It takes a position in the image (-1 to 1 on both axes, y upwards), the
    /// depth and 1 to a position in the world. Divide the result by its w. Near and far planes are at 0.002 and 2 radii
    /// of the scene; surfaces nearer than the former have depths above 1.
    glm::dmat4 world_from_image{1};
};
/// Returns the shading normal; 0 0 0 where there is no surface.
[[nodiscard]] glm::vec3 normal_of(const GBuffer& buffer, std::size_t pixel);
/// Returns the position in the world, restored from the depth; not finite where there is no surface.
[[nodiscard]] glm::vec3 position_of(const GBuffer& buffer, std::size_t pixel);

/// What has changed in a scene.
struct SceneChanges {
    bool camera = false;
    bool lights = false;     ///< Scene::lights, in any number
    bool materials = false;  ///< members of materials, except their textures
    bool sky = false;
    bool instances = false;  ///< transforms
    bool vertices = false;   ///< positions and normals of meshes
};

/// Renders one scene on one device. The same configuration gives the same image bit for bit in every run.
class Renderer {
public:
    /// Uploads the scene and builds its acceleration structure. Throws ErrorKind::usage for a configuration out of
    /// range, and ErrorKind::user for a scene that `validate` refuses, or a checkpoint that does not match or cannot
    /// be written. Throws ErrorKind::device if the device has too little memory.
    Renderer(const Device& device, const Scene& scene, const RenderConfig& config);

    /// Adds samples until a target of the configuration is reached. Blocks. `progress` is called after the first batch
    /// of samples, every RenderConfig::report_seconds, and after each error estimate. Return false from it to stop
    /// after the current batch: the image is then valid, some pixels have more samples than others, and another call
    /// continues. Returns the progress reached. A checkpoint that cannot be written does not stop the render: see
    /// `checkpoint_error`.
    RenderProgress render(const std::function<bool(const RenderProgress&)>& progress = {});
    /// The same for at most so many seconds from now, but not before every pixel has a sample. Once the speed of
    /// batches is known, the last ones are made small enough for the time that is left. Negative is 0, infinity no
    /// limit; throws ErrorKind::usage for NaN.
    RenderProgress render_for(double seconds, const std::function<bool(const RenderProgress&)>& progress = {});

    /// Discards all samples and restarts with another seed. `spp` and `max_depth` replace those of the configuration
    /// unless they are 0; they must not be larger. Compiled kernels, the tree and the measured speed of the device are
    /// kept. Throws ErrorKind::usage for a render that writes checkpoints.
    void restart(std::uint32_t seed, unsigned spp = 0, unsigned max_depth = 0);
    /// Discards all samples and continues with a scene that differs from the earlier one in `changes`: nothing else is
    /// read, checked or uploaded. The image is that of a new renderer of the scene. One thing differs: lights are
    /// selected by the first scene's radius. This changes the noise if there are near and far lights. Kernels are
    /// compiled only if the scene has effects that those in use do not support (see EffectOverrides::add), or when
    /// surfaces move for the first time without `settle`. Throws ErrorKind::user for values that `validate` refuses.
    /// Throws ErrorKind::usage if meshes, instances or materials differ in number or size, or for a render that writes
    /// checkpoints. The renderer is then unchanged.
    void update(const Scene& scene, const SceneChanges& changes);
    /// Loads the fastest kernels for the scene now, compiling them if necessary, and runs each once, so that no later
    /// render waits for a kernel unless `update` brings other effects. Kernels that move surfaces are loaded, too.
    /// Without `settle` the fastest kernels are loaded while rendering, when that saves time. Discards all samples.
    /// Throws ErrorKind::usage for a render that writes checkpoints.
    void settle();
    /// Loads now what later renders would load or compile while they run, and runs it once. Keeps all samples. Has no
    /// effect before the first sample of every pixel, and before the scene's own kernels are compiled (see
    /// RenderConfig::compiler).
    void load_kernels();
    /// Discards all samples and makes the images this large. The view keeps its height and becomes wider or narrower.
    /// Only what is stored per pixel is allocated anew. Throws ErrorKind::usage for a size out of range, with
    /// checkpoints or with adaptive sampling.
    void resize(unsigned width, unsigned height);
    /// Rebuilds the tree with another configuration; the image does not change. Does nothing and returns false if the
    /// scene has instances, or before the scene's own kernels are in use (see RenderStatistics).
    bool rebuild(const Bvh::Config& config);

    /// Returns the mean linear radiance so far, row by row from the top left. Blocks.
    [[nodiscard]] std::vector<glm::vec3> image() const { return image(0, 0); }
    /// The same in another size, interpolated bilinearly on the device; 0: as rendered.
    [[nodiscard]] std::vector<glm::vec3> image(unsigned width, unsigned height) const;
    /// The same into memory of the caller, which has width x height pixels. Faster than a new vector of a large image,
    /// whose pages the system first has to provide. Throws ErrorKind::usage for another number of pixels.
    void image(std::span<glm::vec3> to, unsigned width = 0, unsigned height = 0) const;
    /// Returns the image without a copy, for programs that need it in every frame. The memory belongs to the renderer
    /// and holds the image until the next call of this or of `image`. Blocks.
    [[nodiscard]] std::span<const glm::vec3> radiance(unsigned width = 0, unsigned height = 0) const;
    /// Returns the alpha of each pixel, 0 to 1: the share of its camera rays that meet a surface first, as
    /// Material::role says. A shadow catcher counts with 1 - (light with the other surfaces / light without them), by
    /// the colour that loses most. What other colours lose less is in the image. All 1 without RenderConfig::alpha.
    /// Blocks.
    [[nodiscard]] std::vector<float> alpha() const;
    /// Returns the image with exposure, tone map and the sRGB curve: red, green, blue and 255 per pixel, the same bytes
    /// as write_image stores. The memory belongs to the renderer and holds the picture until the next call. Blocks.
    [[nodiscard]] std::span<const std::uint8_t> picture(const PictureConfig& config = {}) const;
    /// Returns the mean linear radiance so far without most of its noise, see docs/denoise.md. The samples are kept.
    /// Blocks. Throws ErrorKind::user for a denoiser that is not installed. The first call takes memory of the device
    /// and loads kernels. The renderer keeps them until its size changes or `release_denoiser` is called; guides
    /// are made again if the scene changes.
    [[nodiscard]] std::vector<glm::vec3> denoised(DenoiserKind kind = DenoiserKind::automatic) const;
    /// Returns the same as a picture, for frames that are shown one after the other. If `update` changes the camera or
    /// moves objects, light of the pictures before is used again where it fits (docs/denoise.md). claray's own denoiser
    /// is used, because it is fast enough for frames. The memory is that of `picture`. Blocks.
    [[nodiscard]] std::span<const std::uint8_t> denoised_picture(const PictureConfig& config = {});
    /// Gives back what `denoised` and `denoised_picture` keep. The next picture uses no light of those before.
    void release_denoiser();
    /// Returns the variance of each pixel's mean luminance over the square of the image's mean luminance: the mean over
    /// pixels with two samples or more is RenderProgress::noise squared. 0 for other pixels. Blocks.
    [[nodiscard]] std::vector<float> noise_map() const;
    /// Returns half the width of each pixel's interval: 19 of 20 hold the pixel's true luminance, as long as no
    /// fireflies are there (docs/accuracy.md). Renders some pixels again, 1,024 to 4,096, or takes those of
    /// RenderConfig::error. Row by row from the top left; all 0 before the second sample. Blocks.
    [[nodiscard]] std::vector<float> error_map();
    /// Estimates the error of an image of this render, as ImageError::rmse; of one that is denoised, for example. 0 if
    /// it is too small to tell. Renders pixels again as `error_map`. Throws ErrorKind::usage for an image of another
    /// size. Blocks.
    [[nodiscard]] double error_of(std::span<const glm::vec3> image);
    /// Returns the share of light that is missing because paths end after `RenderConfig::max_depth` surfaces, 0 to 1.
    /// An estimate: the light beyond that depth is extrapolated. The first call traces some thousand paths.
    [[nodiscard]] double cut_off() const;
    /// Returns why RenderConfig::guide guides no path although device, size and samples allow it: one line, or empty.
    [[nodiscard]] std::string why_unguided() const;
    /// Returns per-pixel data of the first visible surface, row by row from the top left. Blocks.
    [[nodiscard]] Aovs aovs() const;
    /// Returns the layers of RenderConfig::lobes, "lobe_NAME" for each row of claray/shared/lists/lobes.h, and of
    /// RenderConfig::light_groups, "light_NAME". "lobe_rest" is the image minus the sum of all lobes, which is
    /// rounding; "light_rest" has the light of no group, too. So the sum of the lobes is the image, and so is that of
    /// the groups. Blocks. Throws ErrorKind::usage if the configuration asks for neither.
    [[nodiscard]] std::vector<LightLayer> light_layers() const;
    /// Returns the albedo of the surface in the voxel that each pixel's centre shows, for LightGridConfig::voxels.
    /// Throws ErrorKind::usage without it. Blocks.
    [[nodiscard]] std::vector<glm::vec3> voxels() const;
    /// Returns the G-buffer of the surfaces of `aovs`. Blocks.
    [[nodiscard]] GBuffer gbuffer(NormalPacking packing = NormalPacking::octahedral) const;
    /// Returns the statistics so far. May wait for a kernel to be compiled.
    [[nodiscard]] RenderStatistics statistics() const;
    /// Returns why the last checkpoint could not be written; empty if it was written.
    [[nodiscard]] const std::string& checkpoint_error() const;

    struct State;  ///< not for users

private:
    friend struct Internals;
    std::shared_ptr<State> state_;
};

/// Estimates the error of a render with approximations, as ImageError::rmse; 0 if it is too small to tell. `exact` is a
/// renderer of the same scene and size without them. It renders the control pixels of `approximate` twice, each with as
/// many samples, and needs no samples of its own. Throws ErrorKind::usage for other sizes. Blocks.
[[nodiscard]] double approximation_error(Renderer& approximate, Renderer& exact);

/// Compiles the kernels that renders of scenes with exactly these effects need, and stores them in the cache. Kernels
/// that trace primitives are compiled with their scene. Throws ErrorKind::device with the compiler's log.
void compile_kernels(const Device& device, EffectSet effects, const RenderConfig& config = {});

/// Renders the light that arrives at a point: six square images of `config.height` pixels a side, as an Environment has
/// them for the faces of a cube. The camera of the scene is ignored. Throws as Renderer does.
[[nodiscard]] Environment render_probe(const Device& device, Scene scene, const glm::vec3& position,
                                       RenderConfig config);
/// Returns an environment as one image in latitude and longitude, linear float32, times its strength, without its
/// rotation. The image of a cube has the cube's resolution at the horizon.
[[nodiscard]] Texture panorama_of(const Environment& environment);

struct LightMapConfig {
    unsigned width = 128, height = 128;      ///< texels, 1 to 2^14 each
    unsigned spp = 256;                      ///< paths per texel
    unsigned max_depth = default_max_depth;  ///< surfaces that scatter a path, at most, including that of the map
    std::uint32_t seed = 0;
    std::uint32_t uv_set = 1;  ///< texture coordinates that map the mesh to 0..1 without overlaps
    Sampler sampler = Sampler::sobol;
    Bvh::Config bvh = {};
};

/// Bakes the irradiance of the front of a mesh, in W / m^2, by path tracing from the centre of every texel that a
/// triangle touches. Texels between the pieces of the mesh continue their neighbours. Returns linear float32 RGB,
/// bilinear, clamped, for Material::light_map of Lambertian materials with the same `uv_set`. Existing light maps of
/// the scene are ignored. `progress` receives the fraction done; return false to stop with ErrorKind::user. Throws
/// ErrorKind::usage for a configuration out of range; ErrorKind::user if the mesh does not exist, lacks these
/// coordinates, leaves 0..1 or overlaps itself, or if the scene has instances.
[[nodiscard]] Texture bake_light_map(const Device& device, const Scene& scene, std::size_t mesh,
                                     const LightMapConfig& config = {},
                                     const std::function<bool(double)>& progress = {});

/// Assigns the light map to the Lambertian materials of a mesh. The materials are copied first, since other meshes may
/// use them. Throws ErrorKind::user if the mesh does not exist or lacks coordinates in that set.
void use_light_map(Scene& scene, std::size_t mesh, Texture light_map, std::uint32_t uv_set = 1);

/// Returns the set that the command line uses for a light map: the second set if the mesh has one.
[[nodiscard]] std::uint32_t light_map_uv_set(const Scene& scene, std::size_t mesh);

}  // namespace claray
#pragma GCC visibility pop
