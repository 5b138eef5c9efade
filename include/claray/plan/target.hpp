// Targets: an error, a time or frames per second. A planner chooses the settings with a measured model of the device.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "claray/renderer.hpp"

#pragma GCC visibility push(default)
namespace claray {

class RenderGroup;

/// The builders that the planner chooses among.
inline constexpr Builder planned_builders[] = {
#define CLARAY_ROW(name, NAME, note, codes, splits) Builder::name,
    CLARAY_PLANNED_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// How fast a device builds trees and renders, for each builder.
struct DeviceModel {
    struct Preset {
        double build_nanoseconds = 0;   ///< per triangle
        double samples_per_second = 0;  ///< in the scene of the model
    };
#define CLARAY_ROW(name, NAME, note, codes, splits) Preset name;
    CLARAY_PLANNED_BUILDERS(CLARAY_ROW)  // fast, balanced and high
#undef CLARAY_ROW
    double independent_cost = 0;  ///< time of independent samples divided by time of Sobol samples, at equal error

    [[nodiscard]] const Preset& of(Builder builder) const;
    [[nodiscard]] bool known() const { return fast.samples_per_second > 0; }
};

/// Returns the model that `claray tune` stored for this device in the tuning table. Not `known()` if it never ran.
[[nodiscard]] DeviceModel stored_model(const Device& device);
/// Receives the name of the next measurement. Return false to stop; the model is then not known.
using MeasuringProgress = std::function<bool(const std::string& what)>;
/// Measures the model with a terrain of this many triangles: takes a few seconds and the time for compiling. The
/// commands are recorded by the device's profiler.
[[nodiscard]] DeviceModel measure_model(const Device& device, std::size_t triangles = 100'000,
                                        const MeasuringProgress& progress = {});
/// A model value as a row of the tuning table.
struct ModelRow {
    std::string kernel, parameter;
    unsigned value = 0;
};
[[nodiscard]] std::vector<ModelRow> rows_of(const DeviceModel& model);

/// Returns the builder with the least total time for building a tree over this many triangles and for tracing that
/// takes `seconds_with_fast` with Builder::fast. A tree of `built` exists already. Returns `fast` if the model is not
/// known.
[[nodiscard]] Builder choose_builder(const DeviceModel& model, std::size_t triangles, double seconds_with_fast,
                                     Builder built = Builder::fast);

/// The same for a render of `config.spp` samples per pixel, by the model that is stored for the device. Returns the
/// given builder if there is no model or the scene has instances. The image does not depend on it.
[[nodiscard]] Builder choose_builder_for_samples(const Device& device, const Scene& scene, const RenderConfig& config);

/// The choices of the planner for RenderConfig::error or RenderConfig::seconds.
struct TargetPlan {
    RenderConfig config;  ///< the given configuration with the chosen settings
    DeviceModel model;
    std::size_t triangles = 0;
    bool picks_builder = true;        ///< false: keep the given builder
    std::vector<std::string> picks;   ///< each choice and its reason, one line each
    double promised_seconds = 0;      ///< sampling time, predicted after the first samples of a render to an error
    double seconds_to_foresee = 0.3;  ///< sampling time on which the prediction is based
    MeasuringProgress measuring;      ///< called if the device must be measured during the render
};

/// Chooses sampler and builder for a render to an error or within a time. If the device has no model and the time is
/// long enough, measures a small model first.
[[nodiscard]] TargetPlan plan_render(const Device& device, const Scene& scene, const RenderConfig& config,
                                     bool picks_builder = true, const MeasuringProgress& measuring = {});

/// Renders to the target. `renderer` must be constructed with `plan.config`. After the first samples, the time for
/// reaching an error is predicted, and the tree may be rebuilt. `progress` as in Renderer::render. Throws
/// ErrorKind::user, naming the closest possible target, if a time cannot be met, or if an error cannot be reached and
/// there is no time limit.
RenderProgress render_to_target(const Device& device, Renderer& renderer, TargetPlan& plan,
                                const std::function<bool(const RenderProgress&)>& progress = {});
/// The same with several devices, whose trees are never rebuilt.
RenderProgress render_to_target(RenderGroup& group, TargetPlan& plan,
                                const std::function<bool(const RenderProgress&)>& progress = {});

/// The result of rendering frames at a rate. Each frame is a separate render; its time runs from the first sample until
/// its image is in host memory.
struct FramesReport {
    unsigned spp = 0, max_depth = 0;  ///< chosen values, as are the following
    unsigned width = 0, height = 0;   ///< of the images that are traced, and then enlarged to the wanted size
    Approximations approximate;
    /// If one sample of full depth for every pixel takes too long: RMSE of a frame over the mean of the image, measured
    /// against many samples; else 0.
    double error = 0;
    std::vector<std::string> picks;     ///< each choice and its reason, one line each
    std::vector<double> seconds;        ///< time of each frame
    double median = 0, percentile = 0;  ///< median and 99th percentile of `seconds`
    std::vector<glm::vec3> image;       ///< the last frame
};

struct FramesConfig {
    double fps = 60;        ///< > 0
    unsigned frames = 300;  ///< > 0
    double orbit = 0;       ///< degrees by which the camera turns round its target over all frames
    bool picks_builder = true;
};

/// Chooses the samples per pixel so that a frame takes at most 1 / fps, and renders the frames. `config.spp` and
/// `config.max_depth` are upper limits. If one sample per pixel takes too long, measures shorter paths, smaller images
/// and approximations, and chooses that of the least error. `progress` is called after every frame; return false to
/// stop. Throws ErrorKind::user, naming the closest rate, if the rate cannot be reached.
[[nodiscard]] FramesReport render_frames(const Device& device, const Scene& scene, const RenderConfig& config,
                                         const FramesConfig& frames,
                                         const std::function<bool(unsigned done)>& progress = {},
                                         const MeasuringProgress& measuring = {});

/// Returns whether the error target, or else the time target, was met.
[[nodiscard]] bool is_kept(const TargetPlan& plan, const RenderProgress& reached);
/// Returns one line that compares the result with the target.
[[nodiscard]] std::string account_of(const TargetPlan& plan, const RenderProgress& reached);

}  // namespace claray
#pragma GCC visibility pop
