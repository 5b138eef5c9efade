// Path guiding on the host: what paths have found becomes maps by which later paths choose directions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "claray/buffer.hpp"
#include "claray/mesh.hpp"
#include "claray/renderer.hpp"
#include "claray/shared/path.h"
#include "host/render/scene_buffers.hpp"

namespace claray {

/// Renders with fewer samples per pixel are not guided: learning would not pay.
constexpr unsigned least_guided_spp = 32;
/// Per pixel, which tell the unit of light.
constexpr unsigned samples_before_learning = 2;

/// Returns whether guiding is asked for, the device is set to guide paths, and the approximations permit it.
[[nodiscard]] bool may_guide_paths(const Device& device, const RenderConfig& config);

/// The maps of all cells, CLARAY_GUIDE_WORDS each, from the bins of all maps. A map is proportional to the root of the
/// mean squared light (Rath et al. 2020, "Variance-aware path guiding"), and in part uniform. Where too little is known
/// it is uniform.
[[nodiscard]] std::vector<std::uint32_t> guide_maps(std::span<const GuideBin> bins);
/// The probabilities of a map's bins, times 2^32. Their sum is 2^32.
[[nodiscard]] std::vector<std::uint64_t> shares_of_bins(std::span<const std::uint32_t> map);
/// Mean squared light of the bins without over with the maps: how much less noise later paths have in one sample of
/// their directions. 1 if there is no light.
[[nodiscard]] double gain_of(std::span<const std::uint32_t> maps, std::span<const GuideBin> bins);

/// Learns from samples 2 to 15 of each pixel. Whether the maps pay is decided after 8, by samples from which they did
/// not learn: if not, the image is the same as without guiding. All depends on whole passes only, not on batches or
/// time.
class PathGuide {
public:
    PathGuide(const Device& device, const Bounds& scene);
    /// So that none is compiled during a render.
    static void load_kernels(const Device& device);

    [[nodiscard]] const PathGuideData& data() const { return data_; }
    /// Learns from a batch that was traced by `data()`; asynchronous. `step`: of the batch.
    void learn(const Step& step, const Buffer<float>& radiance);
    /// To be called between passes. `mean`: returns the image's mean luminance so far. `floats_of_paths`: see
    /// Wavefront. Blocks if the maps change.
    template <class Mean>
    void advance(unsigned samples, std::uint32_t floats_of_paths, SceneBuffers& scene, const Mean& mean) {
        if (data_.unit == 0 && samples >= samples_before_learning)
            begin(floats_of_paths, mean());
        else if (data_.lessons != 0)
            learned(samples, scene);
    }

private:
    void begin(std::uint32_t floats_of_paths, double mean);
    void learned(unsigned samples, SceneBuffers& scene);
    [[nodiscard]] bool promises_gain(std::span<const GuideBin> found) const;

    Device device_;
    PathGuideData data_{};
    Buffer<GuideBin> found_;     // by the samples since the last change of the maps
    std::vector<GuideBin> sum_;  // by all samples before
    Kernel learn_;
};

}  // namespace claray
