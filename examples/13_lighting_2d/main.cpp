// Lit sprites: an orthographic view of sprites with normal maps and holes under a thousand moving lights.
//     example_13_lighting_2d [PICTURE [LIGHTS [FRAMES [WIDTHxHEIGHT]]]]
// It writes its atlas and its normals to PICTURE_atlas.png and PICTURE_normals.png, a frame to PICTURE, and the same
// with the shadows that 2D engines lack to PICTURE_shadows.png. A light has the falloff of these engines, 1 - d /
// radius.
#include <algorithm>
#include <chrono>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr unsigned cell = 32, kinds = 4;  // texels per side of a sprite; sprites in the atlas, side by side
constexpr float radius = 0.3f;            // of a light; the view is 4 high

float random_number() {
    static std::uint32_t word = 1;
    word = word * 1664525u + 1013904223u;
    return float(word >> 8) * 0x1p-24f;
}

// ---- the atlas: bricks, a stone, a coin, a gem ---------------------------------------------------------------------

// Height over the sprite's plane in texels at a point from -1 to 1; negative: there is nothing.
float height_of(unsigned kind, float x, float y) {
    const float r = std::hypot(x, y), size = 0.5f * cell;
    if (kind == 0) {
        const float row = std::floor(2 * (y + 1)), along = 2 * (x + 1) + (int(row) % 2 ? 0.5f : 0.f);
        const float from_edge = std::min(std::min(along - std::floor(along), std::ceil(along) - along),
                                         std::min(2 * (y + 1) - row, row + 1 - 2 * (y + 1)));
        return 2.f * std::min(from_edge * 8, 1.f);
    }
    const float bumps = 0.05f * std::sin(9 * x + 2) * std::sin(8 * y + x);
    if (kind == 1) return r < 0.9f + bumps ? size * (0.7f * std::sqrt(std::max(1 - r * r, 0.f)) + bumps) : -1;
    if (kind == 2) return r < 0.95f ? (r > 0.75f || std::abs(x) + std::abs(y) < 0.4f ? 3.f : 1.f) : -1;
    const float facets = std::abs(x) + std::abs(y);
    return facets < 0.95f ? size * std::min(0.95f - facets, 0.45f) : -1;
}

glm::vec3 color_of(unsigned kind, float x, float y) {
    const float grain = 0.9f + 0.1f * std::sin(40 * x + 13 * y) * std::sin(31 * y - 17 * x);
    const glm::vec3 colors[kinds] = {
        {0.75f, 0.45f, 0.35f}, {0.6f, 0.6f, 0.65f}, {0.95f, 0.8f, 0.3f}, {0.4f, 0.8f, 0.9f}};
    return grain * colors[kind];
}

struct Atlas {
    claray::Texture colors, normals;
};

Atlas make_atlas() {
    claray::Texture colors, heights;
    colors.name = "atlas", colors.width = heights.width = kinds * cell, colors.height = heights.height = cell;
    heights.channels = 1, heights.format = claray::TexelFormat::float32;
    heights.wrap_u = heights.wrap_v = claray::Wrap::clamp;
    for (unsigned i = 0; i < kinds * cell * cell; ++i) {
        const float x = 2 * (float(i % cell) + 0.5f) / cell - 1, y = 1 - 2 * (float(i / (kinds * cell)) + 0.5f) / cell;
        const unsigned kind = i / cell % kinds;
        const float height = height_of(kind, x, y);
        const glm::vec3 color = 255.f * color_of(kind, x, y);
        for (int k = 0; k < 3; ++k) colors.bytes.push_back(std::uint8_t(color[k]));
        colors.bytes.push_back(height < 0 ? 0 : 255);
        heights.floats.push_back(std::max(height, 0.f));
    }
    claray::Texture normals = claray::normal_map_of(heights);
    colors.filter = normals.filter = claray::Filter::nearest;
    return {colors, normals};
}

// ---- the scene -----------------------------------------------------------------------------------------------------

// Adds a square that shows one sprite of the atlas. Its corners turn, and with them the frame of its normals.
void add_sprite(claray::Mesh& mesh, unsigned kind, const glm::vec3& position, float size, float angle) {
    const auto first = std::uint32_t(mesh.positions.size());
    const glm::vec3 right = 0.5f * size * glm::vec3(std::cos(angle), std::sin(angle), 0), up(-right.y, right.x, 0);
    for (const glm::vec2 corner : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        mesh.positions.push_back(position + corner.x * right + corner.y * up);
        mesh.uvs.emplace_back((float(kind) + 0.5f + 0.5f * corner.x) / kinds, 0.5f - 0.5f * corner.y);
    }
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 2, first + 3);
    mesh.materials.insert(mesh.materials.end(), 2, kind == 0 ? 0u : 1u);
}

claray::Scene make_scene(float aspect) {
    claray::Scene scene;
    Atlas atlas = make_atlas();
    scene.textures = {std::move(atlas.colors), std::move(atlas.normals)};
    claray::Material solid;
    solid.albedo = glm::vec3(1.f), solid.albedo_map.texture = 0, solid.normal_map.texture = 1;
    scene.materials = {solid, solid};
    scene.materials[1].alpha_mode = claray::AlphaMode::mask;
    scene.meshes.resize(1);
    const float tile = 0.4f;
    for (float y = -2 + tile / 2; y < 2 + tile; y += tile)
        for (float x = -2 * aspect + tile / 2; x < 2 * aspect + tile; x += tile)
            add_sprite(scene.meshes[0], 0, {x, y, 0}, tile, 0);
    for (unsigned i = 0; i < 120; ++i) {
        const glm::vec2 at = 4.f * glm::vec2(aspect * (random_number() - 0.5f), random_number() - 0.5f);
        const float size = 0.25f + 0.2f * random_number(), angle = 2 * pi * random_number();
        add_sprite(scene.meshes[0], 1 + i % 3, {at, 0.02f + 0.0005f * float(i)}, size, angle);
    }
    scene.camera = claray::Camera{
        .position = {0, 0, 5}, .projection = claray::Projection::orthographic, .orthographic_height = 4.f};
    return scene;
}

// Lights that circle over the sprites.
class Fireflies {
public:
    Fireflies(unsigned count, float aspect) {
        for (unsigned i = 0; i < count; ++i) {
            homes_.emplace_back(4 * aspect * (random_number() - 0.5f), 4 * (random_number() - 0.5f), 0.12f);
            colors_.emplace_back(random_number(), random_number(), random_number());
        }
    }

    [[nodiscard]] std::vector<claray::Light> at(float seconds) const {
        std::vector<claray::Light> lights;
        for (std::size_t i = 0; i < homes_.size(); ++i) {
            const glm::vec3 circle(std::cos(float(i) + seconds), std::sin(float(i) + seconds), 0.f);
            // An intensity of pi on a white sprite gives 1: engines leave out Lambert's 1 / pi.
            lights.push_back(claray::point_light(homes_[i] + 0.2f * circle, 0.8f * pi * colors_[i] * colors_[i]));
            lights.back().range = radius, lights.back().linear_range = true, lights.back().attenuation = {1, 0, 0};
        }
        return lights;
    }

private:
    std::vector<glm::vec3> homes_, colors_;
};

// Milliseconds of a frame by the clock: the median.
double frame_milliseconds(claray::Renderer& renderer, claray::Scene& scene, const Fireflies& fireflies,
                          unsigned frames) {
    std::vector<double> times;
    for (unsigned i = 0; i < frames; ++i) {
        scene.lights = fireflies.at(float(i) / 60);
        const auto begin = std::chrono::steady_clock::now();
        renderer.update(scene, {.lights = true});
        (void)renderer.render();
        (void)renderer.picture();
        times.push_back(1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(frames / 2), times.end());
    return times[frames / 2];
}

std::string beside(const std::string& picture, const char* what) {
    const std::filesystem::path path = picture;
    return (path.parent_path() / (path.stem().string() + what + ".png")).string();
}

}  // namespace

int main(int argc, char** argv) try {
    const std::string picture = argc > 1 ? argv[1] : "lighting_2d.png";
    const unsigned count = argc > 2 ? unsigned(std::atoi(argv[2])) : 1000,
                   frames = std::max(1, argc > 3 ? std::atoi(argv[3]) : 60);
    unsigned width = 640, height = 360;
    if (argc > 4) std::sscanf(argv[4], "%ux%u", &width, &height);
    const float aspect = float(width) / float(height);

    claray::Scene scene = make_scene(aspect);
    claray::write_texture(beside(picture, "_atlas"), scene.textures[0]);
    claray::write_texture(beside(picture, "_normals"), scene.textures[1]);
    const Fireflies fireflies(count, aspect);
    scene.lights = fireflies.at(0);

    const claray::Device device = claray::Device::open();
    const claray::RenderConfig config{
        .width = width, .height = height, .spp = 1, .max_depth = 1, .approximate = {.tile_sum = true}};
    claray::Renderer tiled(device, scene, config);
    tiled.settle();
    device.profiler().enable(false);  // events cost a GPU some microseconds each
    const double frame = frame_milliseconds(tiled, scene, fireflies, frames);
    device.profiler().enable(true);
    device.profiler().reset();
    (void)frame_milliseconds(tiled, scene, fireflies, frames);
    const double of_device = device.profiler().total_milliseconds() / frames;

    const claray::Device without_lists = claray::Device::open();  // lists that hold no light stand for all lights
    without_lists.set_tuning("deferred/list_lights", "MOST_PER_TILE", 0);
    without_lists.set_tuning("deferred/list_lights", "MOST_PER_BLOCK", 0);
    claray::Renderer all(without_lists, scene, config);
    (void)all.render();
    std::printf("%ux%u, %zu sprites, %u moving lights, %s\n", width, height, scene.meshes[0].triangles.size() / 2,
                count, device.info().name.c_str());
    std::printf("a frame (median of %u): %.2f ms; kernels and transfers of one: %.2f ms\n", frames, frame, of_device);
    std::printf("the sum over all lights, bit for bit: %s\n", all.image() == tiled.image() ? "yes" : "no");

    claray::RenderConfig smooth = config;  // for the pictures: 16 points of each pixel, and shadows
    smooth.spp = 16;
    claray::Renderer still(device, scene, smooth);
    (void)still.render();
    claray::write_image(picture, {width, height, still.image()}, 0.f, claray::ToneMap::none);
    smooth.approximate = {};
    claray::Renderer shadows(device, scene, smooth);
    (void)shadows.render();
    claray::write_image(beside(picture, "_shadows"), {width, height, shadows.image()}, 0.f, claray::ToneMap::none);
    std::printf("wrote %s\n", picture.c_str());
} catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
}
