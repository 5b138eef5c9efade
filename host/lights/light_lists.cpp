#include "host/lights/light_lists.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

#include "claray/mesh.hpp"
#include "host/lights/lights.hpp"

namespace claray {
namespace {

constexpr float cell_of_range = 0.4f;  // length of a cell, of the lights' median range
constexpr float most_cells = 1 << 18;
constexpr float most_along = 1023;         // cells along an axis, less one
constexpr std::size_t most_asked = 24;     // about, of the lists that tell their mean length
constexpr double most_repeated = 1 << 22;  // entries of lights without a range, which are in every list
constexpr float margin = 1e-4f;            // of a cell's length and of a range, against rounding

struct Sphere {
    glm::vec3 center;
    float radius;
};

constexpr float farthest = 4e18f;  // from one place to another: coordinates end at 1e18

/// Where a light with a range arrives.
Sphere reach_of(const PunctualLight& light) {
    return {{light.x, light.y, light.z}, std::min((1 + margin) * range_of(light), farthest)};
}

bool is_limited(const PunctualLight& light) { return range_of(light) > 0; }

/// Whether the sphere reaches the box.
bool touches(const Sphere& sphere, const Bounds& box) {
    const glm::vec3 off = glm::max(glm::max(box.lo - sphere.center, sphere.center - box.hi), glm::vec3(0.f));
    return glm::dot(off, off) <= sphere.radius * sphere.radius;
}

/// Whether the light's cone may reach the sphere: beside its border, in the plane through both axes.
bool shines_into(const PunctualLight& light, const Sphere& sphere) {
    if (!(light.cone_scale > 0)) return true;
    const float cosine = -light.cone_offset / light.cone_scale, sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
    const glm::vec3 towards = sphere.center - glm::vec3(light.x, light.y, light.z);
    const float along = glm::dot(towards, glm::vec3(light.direction_x, light.direction_y, light.direction_z));
    const float beside = std::sqrt(std::max(0.f, glm::dot(towards, towards) - along * along));
    return beside * cosine - along * sine <= sphere.radius && along >= -sphere.radius;
}

LightLists grid_over(std::span<const PunctualLight> lights) {
    Bounds bounds;
    std::vector<float> ranges;
    for (const PunctualLight& light : lights) {
        if (!is_limited(light)) continue;
        const Sphere reach = reach_of(light);
        bounds.grow(reach.center - reach.radius), bounds.grow(reach.center + reach.radius);
        ranges.push_back(reach.radius);
    }
    if (ranges.empty()) return {0, 0, 0, 0, 0, 0, 0, std::uint32_t(lights.size())};
    const auto median = ranges.begin() + std::ptrdiff_t(ranges.size() / 2);
    std::nth_element(ranges.begin(), median, ranges.end());
    const glm::vec3 extent = bounds.extent();
    const double volume = double(extent.x) * extent.y * extent.z;
    const float longest = std::max({extent.x, extent.y, extent.z});
    const float cell =
        std::max({cell_of_range * *median, float(std::cbrt(volume / most_cells)), longest / most_along, 1e-37f});
    const auto cells = [&](float length) { return std::uint32_t(std::clamp(length / cell, 1.f, most_along)) + 1; };
    return {bounds.lo.x,     bounds.lo.y,     bounds.lo.z,     1 / cell,
            cells(extent.x), cells(extent.y), cells(extent.z), std::uint32_t(lights.size())};
}

glm::vec3 corner_of(const LightLists& grid) { return {grid.x, grid.y, grid.z}; }

/// The nearest cell.
glm::uvec3 cell_at(const LightLists& grid, const glm::vec3& point) {
    const glm::uvec3 last = glm::uvec3(grid.width, grid.height, grid.depth) - 1u;
    return glm::uvec3(glm::clamp((point - corner_of(grid)) * grid.cells_per_length, glm::vec3(0.f), glm::vec3(last)));
}

std::size_t cell_number(const LightLists& grid, const glm::uvec3& cell) {
    return (std::size_t(cell.z) * grid.height + cell.y) * grid.width + cell.x;
}

/// A cell, and what rounding may count to it.
Bounds box_of(const LightLists& grid, const glm::uvec3& cell) {
    const float length = 1 / grid.cells_per_length, wide = length * margin;
    const glm::vec3 at = corner_of(grid) + glm::vec3(cell) * length;
    return {at - wide, at + length + wide};
}

bool reaches(const PunctualLight& light, const Bounds& box) {
    return touches(reach_of(light), box) && shines_into(light, {box.center(), 0.5f * glm::length(box.extent())});
}

std::size_t cells_of(const LightLists& grid) { return std::size_t(grid.width) * grid.height * grid.depth; }

/// Calls `visit(cell)` for every cell that the light may reach; the last number is that of what is outside the grid.
template <class Visit>
void visit_cells(const LightLists& grid, const PunctualLight& light, const Visit& visit) {
    if (!is_limited(light)) {
        for (std::size_t cell = 0; cell <= cells_of(grid); ++cell) visit(cell);
        return;
    }
    const Sphere reach = reach_of(light);
    const float wide = margin / grid.cells_per_length;
    const glm::uvec3 lo = cell_at(grid, reach.center - reach.radius - wide);
    const glm::uvec3 hi = cell_at(grid, reach.center + reach.radius + wide);
    for (std::uint32_t z = lo.z; z <= hi.z; ++z)
        for (std::uint32_t y = lo.y; y <= hi.y; ++y)
            for (std::uint32_t x = lo.x; x <= hi.x; ++x)
                if (reaches(light, box_of(grid, {x, y, z}))) visit(cell_number(grid, {x, y, z}));
}

constexpr std::size_t header_words = sizeof(LightLists) / sizeof(std::uint32_t);

}  // namespace

std::vector<std::uint32_t> build_light_lists(std::span<const PunctualLight> lights) {
    const LightLists grid = grid_over(lights);
    const std::size_t cells = cells_of(grid) + 1;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // cell and light
    for (std::uint32_t i = 0; i < lights.size(); ++i)
        visit_cells(grid, lights[i], [&](std::size_t cell) { entries.emplace_back(std::uint32_t(cell), i); });
    std::vector<std::uint32_t> words(header_words + cells + 1 + entries.size());
    std::memcpy(words.data(), &grid, sizeof grid);
    std::uint32_t* const starts = &words[header_words];
    for (const auto& [cell, light] : entries) ++starts[cell + 1];
    for (std::size_t cell = 0; cell < cells; ++cell) starts[cell + 1] += starts[cell];
    std::uint32_t* const lists = starts + cells + 1;
    std::vector<std::uint32_t> next(starts, starts + cells);
    for (const auto& [cell, light] : entries) lists[next[cell]++] = light;
    return words;
}

double mean_list_length(std::span<const PunctualLight> lights) {
    const LightLists grid = grid_over(lights);
    std::vector<PunctualLight> limited;
    std::copy_if(lights.begin(), lights.end(), std::back_inserter(limited), is_limited);
    const std::size_t unlimited = lights.size() - limited.size();
    if (double(unlimited) * double(cells_of(grid) + 1) > most_repeated) return std::numeric_limits<double>::infinity();
    const std::size_t step = std::max<std::size_t>(1, limited.size() / most_asked);
    double entries = 0, lists = 0;
    for (std::size_t i = 0; i < limited.size(); i += step, ++lists) {
        const Bounds box = box_of(grid, cell_at(grid, {limited[i].x, limited[i].y, limited[i].z}));
        for (const PunctualLight& light : limited) entries += reaches(light, box);
    }
    return double(unlimited) + (lists > 0 ? entries / lists : 0);
}

}  // namespace claray
