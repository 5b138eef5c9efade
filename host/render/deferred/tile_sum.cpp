#include "host/render/deferred/tile_sum.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr unsigned tile_group = 64;  // GROUP_SIZE of the kernels

std::uint32_t rounded_up(std::uint32_t value, std::uint32_t unit) { return (value + unit - 1) / unit; }

/// Lights without extent; the lists of lights begin with emissive triangles and end with the environment.
std::uint32_t punctual_lights(const LightsData& lights) {
    return lights.count - lights.triangles - (lights.environment.width != 0 ? 1 : 0);
}

TileGrid tiles_of(const Step& step, std::uint32_t most_per_tile, std::uint32_t most_per_block) {
    const std::uint32_t width = step.frame.width, first = step.batch.first_pixel / width;
    const std::uint32_t end = rounded_up(step.batch.first_pixel + step.batch.pixels, width);
    TileGrid grid{};
    grid.first_row = first;
    grid.columns = rounded_up(width, CLARAY_TILE), grid.rows = rounded_up(end - first, CLARAY_TILE);
    grid.block_columns = rounded_up(grid.columns, CLARAY_TILE_BLOCK),
    grid.block_rows = rounded_up(grid.rows, CLARAY_TILE_BLOCK);
    grid.lights = punctual_lights(step.frame.lights);
    grid.tile_room = std::min(grid.lights, most_per_tile), grid.block_room = std::min(grid.lights, most_per_block);
    return grid;
}

std::uint32_t tile_count(const TileGrid& grid) { return grid.columns * grid.rows; }
std::uint32_t block_count(const TileGrid& grid) { return grid.block_columns * grid.block_rows; }

}  // namespace

TileSum::TileSum(const SceneBuffers& scene, const Defines& shading, bool everywhere)
    : device_(scene.structure.device()),
      most_per_tile_(everywhere ? 0 : device_.tuning("deferred/list_lights", "MOST_PER_TILE")),
      most_per_block_(everywhere ? 0 : device_.tuning("deferred/list_lights", "MOST_PER_BLOCK")),
      bound_(load_kernel(device_, "deferred/bound_tiles.cl", "bound_tiles", scene.structure.defines())),
      list_(load_kernel(device_, "deferred/list_lights.cl", "list_lights",
                        {{"GROUP_SIZE", device_.info().type == DeviceType::cpu ? "1" : std::to_string(tile_group)}})),
      sum_(load_kernel(device_, "deferred/sum_lights.cl", "sum_lights", shading)) {}

void TileSum::make_room(const TileGrid& grid) {
    boxes_.reserve(device_, tile_count(grid));
    lists_.reserve(device_, std::size_t(tile_count(grid)) * (grid.tile_room + 1));
    block_lists_.reserve(device_, std::size_t(block_count(grid)) * (grid.block_room + 1));
}

void TileSum::run(const Step& step, const SceneBuffers& scene, const Buffer<Ray>& rays, const Buffer<RayQueue>& queue,
                  const SceneHits& hits, const Buffer<float>& radiance) {
    const TileGrid grid = tiles_of(step, most_per_tile_, most_per_block_);
    const bool cpu = device_.info().type == DeviceType::cpu;
    const std::uint32_t tiles = tile_count(grid), where = grid.lights > 0 ? scene.where.punctual_lights : 0;
    make_room(grid);
    const auto range = [&](std::uint32_t lists) {
        return cpu ? Range{lists, 1} : Range{lists * tile_group, tile_group};
    };
    bound_.run(range(tiles), step, grid, rays, hits, boxes_);
    for (const bool of_blocks : {true, false})
        list_.run(range(of_blocks ? block_count(grid) : tiles), grid, std::uint32_t(of_blocks),
                  arg("tables", scene.tables), where, boxes_, arg("block_lists", block_lists_),
                  arg("lists", of_blocks ? block_lists_ : lists_));
    const std::uint32_t paths = tiles * CLARAY_TILE * CLARAY_TILE * step.batch.samples;
    sum_.run(cpu ? Range{tiles, 1} : Range{paths, tile_group}, step, scene, grid, arg("block_lists", block_lists_),
             arg("lists", lists_), queue, hits, arg("radiance", radiance));
}

}  // namespace claray
