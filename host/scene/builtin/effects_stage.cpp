#include "host/scene/builtin/effects_stage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/random.hpp"
#include "host/scene/builtin/noise.hpp"
#include "host/scene/builtin/shapes.hpp"

namespace claray::scenes {
namespace {

constexpr unsigned image_side = 128;

/// 0..1 along a wave of `count` periods, by parabolas: the same on every machine.
double wave(double x, double count) {
    const double phase = x * count - std::floor(x * count), t = 2 * std::abs(2 * phase - 1) - 1;  // -1 .. 1
    return 0.5 + 0.5 * t * (2 - std::abs(t));
}

glm::vec3 encoded_normal(double slope_u, double slope_v) {
    const double length = std::sqrt(slope_u * slope_u + slope_v * slope_v + 1);
    return {float(0.5 - 0.5 * slope_u / length), float(0.5 + 0.5 * slope_v / length), float(0.5 + 0.5 / length)};
}

PrimitiveSet& add_set(Scene& scene, const char* name, PrimitiveSet::Kind kind) {
    PrimitiveSet& set = scene.primitives.emplace_back();
    set.name = name, set.kind = kind;
    return set;
}

/// Curves that wind around the place, each by two thirds of a turn.
void add_twigs(PrimitiveSet& set, const glm::vec3& place, float radius) {
    constexpr std::uint32_t twigs = 90, points = 9;
    Random random(5);
    for (std::uint32_t twig = 0; twig < twigs; ++twig) {
        const float begin = random.uniform(0.f, 6.28f), height = random.uniform(), bulge = random.uniform(0.7f, 1.f);
        for (std::uint32_t i = 0; i < points; ++i) {
            const float angle = begin + 0.55f * float(i), wide = radius * (bulge + 0.08f * random.uniform());
            const float y = radius * (0.05f + 0.4f * height + 0.08f * random.uniform());
            const float thick = 0.018f * radius * (i == 0 || i + 1 == points ? 0.5f : 1.f);
            set.points.emplace_back(place + glm::vec3(wide * std::cos(angle), y, wide * std::sin(angle)), thick);
            if (i + 4 <= points) set.segments.push_back(points * twig + i);
        }
    }
}

}  // namespace

void add_nest(Scene& scene, const glm::vec3& place, float radius, std::uint32_t twigs, std::uint32_t eggs) {
    const auto at = [&](float x, float y, float z, float w) {
        return glm::vec4(place + radius * glm::vec3(x, y, z), radius * w);
    };
    PrimitiveSet& spheres = add_set(scene, "eggs", PrimitiveSet::Kind::spheres);
    spheres.points = {at(-0.3f, 0.27f, 0.1f, 0.26f), at(0.25f, 0.25f, 0.25f, 0.24f), at(0.05f, 0.25f, -0.3f, 0.24f)};
    spheres.materials.assign(3, eggs);
    PrimitiveSet& disc = add_set(scene, "bottom", PrimitiveSet::Kind::discs);
    disc.points = {at(0.f, 0.02f, 0.f, 0.85f), {0.f, 1.f, 0.f, 0.f}}, disc.materials = {twigs};
    PrimitiveSet& sticks = add_set(scene, "stick", PrimitiveSet::Kind::cylinders);
    sticks.points = {at(-0.3f, 0.1f, 0.5f, 0.05f), {glm::vec3(at(-1.2f, 1.1f, 0.2f, 0.f)), 1.f}};
    sticks.materials = {twigs};
    PrimitiveSet& curves = add_set(scene, "twigs", PrimitiveSet::Kind::curves);
    add_twigs(curves, place, radius);
    curves.materials.assign(curves.segments.size(), twigs);
}

Mesh textured_rectangle(const glm::vec3& center, const glm::vec3& u, const glm::vec3& v, std::uint32_t material) {
    Mesh mesh;
    add_rectangle(mesh, center, u, v, material);
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    return mesh;
}

Mesh textured_ball(const glm::vec3& center, float radius, unsigned levels, std::uint32_t material) {
    Mesh mesh = make_sphere(center, radius, levels, material);
    for (const glm::vec3& p : mesh.positions)
        mesh.uvs.emplace_back(0.5f + 0.5f * (p.x - center.x) / radius, 0.5f - 0.5f * (p.y - center.y) / radius);
    return mesh;
}

void paint(Mesh& mesh) {
    const Bounds box = bounds_of(mesh);
    for (const glm::vec3& p : mesh.positions)
        mesh.colors.emplace_back(glm::clamp((p - box.lo) / box.extent(), 0.f, 1.f), 1.f);
}

Mesh open_bowl(const glm::vec3& center, float radius, std::uint32_t material) {
    constexpr unsigned rings = 16, sides = 64;
    const auto at = [&](unsigned ring) {  // radius and height
        const double angle = 0.5 * std::numbers::pi * ring / rings;
        return glm::vec2(radius * float(std::sin(angle)), -radius * float(std::cos(angle)));
    };
    Mesh mesh;
    for (unsigned ring = 1; ring < rings; ++ring) {
        const glm::vec2 low = at(ring), high = at(ring + 1);
        add_frustum(mesh, center + glm::vec3(0.f, low.y, 0.f), low.x, high.x, high.y - low.y, sides, material);
    }
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);  // the inside is the front
    const glm::vec2 bottom = at(1);
    add_frustum(mesh, center + glm::vec3(0.f, bottom.y, 0.f), bottom.x, 0.f, -radius - bottom.y, sides, material);
    for (const glm::vec3& p : mesh.positions) mesh.normals.push_back(glm::normalize(center - p));
    return mesh;
}

Scene empty_stage() {
    Scene scene;
    scene.materials = {lambert("floor", {0.5f, 0.48f, 0.45f}), lambert("ball", {0.75f, 0.3f, 0.15f}),
                       lambert("block", {0.2f, 0.35f, 0.6f})};
    scene.meshes = {textured_rectangle({0, 0, 0}, {3, 0, 0}, {0, 0, -3}, floor_material),
                    textured_ball({-0.35f, 0.8f, 0.f}, 0.8f, 4, ball_material), Mesh()};
    scene.meshes[0].name = "floor";
    scene.meshes[1].normals.clear();
    Mesh& block = scene.meshes[2];
    block.name = "block";
    add_beveled_box(block, {1.05f, 0.45f, 0.35f}, {{0.36f, 0.f, -0.27f}, {0.f, 0.45f, 0.f}, {0.27f, 0.f, 0.36f}}, 0.04f,
                    block_material);
    for (const glm::vec3& p : block.positions) block.uvs.emplace_back(p.x - p.z, 1.f - p.y);
    scene.camera = Camera{{0.4f, 1.9f, 4.4f}, {0.15f, 0.6f, 0.f}, {0.f, 1.f, 0.f}, 36.f};
    return scene;
}

Texture computed_image(const char* name, unsigned width, unsigned height, TexelFormat format,
                       const std::function<glm::vec3(double, double)>& color) {
    Texture image;
    image.name = name;
    image.width = width, image.height = height, image.channels = 3, image.format = format;
    for (unsigned y = 0; y < height; ++y)
        for (unsigned x = 0; x < width; ++x) {
            const glm::vec3 c = color((x + 0.5) / width, (y + 0.5) / height);
            for (int k = 0; k < 3; ++k) {
                if (format == TexelFormat::float32)
                    image.floats.push_back(c[k]);
                else
                    image.bytes.push_back(std::uint8_t(std::clamp(c[k], 0.f, 1.f) * 255.f + 0.5f));
            }
        }
    return image;
}

Texture checks() {
    return computed_image("checks", image_side, image_side, TexelFormat::srgb8, [](double u, double v) {
        return (int(8 * u) + int(8 * v)) % 2 ? glm::vec3(0.85f, 0.8f, 0.7f) : glm::vec3(0.3f, 0.35f, 0.4f);
    });
}

Texture ripples_as_normals() {
    return computed_image("ripples", image_side, image_side, TexelFormat::linear8,
                          [](double u, double v) { return encoded_normal(wave(u, 8) - 0.5, wave(v, 8) - 0.5); });
}

Texture noise_as_height() {
    return computed_image("noise", image_side, image_side, TexelFormat::linear8, [](double u, double v) {
        return glm::vec3(float(0.5 + 0.25 * fractal_noise(12 * u, 12 * v, 4, 7)));
    });
}

Texture pool_of_light() {
    return computed_image("pool of light", image_side, image_side, TexelFormat::float32, [](double u, double v) {
        const double distance2 = 4 * ((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5));
        const auto light = float(4 / (1 + 12 * distance2));
        return glm::vec3(light, 0.85f * light, 0.6f * light);
    });
}

Texture disc_opacity() {
    return computed_image("disc", image_side, image_side, TexelFormat::linear8, [](double u, double v) {
        const double distance2 = 4 * ((u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5));
        return glm::vec3(distance2 < 0.9 && distance2 > 0.25 ? 1.f : 0.f);
    });
}

Texture evening_environment() {
    return computed_image("evening", 2 * image_side, image_side, TexelFormat::float32, [](double u, double v) {
        if (v > 0.5) return glm::vec3(0.08f, 0.07f, 0.06f);
        const double du = 2 * (u - 0.8), dv = v - 0.38;
        if (du * du + dv * dv < 0.001) return glm::vec3(140.f, 100.f, 60.f);
        const auto height = float(1 - 2 * v);
        return glm::mix(glm::vec3(0.9f, 0.6f, 0.4f), glm::vec3(0.15f, 0.25f, 0.5f), height);
    });
}

TextureUse add_texture(Scene& scene, Texture texture, Filter filter) {
    texture.filter = filter;
    TextureUse use;
    use.texture = std::uint32_t(scene.textures.size());
    scene.textures.push_back(std::move(texture));
    return use;
}

}  // namespace claray::scenes
