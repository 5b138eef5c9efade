// A walk with a grid of light: probes answer what light surfaces receive from each other, and finer grids follow the
// viewer.
//     example_12_light_grid [SCENE [PICTURE [FRAMES [WIDTHxHEIGHT [probes|voxels [X Y Z  X Y Z]]]]]]
// The two positions are the ends of the walk; without them it leads from the scene's camera towards its target. The
// picture is a contact sheet of all frames. The output shows by how much the light of a point changes from one frame to
// the next: grids that swim or pop would change it. Parallel rays along the walk show the same points at the same
// pixels in all frames, so that only the grids change there. A pixel does not count where the plane in which these rays
// begin cuts off a surface within it: all its 16 parts and those around must show the same points.
#include <algorithm>
#include <chrono>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

namespace {

struct Frame {
    std::vector<glm::vec3> image;
    claray::GBuffer surfaces;  // of pixels, or of their parts
};

float brightness(glm::vec3 color) { return (color.x + color.y + color.z) / 3; }

// Whether the pixels around this one show the same plane.
bool is_flat(const claray::GBuffer& surfaces, std::size_t pixel) {
    const auto w = std::ptrdiff_t(surfaces.width);
    const glm::vec3 normal = normal_of(surfaces, pixel), position = position_of(surfaces, pixel);
    for (const std::ptrdiff_t off : {std::ptrdiff_t(-1), std::ptrdiff_t(1), -w, w, -w - 1, w + 1, 1 - w, w - 1}) {
        const std::size_t beside = pixel + std::size_t(off);
        const glm::vec3 to = position_of(surfaces, beside) - position;
        const bool same = glm::dot(normal_of(surfaces, beside), normal) > 0.9999f &&
                          std::abs(glm::dot(to, normal)) < 0.01f * glm::length(to);
        if (!same) return false;
    }
    return true;
}

// The brightness at a place in pixels, between the centres of four.
float brightness_at(const Frame& frame, double x, double y) {
    const auto w = std::size_t(frame.surfaces.width);
    const auto column = std::size_t(x), row = std::size_t(y);
    const auto at = [&](std::size_t dx, std::size_t dy) {
        return brightness(frame.image[(row + dy) * w + column + dx]);
    };
    const float right = float(x - double(column)), down = float(y - double(row));
    return (at(0, 0) * (1 - right) + at(1, 0) * right) * (1 - down) +
           (at(0, 1) * (1 - right) + at(1, 1) * right) * down;
}

// Relative changes of the light of points in planes that both frames show.
std::vector<float> changes(const Frame& before, const Frame& now) {
    const glm::dmat4 image_from_world = glm::inverse(now.surfaces.world_from_image);
    const unsigned w = before.surfaces.width, h = before.surfaces.height;
    std::vector<float> found;
    for (unsigned y = 2; y + 2 < h; y += 2)
        for (unsigned x = 2; x + 2 < w; x += 2) {
            const std::size_t pixel = std::size_t(y) * w + x;
            const glm::vec3 position = position_of(before.surfaces, pixel);
            if (!(std::abs(position.x) < INFINITY) || !is_flat(before.surfaces, pixel)) continue;
            const glm::dvec4 seen = image_from_world * glm::dvec4(position, 1);
            const double column = (seen.x / seen.w + 1) / 2 * w - 0.5, row = (1 - seen.y / seen.w) / 2 * h - 0.5;
            if (!(column > 2 && row > 2 && column < w - 3 && row < h - 3)) continue;
            const std::size_t there = std::size_t(row + 0.5) * w + std::size_t(column + 0.5);
            const bool hidden = glm::dot(normal_of(now.surfaces, there), normal_of(before.surfaces, pixel)) < 0.9999f ||
                                !is_flat(now.surfaces, there) ||
                                std::abs(glm::dot(position_of(now.surfaces, there) - position,
                                                  normal_of(before.surfaces, pixel))) > 1e-3f * glm::length(position);
            const float old = brightness(before.image[pixel]);
            if (!hidden && old > 0) found.push_back(std::abs(brightness_at(now, column, row) / old - 1));
        }
    return found;
}

// Whether all parts of a pixel and those around it show the same points in both frames.
bool is_static(const Frame& before, const Frame& now, std::size_t pixel, unsigned width, float scale) {
    const std::size_t w = before.surfaces.width, h = before.surfaces.height, parts = w / width;
    const std::size_t x = pixel % width * parts, y = pixel / width * parts;
    for (std::size_t row = std::max<std::size_t>(y, 1) - 1; row < std::min(y + parts + 1, h); ++row)
        for (std::size_t column = std::max<std::size_t>(x, 1) - 1; column < std::min(x + parts + 1, w); ++column) {
            const std::size_t part = row * w + column;
            const glm::vec3 off = position_of(now.surfaces, part) - position_of(before.surfaces, part);
            if (!(glm::length(off) < 1e-3f * scale)) return false;
        }
    return true;
}

// Relative changes of such pixels.
std::vector<float> changes_of_static_pixels(const Frame& before, const Frame& now, unsigned width, float scale) {
    std::vector<float> found;
    for (std::size_t pixel = 0; pixel < before.image.size(); ++pixel) {
        const float light = brightness(before.image[pixel]);
        if (light > 0 && is_static(before, now, pixel, width, scale))
            found.push_back(std::abs(brightness(now.image[pixel]) / light - 1));
    }
    return found;
}

float percentile(std::vector<float> values, double share) {
    if (values.empty()) return 0;
    const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// Frames side by side, each a quarter as wide and as high.
void write_sheet(const std::string& path, const std::vector<std::vector<glm::vec3>>& frames, unsigned w, unsigned h) {
    const unsigned columns = 10, rows = (unsigned(frames.size()) + columns - 1) / columns, tw = w / 4, th = h / 4;
    std::vector<glm::vec3> sheet(std::size_t(columns) * tw * rows * th);
    for (unsigned i = 0; i < frames.size(); ++i)
        for (unsigned y = 0; y < th * 4; ++y)
            for (unsigned x = 0; x < tw * 4; ++x)
                sheet[std::size_t(i / columns * th + y / 4) * columns * tw + i % columns * tw + x / 4] +=
                    frames[i][std::size_t(y) * w + x] / 16.f;
    claray::write_image(path, {columns * tw, rows * th, sheet});
}

struct Walk {
    std::vector<std::vector<glm::vec3>> images;
    std::vector<float> changes, worst;  // of all frames; of each frame that of 99 of 100 points
    double milliseconds = 0;            // a frame
};

// `parts`: of a pixel along each axis, whose surfaces `changes_between` is to know.
Walk walk_along(const claray::Device& device, const claray::Scene& scene, const claray::RenderConfig& config,
                unsigned parts, unsigned count, const std::function<void(unsigned)>& place,
                const std::function<std::vector<float>(const Frame&, const Frame&)>& changes_between) {
    claray::Renderer renderer(device, scene, config);
    claray::Renderer surfaces(
        device, scene, {.width = parts * config.width, .height = parts * config.height, .spp = 1, .max_depth = 1});
    Walk walk;
    Frame before;
    for (unsigned i = 0; i < count; ++i) {
        place(i);
        const auto begin = std::chrono::steady_clock::now();
        renderer.update(scene, {.camera = true});
        (void)renderer.render();
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
        surfaces.update(scene, {.camera = true});
        Frame now{renderer.image(), surfaces.gbuffer()};
        walk.images.push_back(now.image);
        if (i > 0) {
            walk.milliseconds += 1e3 * seconds.count() / (count - 1);
            const std::vector<float> of_frame = changes_between(before, now);
            walk.worst.push_back(percentile(of_frame, 0.99));
            walk.changes.insert(walk.changes.end(), of_frame.begin(), of_frame.end());
        }
        before = std::move(now);
    }
    return walk;
}

void print_changes(const char* what, const Walk& walk) {
    const auto share_above = [&](float change) {
        const auto above = std::ranges::count_if(walk.changes, [&](float value) { return value > change; });
        return 100. * double(above) / double(std::max<std::size_t>(walk.changes.size(), 1));
    };
    std::printf(
        "%s: median %.3f %%, 99 of 100 below %.2f %% (%zu in all); in the frame of the largest changes below %.2f %%; "
        "%.3f %% of changes above 1 %%, %.3f %% above 10 %%\n",
        what, 100 * percentile(walk.changes, 0.5), 100 * percentile(walk.changes, 0.99), walk.changes.size(),
        100 * percentile(walk.worst, 1), share_above(0.01f), share_above(0.1f));
}

}  // namespace

int main(int argc, char** argv) try {
    const auto argument = [&](int i, const char* otherwise) { return std::string(argc > i ? argv[i] : otherwise); };
    claray::Warnings warnings;
    claray::Scene scene = claray::load_scene(argument(1, "cornell"), warnings);
    const unsigned count = unsigned(std::max(2, std::atoi(argument(3, "120").c_str())));
    unsigned width = 320, height = 180;
    if (argc > 4 && std::sscanf(argv[4], "%ux%u", &width, &height) != 2)
        throw claray::Error(claray::ErrorKind::usage, "the size must be WIDTHxHEIGHT");
    const bool voxels = argument(5, "probes") == "voxels";
    scene.camera = claray::camera_of(scene, float(width) / float(height));
    const glm::vec3 view = scene.camera->target - scene.camera->position;
    glm::vec3 from = scene.camera->position, to = from + 0.5f * view, ahead = view;
    const auto number = [&](int i) { return float(std::atof(argv[i])); };
    if (argc > 11) {
        from = {number(6), number(7), number(8)}, to = {number(9), number(10), number(11)};
        ahead = to - from;
    }

    const claray::Device device = claray::Device::open();
    const claray::LightGridConfig grid{.voxels = voxels, .side = voxels ? 32u : 16u, .levels = 2};
    const claray::RenderConfig config{
        .width = width, .height = height, .spp = 16, .approximate = {.light_grid = true}, .light_grid = grid};
    const auto place = [&](unsigned frame) {
        scene.camera->position = glm::mix(from, to, float(frame) / float(count - 1));
        scene.camera->target = scene.camera->position + ahead;
    };
    place(0);
    const Walk walk = walk_along(device, scene, config, 1, count, place, changes);
    write_sheet(argument(2, "light_grid.png"), walk.images, width, height);
    std::printf("%u frames of 16 samples, %.1f ms each\n", count, walk.milliseconds);
    print_changes("change of a point from one frame to the next", walk);

    ahead = to - from, scene.camera->projection = claray::Projection::orthographic,
    scene.camera->orthographic_height = 0.5f * glm::length(ahead);
    place(0);
    const float length = glm::length(ahead);
    const auto of_pixels = [&](const Frame& before, const Frame& now) {
        return changes_of_static_pixels(before, now, width, length);
    };
    print_changes("change of a pixel that shows the same point",
                  walk_along(device, scene, config, 4, count, place, of_pixels));
} catch (const std::exception& error) {
    std::fprintf(stderr, "example_12_light_grid: error: %s\n", error.what());
    return 1;
}
