// Accuracy against time: error and seconds for every setting of a method, measured on this device.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "claray/image/image_error.hpp"
#include "claray/renderer.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// The mean of many renders, each with its own seed.
struct ReferenceImage {
    std::vector<glm::vec3> pixels;
    unsigned spp = 0;
    double uncertainty = 0;  ///< estimated ImageError::rmse of the reference, from the spread of the renders
};

struct ReferenceOptions {
    unsigned least_spp = 4096;
    double uncertainty = 0;            ///< if > 0: continue until this uncertainty is reached, too
    unsigned most_spp = 1u << 20;      ///< upper limit of samples per pixel
    unsigned render_spp = 256;         ///< samples per pixel of each of its renders
    unsigned least_renders = 4;        ///< at least 2, whose spread tells the uncertainty
    std::uint32_t seed = 0x7e000000u;  ///< seed of the first render, far from the seeds that studies use
    /// Folder in which the reference is saved and from which it is continued; empty: do not save. The file name
    /// identifies scene, settings and device.
    std::filesystem::path folder = {};
};

/// Receives the fraction done, 0 to 1, and the name of the current step. Return false to stop.
using AccuracyProgress = std::function<bool(double done, const std::string& what)>;

/// Renders a converged image of the scene with the settings of `config`, but with other seeds than `config.seed`.
/// Throws ErrorKind::user if the image is black. An exception thrown by `progress` is passed on after the finished
/// renders are saved.
[[nodiscard]] ReferenceImage reference_image(const Device& device, const Scene& scene, const RenderConfig& config,
                                             const ReferenceOptions& options, const AccuracyProgress& progress = {});

/// Median and quartiles of repeated runs.
struct Spread {
    double low = 0, median = 0, high = 0;
};
/// Computes the quartiles and the median of `values`.
[[nodiscard]] Spread spread_of(std::vector<double> values);

/// The measurement of one setting of one method.
struct StudyPoint {
    std::string method;   ///< name of the curve in the plot: "Sobol"
    std::string setting;  ///< label of the setting: "64 spp"
    double value = 0;     ///< the setting as a number
    unsigned runs = 0;
    Spread error, seconds;
    ImageError errors;  ///< medians of all error measures; 0 if the study does not compare images
    std::vector<std::pair<std::string, double>> facts = {};  ///< further figures: name with unit, value
    bool front = false;   ///< true if no other point is both faster and more accurate
    std::string failure;  ///< the reason if the point could not be measured; otherwise empty
};

struct Study {
    std::string name;              ///< short name: "sampling"
    std::string title;             ///< title of the plot
    std::string error;             ///< what `StudyPoint::error` measures
    std::string cost = "seconds";  ///< unit of `StudyPoint::seconds`: "seconds per 10^6 rays"
    bool sweeps = true;            ///< the settings of a method are ordered, so that a plot connects its points
    std::vector<StudyPoint> points;
    double floor = 0;  ///< uncertainty of the reference; smaller errors have no meaning
    unsigned reference_spp = 0;
    std::vector<std::string> findings;  ///< conclusions in words: slopes, plateaus, the best method by range
    std::string device, driver;         ///< for plots and tables; studies leave them empty
    double took = 0;  ///< seconds of the whole study, compiling included; set by the program, 0 from a study
};

struct StudyOptions {
    RenderConfig config = {.width = 128, .height = 128};
    unsigned first_spp = 1;       ///< smallest number of samples per pixel
    unsigned most_spp = 256;      ///< largest number of samples per pixel; settings double up to it
    unsigned single_spp = 0;      ///< samples per pixel in studies without a sweep of samples; 0: most_spp
    unsigned compared_spp = 0;    ///< largest number in sweeps of other methods than samplers; 0: most_spp
    double least_seconds = 0;     ///< rays are traced repeatedly until a run takes as long
    double most_seconds = 0;      ///< a setting whose images took as long is not rendered again; 0: always `runs` times
    unsigned runs = 5;            ///< runs per setting, each with its own seed
    std::size_t rays = 1u << 18;  ///< number of rays in studies that trace rays without rendering an image
    Approximations approximations = all_approximations();  ///< measured by study_bias, each alone
    std::filesystem::path references = {};                 ///< see ReferenceOptions::folder
    unsigned reference_factor = 64;                        ///< samples of a reference per sample of the largest setting
    unsigned reference_renders = 4;                        ///< at least so many renders make a reference
    std::uint32_t reference_seed = ReferenceOptions{}.seed;
    /// Called after a reference, before renders are timed: may wait for what would disturb them.
    std::function<void()> before_timing = {};
    /// Receives an unfinished study whenever a study of images has measured more of its points. It has no findings yet.
    std::function<void(const Study& so_far)> measured = {};
};

/// The least time of a setting in a study of images, and the samples of the largest setting over those of the smallest.
struct StudyScale {
    double seconds = 0.02;
    unsigned span = 128;  ///< a power of two
};

/// Chooses size, samples and rays so that every setting of a study of images takes the device at least 20 ms. The
/// largest setting has 128 times the samples of the smallest, or as `scale` says. Then sampling takes most of the time,
/// not the launch of kernels. The slope of the error is visible over two decades of samples. Settings that take long
/// are rendered fewer times, so that all studies of a scene take about a minute. Measures the scene for about a second,
/// compiling not included. `keep_size`, `keep_spp` and `keep_rays`: leave the values of `options` as they are.
[[nodiscard]] StudyOptions at_scale(const Device& device, const Scene& scene, StudyOptions options, bool keep_size,
                                    bool keep_spp, bool keep_rays, const StudyScale& scale = {});

/// Error against samples per pixel, for each sampler.
[[nodiscard]] Study study_sampling(const Device& device, const Scene& scene, const StudyOptions& options,
                                   const AccuracyProgress& progress = {});

/// Checks the errors that study_sampling reports: measures its images again, against a second reference with other
/// seeds and 16 times the samples of the first one.
struct ErrorCheck {
    Study reported, independent;
    unsigned points = 0, within = 0;  ///< points in both studies, and those of them whose errors agree within 10 %
    double worst = 0;                 ///< largest relative difference of a point
    double slope = 0;                 ///< slope of log error over log samples for the independent sampler; theory: -0.5
};
[[nodiscard]] ErrorCheck check_errors(const Device& device, const Scene& scene, const StudyOptions& options,
                                      const AccuracyProgress& progress = {});

/// Error against samples per pixel for other techniques: only light sampling, only BSDF sampling, no Russian roulette.
/// If light lists or a light tree select among several lights, also selection by power.
[[nodiscard]] Study study_techniques(const Device& device, const Scene& scene, const StudyOptions& options,
                                     const AccuracyProgress& progress = {});

/// Error against samples per pixel without a denoiser and with each that is installed. Seconds include denoising. The
/// findings compare them at equal time and tell which part of the error is blur.
[[nodiscard]] Study study_denoising(const Device& device, const Scene& scene, const StudyOptions& options,
                                    const AccuracyProgress& progress = {});

/// Bias, which does not decrease with more samples, of several kinds. Paths end at 1 to 128 surfaces (1: direct light
/// only). Samples are clamped at multiples of the image's mean. No light reaches a diffuse surface via mirrors or
/// smooth glass. Ambient occlusion or one of StudyOptions::approximations replaces part of the light. The errors
/// contain no noise: two independent renders are multiplied, E[(a - r)(b - r)] = bias^2.
[[nodiscard]] Study study_bias(const Device& device, const Scene& scene, const StudyOptions& options,
                               const AccuracyProgress& progress = {});

/// One value per pixel, divided by the reference's mean.
struct ErrorMap {
    std::string name;  ///< name of the effect or "noise": "without-glass", "noise"
    std::vector<float> pixels;
};

/// Removes each effect that the scene uses (`without_effects`) and measures the resulting error and the time saved, for
/// the whole image and, if `maps` is not null, per pixel. Also reports the noise of the same number of samples.
[[nodiscard]] Study study_effects(const Device& device, const Scene& scene, const StudyOptions& options,
                                  const AccuracyProgress& progress = {}, std::vector<ErrorMap>* maps = nullptr);

/// Tests numerical robustness with rays aimed at edges and vertices of closed meshes, near the origin and far from it.
/// Compares triangle and box tests from the literature, with three kinds of arithmetic, and claray's own tests, in one
/// loop over one tree. A float64 oracle counts wrong hits; it uses exact arithmetic in doubtful cases.
[[nodiscard]] Study study_hard_rays(const Device& device, const Scene& scene, const StudyOptions& options,
                                    const AccuracyProgress& progress = {});

/// As study_hard_rays, with rays of the scene: from its camera, and one bounce from their hits.
[[nodiscard]] Study study_scene_rays(const Device& device, const Scene& scene, const StudyOptions& options,
                                     const AccuracyProgress& progress = {});

/// Compares builders with codes of 30 and 63 bits, and refitting with rebuilding after geometry has moved. The error is
/// the time to trace with the tree; the cost is the time to build it. The findings tell from which number of rays on a
/// tree has the lowest total time.
[[nodiscard]] Study study_builds(const Device& device, const Scene& scene, const StudyOptions& options,
                                 const AccuracyProgress& progress = {});

/// Compares trees of different kinds: octree and k-d tree (built by one thread of the host), linear BVH by Karras'
/// splits and by Apetrei's climb, clustering, binned SAH, spatial splits. Error and cost are those of study_builds. All
/// are traced by the same plain loop with the same tests of triangles; a point fails if its hits differ from the
/// others'.
[[nodiscard]] Study study_trees(const Device& device, const Scene& scene, const StudyOptions& options,
                                const AccuracyProgress& progress = {});

/// Compares nodes with boxes of 32, 16 and 8 bits per plane, rounded outward: smaller nodes cause more unnecessary box
/// tests. The error is the number of additional boxes tested, compared with full floats. A point fails if its hits
/// differ.
[[nodiscard]] Study study_nodes(const Device& device, const Scene& scene, const StudyOptions& options,
                                const AccuracyProgress& progress = {});

/// Compares fast math and other summations with strict arithmetic, on the same samples. The error contains no noise,
/// only the difference of the arithmetic.
[[nodiscard]] Study study_arithmetic(const Device& device, const Scene& scene, const StudyOptions& options,
                                     const AccuracyProgress& progress = {});

/// Compares ways to sum the samples of a pixel: in two floats, in one float, in half precision and in float64; up to 16
/// times `StudyOptions::rays` samples.
[[nodiscard]] Study study_sums(const Device& device, const Scene& scene, const StudyOptions& options,
                               const AccuracyProgress& progress = {});

/// Compares texture filters (nearest texel, bilinear, mip maps) and images with a quarter and a 16th of the pixels. The
/// reference is the finest level, bilinear, at full size.
[[nodiscard]] Study study_filtering(const Device& device, const Scene& scene, const StudyOptions& options,
                                    const AccuracyProgress& progress = {});

/// Compares flat and Gouraud shading with Phong shading of the same samples and triangles, over the number of triangles
/// of the built-in ball. The scene is not used.
[[nodiscard]] Study study_shading(const Device& device, const Scene& scene, const StudyOptions& options,
                                  const AccuracyProgress& progress = {});

/// Compares depth buffers of 8, 16 and 24 bits, of float32 and of reversed float32, at far/near of 100 to 100,000. All
/// surfaces on the ray of each pixel's centre are stored in the format. The error is the share of pixels, in per cent,
/// in which another surface has the nearest one's value, so that it wins if it is drawn first. The cost is bits per
/// pixel. `maps` receive 1 where the order of the scene's triangles shows a wrong surface, 0.5 where another order
/// does.
[[nodiscard]] Study study_depth(const Device& device, const Scene& scene, const StudyOptions& options,
                                const AccuracyProgress& progress = {}, std::vector<ErrorMap>* maps = nullptr);

/// Adds the images of up to 8 groups of the scene's light sources as values of the sRGB curve, as renderers do that do
/// not compute in linear light. The error is the distance from the sum of the same images as light. The error contains
/// no noise.
[[nodiscard]] Study study_gamma(const Device& device, const Scene& scene, const StudyOptions& options,
                                const AccuracyProgress& progress = {});

/// Sets `front` on all points for which no other point has both less error and less time.
void mark_front(std::vector<StudyPoint>& points);

/// Returns the slope of log y over log x by least squares; 0 for fewer than two points.
[[nodiscard]] double log_log_slope(std::span<const double> x, std::span<const double> y);

}  // namespace claray
#pragma GCC visibility pop
