// `claray bench` on one device: times of builds and rays, for scenes x presets x kinds of rays.
#pragma once

#include "claray/bvh.hpp"
#include "host/measure/measure.hpp"
#include "host/measure/rays.hpp"

namespace claray::measure {

struct BenchOptions {
    std::vector<std::string> scenes;
    std::vector<Builder> presets;
    Layout layout = Layout::automatic;
    unsigned width = 320, height = 180;  ///< of each of three views; scenes with recorded rays bring their own
    int repeat = 9;                      ///< rounds that count
};

/// One way to build, and the times to trace with its tree.
struct PresetResult {
    std::string preset, layout;
    Timing build, refit;
    BvhStatistics statistics;
    struct Kind {
        std::string name;  ///< "primary", "shadow" (any hit), "bounce", "random" (primary and bounce in random order)
        std::size_t rays = 0;
        Timing timing;
        [[nodiscard]] double mrays_per_second() const;
    };
    std::vector<Kind> kinds;

    [[nodiscard]] double mtriangles_per_second() const;
};

struct SceneResult {
    std::string scene;
    std::size_t triangles = 0;
    std::vector<PresetResult> presets;
};

/// The trees of a scene by all presets, and its rays, on a device.
class SceneBench {
public:
    /// Throws ErrorKind::device if two presets disagree about a hit.
    SceneBench(const Device& device, const std::string& scene, const BenchOptions& options);
    /// Times builds, refits and rays of all presets in interleaved rounds.
    [[nodiscard]] SceneResult run();

private:
    Device device_;
    std::string scene_;
    BenchOptions options_;
    std::vector<DeviceRays> kinds_;
    std::vector<Bvh> bvhs_;
};

/// Runs all at the same time, so that devices share memory, host and power. A device that is done goes on until all
/// are.
[[nodiscard]] std::vector<SceneResult> run_at_once(std::vector<SceneBench>& benches);

/// Rays per second of several devices with the tree of one preset.
struct JointResult {
    std::string preset;
    struct Kind {
        std::string name;
        double mrays_per_second = 0;  ///< of all devices at the same time
        double share = 0;             ///< of the sum of what each reaches alone
    };
    std::vector<Kind> kinds;
};
/// One for each preset. `alone` and `at_once`: of one scene, by device.
[[nodiscard]] std::vector<JointResult> joint_results(const std::vector<SceneResult>& alone,
                                                     const std::vector<SceneResult>& at_once);

/// Milliseconds to build and then trace `rays` rays, from the median times of building and of tracing.
[[nodiscard]] double build_and_trace(const PresetResult& preset, std::size_t kind, double rays);

/// From how many rays on the next preset is the quickest to build and trace together.
struct Winner {
    std::string preset;
    double from_rays = 0;
};
/// The quickest presets in the order of the number of rays, from 0 on.
[[nodiscard]] std::vector<Winner> quickest_presets(const SceneResult& scene, std::size_t kind);

/// The numbers of rays in tables of build and trace together.
inline constexpr double ray_counts[] = {1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

/// One line a measurement, see docs/formats.md; with or without the line that names the columns.
[[nodiscard]] std::string bench_csv_header();
[[nodiscard]] std::string bench_csv(const DeviceInfo& device, const SceneResult& scene);

}  // namespace claray::measure
