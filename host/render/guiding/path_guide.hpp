// Path guiding on the host: what paths have found becomes maps by which later paths choose directions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "claray/buffer.hpp"
#include "claray/mesh.hpp"
#include "claray/renderer.hpp"
#include "claray/shared/path.h"
#include "host/render/wavefront/wavefront.hpp"

namespace claray {

/// The first samples of each pixel, which are not guided.
constexpr unsigned unguided_spp = 8;
/// The first samples of each pixel, from which the maps for all later ones learn.
constexpr unsigned teaching_spp = 16;

/// Returns whether kernels can guide paths: the device is set to do so, and the approximations permit it.
[[nodiscard]] bool may_guide_paths(const Device& device, const RenderConfig& config);

/// The maps of all cells, CLARAY_GUIDE_WORDS each, from the bins of all maps, CLARAY_GUIDE_FOLDS times. A map is
/// proportional to the root of the mean squared light (Rath et al. 2020, "Variance-aware path guiding"), and in part
/// uniform. Where too little is known it is uniform.
[[nodiscard]] std::vector<std::uint32_t> guide_maps(std::span<const GuideBin> found);
/// The probabilities of a map's bins, times 2^32. Their sum is 2^32.
[[nodiscard]] std::vector<std::uint64_t> shares_of_bins(std::span<const std::uint32_t> map);

/// What guiding promises for samples from which the maps did not learn: sums of the squares of what directions add to
/// the image.
struct GuideTrial {
    double without = 0, with = 0;
    double variance = 0;                 ///< of the difference, if maps are independent
    double longer = 0, longer_with = 0;  ///< paths that go on after the next surface
    [[nodiscard]] double gain() const { return with > 0 ? without / with : 1; }
    /// Less the standard error: a gain that a few maps have alone may be luck.
    [[nodiscard]] double least_gain() const { return with > 0 ? (without - std::sqrt(variance)) / with : 1; }
    /// Rays per path with over without, about.
    [[nodiscard]] double cost() const { return longer > 0 ? longer_with / longer : 1; }
    /// In efficiency. Paths that leave the scene earlier promise nothing: guided sampling takes about the time they
    /// save.
    [[nodiscard]] double promise() const { return least_gain() / std::max(1.0, cost()); }
};
/// Tries maps of all folds but one on this one, for each fold.
[[nodiscard]] GuideTrial try_guiding(std::span<const GuideBin> found);

/// Learns from samples 2 to 15 of each pixel, or of some pixels of a large image. After 8 samples the maps are tried on
/// samples from which they did not learn; where they pay, later samples are guided by them, and those after 16 by
/// better ones. So a sample depends on its pixel and number only: not on batches, on their order, on how many samples
/// follow, nor on other devices that share the image. A device that did not trace the samples that teach the
/// maps traces them again.
class PathGuide {
public:
    PathGuide(const Device& device, const Bounds& scene, std::uint32_t pixels);
    [[nodiscard]] static KernelSet programs(const Device& device);
    /// Whether guiding is wanted, and the image has enough pixels to teach it.
    [[nodiscard]] static bool is_for(const RenderConfig& config);

    /// Traces a batch of an image of `spp` samples per pixel by the maps for its samples, and calls `add` for each
    /// part. Learns only what later samples of the image need.
    void trace(Batch batch, unsigned spp, Wavefront& wavefront, const std::function<void(const Batch&)>& add);
    /// The same for a listed batch of some of the image's pixels. The whole image teaches, in samples of its own.
    void trace_region(Batch batch, Wavefront& wavefront, const std::function<void(const Batch&)>& add);
    /// The same with the maps that are known, without learning.
    void trace_beside(Batch batch, Wavefront& wavefront, const std::function<void(const Batch&)>& add);
    /// Whether it guides samples, by what it has learnt so far.
    [[nodiscard]] bool guides() const {
        return std::any_of(maps_.begin(), maps_.end(), [](const auto& maps) { return !maps.empty(); });
    }
    /// For an image that begins anew, of the same scene and size.
    void forget();
    [[nodiscard]] std::uint64_t bytes() const { return found_.bytes() + counts_.bytes(); }

private:
    /// Samples of the same maps. Each but the last teaches those after it.
    enum Phase : unsigned { unit_phase, unguided_phase, first_phase, last_phase };
    static constexpr std::array<std::uint32_t, 4> ends = {2, unguided_spp, teaching_spp, ~std::uint32_t(0)};
    [[nodiscard]] static Phase phase_at(std::uint32_t sample);
    [[nodiscard]] static Phase phase_of(const Batch& batch);
    [[nodiscard]] static bool pays_to_teach(Phase phase, unsigned spp);
    /// Where the batches that teach go on: in the image, in the order of passes.
    struct Cursor {
        std::uint32_t sample = 0, pass = 0, pixel = 0;
    };

    void trace_part(const Batch& part, unsigned spp, Wavefront& wavefront);
    [[nodiscard]] std::uint32_t first_sample() const;  ///< of this phase
    [[nodiscard]] bool follows(const Batch& part) const;
    void advance(const Batch& part);
    void learn(const Batch& part, const Wavefront& wavefront);
    void learn_until(Phase phase, Wavefront& wavefront);
    void trace_runs(std::uint32_t first_sample, std::uint32_t samples, Wavefront& wavefront);
    void end_phase();
    [[nodiscard]] bool tell_unit();
    [[nodiscard]] bool pays(std::span<const GuideBin> found) const;
    [[nodiscard]] PathGuideData data_for(Phase phase, bool teaches, SceneBuffers& scene);

    Device device_;
    std::uint32_t pixels_, every_;  // runs of pixels, of which one teaches
    PathGuideData data_{};
    Phase phase_ = unit_phase;  // that the next batch teaches
    Cursor cursor_;
    std::array<std::vector<std::uint32_t>, 4> maps_;  // of each phase; empty: its samples are not guided
    Phase on_device_ = unit_phase;                    // the phase whose maps the device has
    Buffer<GuideBin> found_;
    Buffer<std::uint32_t> counts_;
};

}  // namespace claray
