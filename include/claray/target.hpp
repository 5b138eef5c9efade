// Choosing by target: an error, a time or frames a second instead of settings, which a planner picks by the measured
// model of the device.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "claray/renderer.hpp"

namespace claray {

/// How fast a device builds trees and renders, by preset of the builder.
struct DeviceModel {
    struct Preset {
        double build_nanoseconds = 0;   ///< a triangle
        double samples_per_second = 0;  ///< of the model's scene
    };
    Preset fast, balanced, high;
    double independent_cost = 0;  ///< time that independent samples take for the error that Sobol's take 1 for

    [[nodiscard]] const Preset& of(Builder builder) const;
    [[nodiscard]] bool known() const { return fast.samples_per_second > 0; }
};

/// What `claray tune` stored for this device: rows of the tuning table; not `known()` where it never ran.
[[nodiscard]] DeviceModel stored_model(const Device& device);
/// Told what is measured next of a device; false ends the measuring, and nothing is known then.
using MeasuringProgress = std::function<bool(const std::string& what)>;
/// Measures it, over a terrain of so many triangles: a few seconds, and what compiling takes. Leaves the device's
/// profiler with what it ran.
[[nodiscard]] DeviceModel measure_model(const Device& device, std::size_t triangles = 100'000,
                                        const MeasuringProgress& progress = {});
/// The model as rows of the tuning table.
struct ModelRow {
    std::string kernel, parameter;
    unsigned value = 0;
};
[[nodiscard]] std::vector<ModelRow> rows_of(const DeviceModel& model);

/// The preset with which a tree over so many triangles is built and what takes so many seconds with `fast` is traced
/// soonest; `built` is there already. `fast` where nothing is known.
[[nodiscard]] Builder choose_builder(const DeviceModel& model, std::size_t triangles, double seconds_with_fast,
                                     Builder built = Builder::fast);

/// What a planner picked for RenderConfig::error or RenderConfig::seconds.
struct TargetPlan {
    RenderConfig config;  ///< as it was given, with what was picked
    DeviceModel model;
    std::size_t triangles = 0;
    bool picks_builder = true;        ///< false: it is as it was given
    std::vector<std::string> picks;   ///< what was picked and why, a line each
    double promised_seconds = 0;      ///< of sampling, as foreseen after the first samples of a render to an error
    double seconds_to_foresee = 0.3;  ///< for which these are watched
    MeasuringProgress measuring;      ///< where the device itself must be measured on the way
};

/// Picks sampler and builder for a render to an error or for a time. Where there is no model of the device and the
/// time is worth it, measures one, small, first.
[[nodiscard]] TargetPlan plan_render(const Device& device, const Scene& scene, const RenderConfig& config,
                                     bool picks_builder = true, const MeasuringProgress& measuring = {});

/// Renders to the target; `renderer` was made with `plan.config`. After the first samples it is known how long it takes
/// to an error, and the tree may be built anew. `progress` as in Renderer::render. Throws ErrorKind::user, naming the
/// closest that can be reached, for a time that can't be, and for an error that can't be where there is no limit of
/// time.
RenderProgress render_to_target(const Device& device, Renderer& renderer, TargetPlan& plan,
                                const std::function<bool(const RenderProgress&)>& progress = {});

/// Frames at a rate: each a render of its own of so many samples a pixel, from the first sample until its image is in
/// the host's memory.
struct FramesReport {
    unsigned spp = 0,
             max_depth = 0;  ///< that were picked: `max_depth` is lowered only where a sample a pixel is too many
    std::vector<std::string> picks;     ///< what was picked and why, a line each
    std::vector<double> seconds;        ///< that frames took
    double median = 0, percentile = 0;  ///< of them; the 99th
    std::vector<glm::vec3> image;       ///< the last one
};

/// Picks the samples a pixel with which frames take no longer than 1 / fps, and renders so many. `config.spp` and
/// `config.max_depth` are the most that may be picked. `progress` is asked after every frame whether to go on. Throws
/// ErrorKind::user, naming the closest rate, where it can't be reached.
[[nodiscard]] FramesReport render_frames(const Device& device, const Scene& scene, const RenderConfig& config,
                                         double fps, unsigned frames, bool picks_builder = true,
                                         const std::function<bool(unsigned done)>& progress = {},
                                         const MeasuringProgress& measuring = {});

/// Whether the error, or else the time, is what was asked for.
[[nodiscard]] bool is_kept(const TargetPlan& plan, const RenderProgress& reached);
/// What was reached against what was asked for, in a line.
[[nodiscard]] std::string account_of(const TargetPlan& plan, const RenderProgress& reached);

}  // namespace claray
