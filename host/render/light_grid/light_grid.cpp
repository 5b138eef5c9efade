#include "host/render/light_grid/light_grid.hpp"

#include <algorithm>
#include <cmath>

#include "host/render/light_grid/grid_rays.hpp"

namespace claray {
namespace {

constexpr float inset = 0.05f;  // of a step: the outermost probes lie so far within the bounds of the scene
constexpr float finer = 4;      // steps of a level, in steps of the next finer one
constexpr float rim = 1.25f;    // steps between a level's end and its outermost probes, as surfaces look up beside them
constexpr unsigned updates_before = 4;  // that count of a grid whose scene changed
constexpr unsigned updates_after = 3;   // the updates that it needs, as a multiple, until it has forgotten
constexpr float memory = 3;             // rounds that count as much as the newest one, as a share of all rounds

std::uint32_t cubed(std::uint32_t side) { return side * side * side; }

/// Of a level's data, in words.
std::uint32_t words_of_cells(std::uint32_t side) { return cubed(side) * CLARAY_GRID_WORDS; }
std::uint32_t words_of_probes(const LightGridConfig& config) { return cubed(config.side) * config.coefficients * 4; }

std::vector<glm::vec3> steps_of_levels(const LightGridConfig& config, const Bounds& scene) {
    const glm::vec3 extent = scene.extent();
    const float longest = std::max({extent.x, extent.y, extent.z, 1e-30f});
    glm::vec3 step = glm::max(extent, longest * 1e-3f) / (float(config.side - 1) + 2 * inset);
    std::vector<glm::vec3> steps(config.levels);
    for (auto level = steps.rbegin(); level != steps.rend(); ++level, step /= finer) *level = step;
    return steps;
}

std::uint32_t modulo(std::int64_t value, std::uint32_t side) { return std::uint32_t((value % side + side) % side); }

/// The items of a cube of `side` that enter it when it moves by `shift` along each axis: at most one slab per axis.
std::vector<GridBox> entering(std::uint32_t level, std::uint32_t side, const std::array<std::int64_t, 3>& shift) {
    std::array<std::uint32_t, 3> first{}, count{side, side, side};
    std::vector<GridBox> boxes;
    for (int axis = 0; axis < 3; ++axis) {
        const auto moved = std::uint32_t(std::min<std::int64_t>(std::abs(shift[axis]), side));
        if (moved == 0) continue;
        auto slab_first = first, slab_count = count;
        slab_first[axis] = shift[axis] > 0 ? side - moved : 0, slab_count[axis] = moved;
        boxes.push_back(
            {level, slab_first[0], slab_first[1], slab_first[2], slab_count[0], slab_count[1], slab_count[2]});
        if (shift[axis] < 0) first[axis] = moved;
        count[axis] = side - moved;
        if (moved == side) break;
    }
    return boxes;
}

}  // namespace

KernelsOf<LightGridKernels> LightGridKernels::requests(const Defines& generate, const Defines& shade) {
    using Grid = LightGridKernels;
    return {{&Grid::aim_probes, {"light_grid/aim_probes.cl", "aim_probes", generate}},
            {&Grid::gather_probes, {"light_grid/gather_probes.cl", "gather_probes", generate}},
            {&Grid::aim_cells, {"light_grid/aim_cells.cl", "aim_cells", generate}},
            {&Grid::mark_cells, {"light_grid/mark_cells.cl", "mark_cells", shade}},
            {&Grid::aim_voxels, {"light_grid/aim_voxels.cl", "aim_voxels", generate}},
            {&Grid::gather_voxels, {"light_grid/gather_voxels.cl", "gather_voxels", shade}},
            {&Grid::show_voxels, {"light_grid/show_voxels.cl", "show_voxels", generate}}};
}

LightGridStage::LightGridStage(const LightGridConfig& config, const Bounds& scene)
    : config_(config), scene_(scene), wanted_(config.updates) {
    if (config.voxels) config_.coefficients = 4;
    const std::vector<glm::vec3> steps = steps_of_levels(config_, scene);
    std::uint32_t at = config.levels * CLARAY_GRID_HEADER;
    for (const glm::vec3& step : steps) {
        LightGrid level{};
        level.step_x = step.x, level.step_y = step.y, level.step_z = step.z;
        level.side = config_.side, level.coefficients = config_.coefficients, level.voxels = config_.voxels;
        level.levels = config.levels, level.gather = config.gather;
        level.reach = levels_.size() + 1 < config.levels ? float(config.side) / 2 - rim : 0.f;
        level.seen = at, at += words_of_cells(config.side);
        level.probes = at, at += words_of_probes(config_);
        levels_.push_back({level, std::nullopt});
    }
}

std::uint32_t LightGridStage::words() const {
    return config_.levels * (CLARAY_GRID_HEADER + words_of_cells(config_.side) + words_of_probes(config_));
}

void LightGridStage::scene_changed(bool surfaces) {
    updates_ = surfaces && config_.voxels ? 0 : std::min(updates_, updates_before);
    wanted_ = updates_after * config_.updates;
    if (!surfaces) return;
    for (Level& level : levels_) level.first.reset();
}

/// Places the level around the viewer, at a whole number of steps, or around the scene.
void LightGridStage::move(Level& level, const glm::vec3& viewer) {
    LightGrid& grid = level.data;
    const glm::vec3 step(grid.step_x, grid.step_y, grid.step_z);
    const glm::vec3 origin = scene_.lo + inset * step;
    Cell first{};
    if (grid.reach > 0)
        for (int axis = 0; axis < 3; ++axis)
            first[axis] = std::int64_t(std::floor((viewer[axis] - origin[axis]) / step[axis])) - grid.side / 2 + 1;
    const glm::vec3 corner = origin + step * glm::vec3(first[0], first[1], first[2]);
    grid.x = corner.x, grid.y = corner.y, grid.z = corner.z;
    grid.first_x = modulo(first[0], grid.side), grid.first_y = modulo(first[1], grid.side);
    grid.first_z = modulo(first[2], grid.side);
    grid.center_x = viewer.x, grid.center_y = viewer.y, grid.center_z = viewer.z;
    level.first = first;
}

/// Follows the viewer: only what enters a level is filled.
void LightGridStage::follow(const glm::vec3& viewer, Wavefront& wavefront) {
    const std::uint32_t side = config_.side;
    for (std::uint32_t i = 0; i < levels_.size(); ++i) {
        Level& level = levels_[i];
        const std::optional<Cell> before = level.first;
        move(level, viewer);
        wavefront.scene.write_light_grid(i, level.data);
        if (!before) {
            if (!config_.voxels) mark_cells(wavefront, {i, 0, 0, 0, side - 1, side - 1, side - 1});
            continue;
        }
        const Cell now = *level.first, shift{now[0] - (*before)[0], now[1] - (*before)[1], now[2] - (*before)[2]};
        if (!config_.voxels)
            for (const GridBox& cells : entering(i, side - 1, shift)) mark_cells(wavefront, cells);
        for (const GridBox& probes : entering(i, side, shift))
            for (unsigned round = 0; round < config_.updates; ++round) gather(probes, round, wavefront);
    }
    do
        if (updates_ < wanted_) update(wavefront);
    while (!filled_ && updates_ < wanted_);
    filled_ = true;
}

void LightGridStage::update(Wavefront& wavefront) {
    for (std::uint32_t i = 0; i < levels_.size(); ++i)
        gather({i, 0, 0, 0, config_.side, config_.side, config_.side}, updates_, wavefront);
    ++updates_;
}

/// The first rounds lack the light of many bounces; their weight falls with the cube of the number of rounds.
void LightGridStage::gather(const GridBox& probes, unsigned round, Wavefront& wavefront) {
    const std::uint32_t rays = config_.voxels ? 1 : config_.rays;
    const ProbeRays with{rays, round_++, float(rays * round) / memory};
    config_.voxels ? gather_voxels(wavefront, probes, with) : gather_probes(wavefront, probes, with);
}

}  // namespace claray
