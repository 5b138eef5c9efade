// Approximations::light_grid: the light of all other surfaces, kept in grids of probes (kernels/light_grid) and looked
// up where paths meet diffuse surfaces (kernels/lights/light_grid.clh).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "claray/renderer.hpp"
#include "claray/shared/light_grid.h"
#include "host/render/scene_buffers.hpp"

namespace claray {

struct Wavefront;

/// The kernels that fill the grid.
struct LightGridKernels {
    /// With the defines of the stages that generate rays, and of those that shade.
    [[nodiscard]] static KernelsOf<LightGridKernels> requests(const Defines& generate, const Defines& shade);

    Kernel aim_probes, gather_probes;  // light
    Kernel aim_cells, mark_cells;      // what the parts of cells see
    Kernel aim_voxels, gather_voxels, show_voxels;
};

/// Fills the grid and keeps it up to date. The probes' light does not depend on the camera, the image's size or its
/// seed, except for levels that follow the viewer.
class LightGridStage {
public:
    LightGridStage(const LightGridConfig& config, const Bounds& scene);

    /// Size of its table, in words.
    [[nodiscard]] std::uint32_t words() const;
    /// The light of the scene changed, and its surfaces if `surfaces`.
    void scene_changed(bool surfaces);
    /// Brings the grid up to date for a viewer at this place: all at once the first time, later one update per call.
    void follow(const glm::vec3& viewer, Wavefront& wavefront);

private:
    using Cell = std::array<std::int64_t, 3>;
    struct Level {
        LightGrid data{};
        std::optional<Cell> first;  // number of the first probe; empty: the level must be filled
    };
    void move(Level& level, const glm::vec3& viewer);
    void update(Wavefront& wavefront);
    void gather(const GridBox& probes, unsigned round, Wavefront& wavefront);

    LightGridConfig config_;
    Bounds scene_;
    std::vector<Level> levels_;  // from fine to coarse
    unsigned updates_ = 0;       // rounds of rays since the light changed
    unsigned wanted_;
    bool filled_ = false;
    std::uint32_t round_ = 0;  // number of all rounds, for the samples of the rays
};

/// Paths that a round traces at once, for any image, so that probes hold the same light for all images.
inline constexpr std::uint32_t light_grid_paths = 1u << 18;

}  // namespace claray
