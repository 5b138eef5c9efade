// What accuracy costs in time: error against seconds for every setting of a method, measured on this device.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "claray/renderer.hpp"

namespace claray {

/// How far an image is from another; of linear radiance.
struct ImageError {
    double rmse = 0;        ///< root of the mean squared difference of all channels, over the reference's mean
    double relmse = 0;      ///< mean over channels of (difference / (reference + 1 % of its mean))^2
    double perceptual = 0;  ///< 0 to 1: the colour term of FLIP (Andersson et al. 2020), both images exposed alike
};

/// Rows of `width` pixels. Throws ErrorKind::usage where the sizes differ or nothing is there to compare.
[[nodiscard]] ImageError image_error(std::span<const glm::vec3> image, std::span<const glm::vec3> reference,
                                     unsigned width);

/// The mean of many renders with seeds of their own.
struct ReferenceImage {
    std::vector<glm::vec3> pixels;
    unsigned spp = 0;
    double uncertainty = 0;  ///< its own ImageError::rmse, from the spread of the renders it is the mean of
};

struct ReferenceOptions {
    unsigned least_spp = 4096;
    double uncertainty = 0;            ///< go on until this is reached, too, where > 0
    unsigned most_spp = 1u << 20;      ///< but no further
    std::uint32_t seed = 0x7e000000u;  ///< of the first render, far from those that studies count up
    /// Where it is kept and continued; empty: nowhere. The file's name tells scene, settings and device apart.
    std::filesystem::path folder = {};
};

/// Tells how much is done, 0 to 1, of what; false stops.
using AccuracyProgress = std::function<bool(double done, const std::string& what)>;

/// A converged image of the scene as `config` would render it, by seeds that `config.seed` does not share. Throws
/// ErrorKind::user where it is black. What `progress` throws goes through, once what was rendered is kept.
[[nodiscard]] ReferenceImage reference_image(const Device& device, const Scene& scene, const RenderConfig& config,
                                             const ReferenceOptions& options, const AccuracyProgress& progress = {});

/// Median and quartiles over repeated runs.
struct Spread {
    double low = 0, median = 0, high = 0;
};
[[nodiscard]] Spread spread_of(std::vector<double> values);

/// One setting of one method.
struct StudyPoint {
    std::string method;   ///< a curve of the plot: "Sobol"
    std::string setting;  ///< "64 spp"
    double value = 0;     ///< the setting as a number
    unsigned runs = 0;
    Spread error, seconds;
    ImageError errors;  ///< medians of all measures; none where no image is measured
    std::vector<std::pair<std::string, double>> facts = {};  ///< further figures, by name with unit
    bool front = false;                                      ///< no other point is at once faster and more accurate
    std::string failure;                                     ///< why there is no figure
};

struct Study {
    std::string name;              ///< "sampling"
    std::string title;             ///< of the plot
    std::string error;             ///< what `StudyPoint::error` measures
    std::string cost = "seconds";  ///< what `StudyPoint::seconds` are for: "seconds per 10^6 rays"
    bool sweeps = true;            ///< a method's settings follow each other, so that a plot joins its points
    std::vector<StudyPoint> points;
    double floor = 0;  ///< the reference's own uncertainty: errors below it tell nothing
    unsigned reference_spp = 0;
    std::vector<std::string> findings;  ///< slopes, plateaus, who wins where
};

struct StudyOptions {
    RenderConfig config = {.width = 128, .height = 128};
    unsigned most_spp = 256;                ///< settings go up to it by factors of two
    unsigned runs = 5;                      ///< with seeds of their own
    std::size_t rays = 1u << 18;            ///< of studies that trace rays without making an image
    std::filesystem::path references = {};  ///< as ReferenceOptions::folder
    unsigned reference_factor = 64;         ///< samples of a reference, in those of the largest setting
    std::uint32_t reference_seed = ReferenceOptions{}.seed;
};

/// Samples a pixel by each sampler: how fast noise goes down.
[[nodiscard]] Study study_sampling(const Device& device, const Scene& scene, const StudyOptions& options,
                                   const AccuracyProgress& progress = {});

/// Whether the errors that study_sampling reports are true: its images once more, against a reference of other seeds
/// and 16 times the samples.
struct ErrorCheck {
    Study reported, independent;
    unsigned points = 0, within = 0;  ///< points in both, and those whose error is the same to 10 %
    double worst = 0;                 ///< how far, relatively, the worst point is off
    double slope = 0;                 ///< of log error over log samples, of the independent sampler: -0.5 by theory
};
[[nodiscard]] ErrorCheck check_errors(const Device& device, const Scene& scene, const StudyOptions& options,
                                      const AccuracyProgress& progress = {});

/// The same with lights or BSDFs sampled alone, without Russian roulette, and, where a tree picks among many lights,
/// with lights picked by power.
[[nodiscard]] Study study_techniques(const Device& device, const Scene& scene, const StudyOptions& options,
                                     const AccuracyProgress& progress = {});

/// What is left out for ever, however many samples there are: paths that end at 1 to 16 surfaces (1: direct light
/// alone), samples clamped at multiples of the image's mean, and no light that reaches a matt surface over mirrors or
/// smooth glass. Errors are free of noise, since two independent renders are multiplied: E[(a - r)(b - r)] = bias^2.
[[nodiscard]] Study study_bias(const Device& device, const Scene& scene, const StudyOptions& options,
                               const AccuracyProgress& progress = {});

/// One value per pixel, over the reference's mean.
struct ErrorMap {
    std::string name;  ///< "without-glass", "noise"
    std::vector<float> pixels;
};

/// Each effect that the scene calls for left out (`without_effects`): what that is wrong by and what time it saves, in
/// the image as a whole and, where `maps` is given, pixel by pixel, beside the noise of as many samples.
[[nodiscard]] Study study_effects(const Device& device, const Scene& scene, const StudyOptions& options,
                                  const AccuracyProgress& progress = {}, std::vector<ErrorMap>* maps = nullptr);

/// Rays that no camera sends by chance: aimed at edges and vertices of closed meshes, near the origin and far from it.
/// Tests of triangles and boxes from the literature, under three kinds of arithmetic, beside claray's, by one loop over
/// one tree; wrong hits by a float64 oracle that asks exact arithmetic where it is in doubt.
[[nodiscard]] Study study_hard_rays(const Device& device, const Scene& scene, const StudyOptions& options,
                                    const AccuracyProgress& progress = {});

/// The same on the scene's own rays: from its camera, and one bounce from what they hit.
[[nodiscard]] Study study_scene_rays(const Device& device, const Scene& scene, const StudyOptions& options,
                                     const AccuracyProgress& progress = {});

/// Builders with codes of 30 and 63 bits, and refits against rebuilds of what has moved. The error is the time to trace
/// with the tree, its cost the time to build it; findings tell from how many rays on which tree is done first.
[[nodiscard]] Study study_builds(const Device& device, const Scene& scene, const StudyOptions& options,
                                 const AccuracyProgress& progress = {});

/// Nodes with boxes of 32, 16 and 8 bits a plane, rounded outward: what smaller nodes cost in boxes that are entered in
/// vain. The error is boxes tested beyond those of full floats; hits that differ make a point fail.
[[nodiscard]] Study study_nodes(const Device& device, const Scene& scene, const StudyOptions& options,
                                const AccuracyProgress& progress = {});

/// Fast math and other sums against strict arithmetic on the same samples: no noise is part of the error, which is what
/// the arithmetic changes.
[[nodiscard]] Study study_arithmetic(const Device& device, const Scene& scene, const StudyOptions& options,
                                     const AccuracyProgress& progress = {});

/// How samples are added up in a pixel: in two floats, in one, in half precision and in float64; up to 16 times
/// `StudyOptions::rays` of them.
[[nodiscard]] Study study_sums(const Device& device, const Scene& scene, const StudyOptions& options,
                               const AccuracyProgress& progress = {});

/// Textures by the nearest texel, bilinear and from mip maps, and images of a quarter and a 16th of the pixels. The
/// truth is the finest level, bilinear, at full size.
[[nodiscard]] Study study_filtering(const Device& device, const Scene& scene, const StudyOptions& options,
                                    const AccuracyProgress& progress = {});

/// Marks the points that no other one beats in both error and time.
void mark_front(std::vector<StudyPoint>& points);

/// The slope of log y over log x by least squares; 0 for fewer than two points.
[[nodiscard]] double log_log_slope(std::span<const double> x, std::span<const double> y);

}  // namespace claray
