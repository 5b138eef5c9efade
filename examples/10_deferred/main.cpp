// Deferred shading: mountains under a thousand moving lights, points and spots in turn.
//     example_10_deferred [PICTURE [LIGHTS [FRAMES [WIDTHxHEIGHT]]]]
// The table counts how often a light is evaluated for a surface. A forward renderer does it for every light and every
// fragment of every triangle in view, a deferred one for every light and every pixel, and a tiled one for the lights of
// the list of the pixel's tile.
#include <chrono>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned tile = 16;  // pixels per side

float random_number() {
    static std::uint32_t word = 1;
    word = word * 1664525u + 1013904223u;
    return float(word >> 8) * 0x1p-24f;
}

// Lights that circle over the ground.
class Fireflies {
public:
    Fireflies(const claray::Scene& scene, unsigned count) : range_(0.1f * claray::bounds_of(scene).extent().x) {
        const std::vector<glm::vec3>& ground = scene.meshes[0].positions;
        for (unsigned i = 0; i < count; ++i) {
            homes_.push_back(ground[std::size_t(random_number() * float(ground.size()))]);
            colors_.emplace_back(random_number(), random_number(), random_number());
        }
    }

    [[nodiscard]] std::vector<claray::Light> at(float seconds) const {
        std::vector<claray::Light> lights;
        for (std::size_t i = 0; i < homes_.size(); ++i) {
            const float angle = float(i) + seconds;
            const glm::vec3 circle = 0.2f * range_ * glm::vec3(std::cos(angle), 2.f, std::sin(angle));
            lights.push_back(claray::point_light(homes_[i] + circle, 0.05f * range_ * range_ * (0.1f + colors_[i])));
            lights.back().range = range_;
            if (i % 2 == 0) continue;
            lights.back().kind = claray::LightKind::spot;
            lights.back().direction = {0.5f * std::cos(angle), -1.f, 0.5f * std::sin(angle)};
            lights.back().inner_angle = 0.4f, lights.back().outer_angle = 0.6f;
        }
        return lights;
    }

private:
    float range_;
    std::vector<glm::vec3> homes_, colors_;
};

// The number of triangles that each pixel's centre sees through all others: a forward renderer without a depth pass
// shades them all.
std::size_t fragments(const claray::Device& device, const claray::Scene& scene, unsigned width, unsigned height) {
    const claray::Bvh bvh = claray::Bvh::build(device, scene.meshes);
    const claray::CameraData c = claray::camera_data(*scene.camera, float(width) / float(height));
    std::vector<claray::Ray> rays;
    for (unsigned i = 0; i < width * height; ++i) {
        const float x = 2 * (float(i % width) + 0.5f) / float(width) - 1,
                    y = 1 - 2 * (float(i / width) + 0.5f) / float(height);
        rays.push_back({c.x, c.y, c.z, 0.f, c.forward_x + x * c.right_x + y * c.up_x,
                        c.forward_y + x * c.right_y + y * c.up_y, c.forward_z + x * c.right_z + y * c.up_z, INFINITY});
    }
    std::size_t count = 0;
    claray::Buffer<claray::Hit> hits(device, rays.size());
    while (!rays.empty()) {
        claray::closest_hit(bvh, claray::Buffer<claray::Ray>(device, rays), hits);
        const std::vector<claray::Hit> found = hits.read();
        std::vector<claray::Ray> onward;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (found[i].primitive == CLARAY_MISS) continue;
            rays[i].tmin = std::nextafter(found[i].t, INFINITY);
            onward.push_back(rays[i]);
        }
        count += onward.size();
        rays = std::move(onward);
    }
    return count;
}

struct Evaluations {
    std::size_t pixels = 0, deferred = 0, tiled = 0;
};

// From the G-buffer alone: the lists of tiles that the positions restored from the depths give.
Evaluations count_evaluations(const claray::GBuffer& buffer, const std::vector<claray::Light>& lights) {
    Evaluations count;
    for (unsigned y0 = 0; y0 < buffer.height; y0 += tile)
        for (unsigned x0 = 0; x0 < buffer.width; x0 += tile) {
            claray::Bounds box;
            std::size_t pixels = 0, reaching = 0;
            for (unsigned y = y0; y < std::min(y0 + tile, buffer.height); ++y)
                for (unsigned x = x0; x < std::min(x0 + tile, buffer.width); ++x) {
                    const std::size_t i = std::size_t(y) * buffer.width + x;
                    if (buffer.pixels[i].normal == CLARAY_NO_SURFACE) continue;
                    box.grow(claray::position_of(buffer, i));
                    ++pixels;
                }
            for (const claray::Light& light : lights) {
                const glm::vec3 off = glm::max(glm::max(box.lo - light.position, light.position - box.hi), 0.f);
                if (pixels > 0 && glm::dot(off, off) <= light.range * light.range) ++reaching;
            }
            count.pixels += pixels, count.deferred += pixels * lights.size(), count.tiled += pixels * reaching;
        }
    return count;
}

// Milliseconds for a frame: lights that move, an image, a picture of 8-bit colours.
double milliseconds(claray::Renderer& renderer, claray::Scene& scene, const Fireflies& fireflies, unsigned frames) {
    renderer.settle();
    const Clock::time_point begin = Clock::now();
    for (unsigned i = 0; i < frames; ++i) {
        scene.lights = fireflies.at(float(i) / 60);
        renderer.update(scene, {.lights = true});
        (void)renderer.render();
        (void)renderer.picture();
    }
    return 1e3 * std::chrono::duration<double>(Clock::now() - begin).count() / frames;
}

}  // namespace

int main(int argc, char** argv) try {
    const char* const picture = argc > 1 ? argv[1] : "deferred.png";
    const unsigned count = argc > 2 ? unsigned(std::atoi(argv[2])) : 1000,
                   frames = argc > 3 ? unsigned(std::atoi(argv[3])) : 60;
    unsigned width = 640, height = 360;
    if (argc > 4) std::sscanf(argv[4], "%ux%u", &width, &height);

    claray::Warnings warnings;
    claray::Scene scene = claray::load_scene("terrain:20000", warnings);
    scene.sky = {};
    scene.camera = claray::camera_of(scene, float(width) / float(height));
    const Fireflies fireflies(scene, count);
    scene.lights = fireflies.at(0);

    const claray::Device device = claray::Device::open();
    const claray::RenderConfig config{.width = width, .height = height, .spp = 1, .approximate = {.tile_sum = true}};
    claray::Renderer tiled(device, scene, config);
    const Evaluations of = count_evaluations(tiled.gbuffer(), scene.lights);
    const std::size_t forward = fragments(device, scene, width, height) * count;
    const double tiled_ms = milliseconds(tiled, scene, fireflies, frames);

    const claray::Device without_lists = claray::Device::open();  // lists that hold no light stand for all lights
    without_lists.set_tuning("deferred/list_lights", "MOST_PER_TILE", 0);
    without_lists.set_tuning("deferred/list_lights", "MOST_PER_BLOCK", 0);
    claray::Renderer deferred(without_lists, scene, config);
    const double deferred_ms = milliseconds(deferred, scene, fireflies, std::max(1u, frames / 10));

    std::printf("%ux%u, %u moving lights, %s\n\n", width, height, count, device.info().name.c_str());
    std::printf("%-10s %14s %10s %10s\n", "", "evaluations", "a pixel", "a frame");
    const auto row = [&](const char* name, std::size_t evaluations) {
        std::printf("%-10s %14zu %10.1f ", name, evaluations,
                    double(evaluations) / double(std::max<std::size_t>(of.pixels, 1)));
    };
    row("forward", forward), std::printf("%10s\n", "-");
    row("deferred", of.deferred), std::printf("%7.2f ms\n", deferred_ms);
    row("tiled", of.tiled), std::printf("%7.2f ms\n", tiled_ms);

    claray::RenderConfig smooth = config;  // for the picture: four points of each pixel
    smooth.spp = 4;
    claray::Renderer renderer(device, scene, smooth);
    (void)renderer.render();
    claray::write_image(picture, {width, height, renderer.image()});
    std::printf("\nwrote %s\n", picture);
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
}
