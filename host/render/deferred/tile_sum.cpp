#include "host/render/deferred/tile_sum.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr unsigned tile_group = 64;    // GROUP_SIZE of the kernels
constexpr unsigned block_group = 256;  // the same for lists of blocks, which choose among all lights

std::uint32_t units_of(std::uint32_t value, std::uint32_t unit) { return (value + unit - 1) / unit; }

/// Lights without extent; the lists of lights begin with emissive triangles and end with the environment.
std::uint32_t punctual_lights(const LightsData& lights) {
    return lights.count - lights.triangles - (lights.environment.width != 0 ? 1 : 0);
}

TileGrid tiles_of(const Step& step, std::uint32_t most_per_tile, std::uint32_t most_per_block) {
    const std::uint32_t width = step.frame.width, first = step.batch.first_pixel / width;
    const std::uint32_t end = units_of(step.batch.first_pixel + step.batch.pixels, width);
    TileGrid grid{};
    grid.first_row = first;
    grid.columns = units_of(width, CLARAY_TILE), grid.rows = units_of(end - first, CLARAY_TILE);
    grid.block_columns = units_of(grid.columns, CLARAY_TILE_BLOCK),
    grid.block_rows = units_of(grid.rows, CLARAY_TILE_BLOCK);
    grid.lights = punctual_lights(step.frame.lights);
    grid.bounds_stride = 16 * units_of(grid.lights, 16);  // CPUs read sixteen numbers at once
    grid.tile_room = std::min(grid.lights, most_per_tile), grid.block_room = std::min(grid.lights, most_per_block);
    return grid;
}

std::uint32_t tile_count(const TileGrid& grid) { return grid.columns * grid.rows; }
std::uint32_t block_count(const TileGrid& grid) { return grid.block_columns * grid.block_rows; }

/// One item for each of `count` tiles or blocks on CPUs, and one group on GPUs.
Range range_of(const Device& device, std::uint32_t count, unsigned group) {
    return device.info().type == DeviceType::cpu ? Range{count, 1} : Range{count * group, group};
}

KernelRequest lister(const Device& device, const char* name, unsigned group) {
    const bool cpu = device.info().type == DeviceType::cpu;
    return {"deferred/list_lights.cl", name, {{"GROUP_SIZE", cpu ? "1" : std::to_string(group)}}};
}

}  // namespace

TileSum::TileSum(const SceneBuffers& scene, const Defines& shading, bool everywhere)
    : device_(scene.structure.device()),
      most_per_tile_(everywhere ? 0 : device_.tuning("deferred/list_lights", "MOST_PER_TILE")),
      most_per_block_(everywhere ? 0 : device_.tuning("deferred/list_lights", "MOST_PER_BLOCK")) {
    load(device_, kernels(device_, scene.structure.format(), shading), *this);
}

KernelsOf<TileSum> TileSum::kernels(const Device& device, const StructureFormat& structure, const Defines& shading) {
    return {{&TileSum::bound_, {"deferred/bound_tiles.cl", "bound_tiles", structure.defines()}},
            {&TileSum::bound_lights_, lister(device, "bound_lights", tile_group)},
            {&TileSum::list_for_blocks_, lister(device, "list_lights", block_group)},
            {&TileSum::list_for_tiles_, lister(device, "list_lights", tile_group)},
            {&TileSum::sum_, {"deferred/sum_lights.cl", "sum_lights", shading}}};
}

void TileSum::make_room(const TileGrid& grid) {
    boxes_.reserve(device_, tile_count(grid));
    light_bounds_.reserve(device_, CLARAY_LIGHT_BOUNDS * std::size_t(grid.bounds_stride));
    lists_.reserve(device_, std::size_t(tile_count(grid)) * (grid.tile_room + 1));
    block_lists_.reserve(device_, std::size_t(block_count(grid)) * (grid.block_room + 1));
}

void TileSum::run(const Step& step, const SceneBuffers& scene, const Buffer<Ray>& rays, const Buffer<RayQueue>& queue,
                  const SceneHits& hits, const Buffer<float>& radiance) {
    const TileGrid grid = tiles_of(step, most_per_tile_, most_per_block_);
    const std::uint32_t tiles = tile_count(grid), blocks = block_count(grid);
    make_room(grid);
    bound_.run(range_of(device_, tiles, tile_group), step, grid, rays, hits, boxes_);
    if (grid.lights > 0)
        bound_lights_.run({grid.lights, 64}, arg("tables", scene.tables), scene.where.punctual_lights, grid.lights,
                          grid.bounds_stride, arg("bounds", light_bounds_));
    list_for_blocks_.run(range_of(device_, blocks, block_group), grid, 1u, arg("bounds", light_bounds_), boxes_,
                         arg("block_lists", block_lists_), arg("lists", block_lists_));
    list_for_tiles_.run(range_of(device_, tiles, tile_group), grid, 0u, arg("bounds", light_bounds_), boxes_,
                        arg("block_lists", block_lists_), arg("lists", lists_));
    const bool cpu = device_.info().type == DeviceType::cpu;
    const std::uint32_t paths = tiles * CLARAY_TILE * CLARAY_TILE * step.batch.samples;
    sum_.run(cpu ? Range{tiles, 1} : Range{paths, tile_group}, step, scene, grid, arg("block_lists", block_lists_),
             arg("lists", lists_), queue, hits, arg("radiance", radiance));
}

}  // namespace claray
