// Light whose amount is known: of lamps, skies and suns over a floor, and in closed rooms, by every form of the kernels
// that render.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "claray/effects.hpp"
#include "claray/instances.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/scenes.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

using std::numbers::pi;

/// How a device may render: values of its table, and what a scene's kernels are compiled with.
struct RenderForm {
    Form form;
    Layout layout = Layout::automatic;
    bool all_effects = true;  ///< of the case's scenes: one set of kernels for all of them
};

/// On CPUs the first one shades sixteen paths at once, where a scene has few effects; the others shade groups of paths
/// or single ones.
std::vector<RenderForm> render_forms() {
    return {{{"own kernels", {}}, Layout::automatic, false},
            {{"kernels of several scenes", {}}, Layout::wide},
            {{"binary trees", {{"render/add_light", "WITH_SHADOW_RAYS", 1}}}, Layout::binary},
            {whole_paths(), Layout::binary},
            {last_paths(), Layout::binary},
            {{"kernels of materials", {{"render/shade_surface", "SPLIT_FROM", 1}}}, Layout::wide}};
}

/// A scene whose image has the same radiance in every pixel.
struct LitScene {
    const char* name;
    Scene scene;
    double radiance;
    unsigned spp;
};

EffectSet effects_of_all(const std::vector<LitScene>& scenes) {
    EffectSet all{Effect::vertex_colors};  // which no sixteen paths have
    for (const LitScene& lit : scenes) all = all | effects_of(lit.scene);
    return all - EffectSet{Effect::instances, Effect::primitives};  // which bring kernels of their own
}

struct Rendered {
    std::vector<glm::vec3> image;
    double rays;
};
using Firsts = std::map<std::string, Rendered>;  // of scenes, by the first form

/// How the images of a form differ from those of the first one, which took the same samples.
class Difference {
public:
    void add(const Rendered& found, const Rendered& first) {
        for (std::size_t i = 0; i < found.image.size(); ++i) {
            const float error = glm::length(found.image[i] - first.image[i]);
            different_ += !(error <= 2e-5f * glm::length(first.image[i]));
        }
        pixels_ += found.image.size();
        rays_ = std::max(rays_, std::abs(found.rays / first.rays - 1));
    }
    /// A path whose last bit decides where it goes may differ where other kernels are compiled: so may one pixel in
    /// 200.
    void check(Run& run, const std::string& form) const {
        run.check(form + ": not as by the first form", pixels_, double(different_), double(pixels_ / 200), "pixels");
        run.check(form + ": rays more or less than by the first form", pixels_, rays_, 1e-3, "of the rays");
    }

private:
    std::uint64_t pixels_ = 0, different_ = 0;
    double rays_ = 0;
};

/// Compares the mean of an image with the known radiance, and the image with that of the first form.
void judge_light(Run& run, const LitScene& lit, RenderConfig config, const std::string& form, Firsts& firsts,
                 Difference& difference) {
    config.width = config.height = 16, config.spp = lit.spp * run.count(1u, 16u);
    config.seed = std::uint32_t(run.seed());
    Renderer renderer(run.device(), lit.scene, config);
    renderer.render();
    const RenderStatistics statistics = renderer.statistics();
    const Rendered found{renderer.image(), double(statistics.bounce.rays + statistics.shadow.rays)};
    double error = 0;
    for (int k = 0; k < 3; ++k) {
        double sum = 0;
        for (const glm::vec3& pixel : found.image) sum += double(pixel[k]);
        error = std::max(error, std::abs(sum / double(found.image.size()) / lit.radiance - 1));
    }
    const std::uint64_t samples = std::uint64_t(found.image.size()) * config.spp;
    run.check(std::string(lit.name) + ", " + form, samples, error, 0.004, "of the light");
    difference.add(found, firsts.try_emplace(lit.name, found).first->second);
}

void judge_light(Run& run, const std::vector<LitScene>& scenes, const RenderConfig& config, Firsts& firsts) {
    for (const RenderForm& form : render_forms()) {
        const ScopedForm set(run.device(), form.form);
        RenderConfig formed = config;
        formed.bvh.layout = form.layout;
        if (form.all_effects) formed.effects.add = effects_of_all(scenes);
        Difference difference;
        for (const LitScene& lit : scenes) judge_light(run, lit, formed, form.form.name, firsts, difference);
        difference.check(run, form.form.name);
    }
}

// ---- direct light on a floor -------------------------------------------------------------------------------------

constexpr double floor_albedo = 0.6;
const glm::dvec3 lit_point(0.25, 0, 0.5);

Scene lit_floor() {
    Scene scene;
    scene.materials = {grey(float(floor_albedo))};
    scene.meshes = {square(6.f, 0.f, 0)};
    scene.camera = narrow_camera(glm::vec3(lit_point) + glm::vec3(0.1f, 0.1f, 0.05f), glm::vec3(lit_point));
    return scene;
}

LitScene lit_floor(const char* name, Scene scene, double irradiance, unsigned spp) {
    return {name, std::move(scene), floor_albedo / pi * irradiance, spp};
}

/// The irradiance of the lit point by a triangle of radiance 1 above the floor (Lambert 1760).
double irradiance_of_triangle(const glm::vec3* corners) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3 a = glm::normalize(glm::dvec3(corners[k]) - lit_point),
                         b = glm::normalize(glm::dvec3(corners[(k + 1) % 3]) - lit_point);
        const glm::dvec3 across = glm::cross(a, b);
        sum += std::atan2(glm::length(across), glm::dot(a, b)) * across.y / glm::length(across);
    }
    return std::abs(sum) / 2;
}

/// The irradiance by a lamp of radiance 1, none of whose triangles hides another, but for those of its back.
double irradiance_of(const Mesh& lamp, bool closed) {
    double sum = 0;
    for (const glm::uvec3& t : lamp.triangles) {
        const glm::vec3 corners[] = {lamp.positions[t.x], lamp.positions[t.y], lamp.positions[t.z]};
        const glm::dvec3 normal = glm::cross(glm::dvec3(corners[1] - corners[0]), glm::dvec3(corners[2] - corners[0]));
        if (closed && glm::dot(normal, lit_point - glm::dvec3(corners[0])) <= 0) continue;
        sum += irradiance_of_triangle(corners);
    }
    return sum;
}

/// Under a sky of radiance 0.5, which the lamp hides in part.
LitScene under_lamp(const char* name, Mesh lamp, bool closed, unsigned spp) {
    constexpr double radiance = 3, sky = 0.5;
    Scene scene = lit_floor();
    scene.materials.push_back(grey(0.f, float(radiance)));
    lamp.materials.assign(lamp.triangles.size(), 1);
    const double share = irradiance_of(lamp, closed);
    scene.meshes.push_back(std::move(lamp));
    scene.sky.horizon = scene.sky.zenith = glm::vec3(float(sky));
    return lit_floor(name, std::move(scene), radiance * share + sky * (pi - share), spp);
}

/// Small triangles in cells of the hemisphere, none before another, each at a distance of its own.
Mesh many_lamps(std::uint64_t seed) {
    Random random(seed);
    Mesh mesh;
    for (int row = 0; row < 8; ++row)
        for (int column = 0; column < 32; ++column) {
            const double height = (row + 0.5) / 8, turn = 2 * pi * (column + 0.5) / 32;
            const double r = std::sqrt(1 - height * height);
            const glm::dvec3 out(r * std::cos(turn), height, r * std::sin(turn));
            const double distance = double(random.uniform(1.f, 4.f)), size = 0.06 * distance * r;
            const glm::dvec3 side(-std::sin(turn), 0, std::cos(turn)), up = glm::cross(side, out),
                                                                       at = lit_point + distance * out;
            const auto first = std::uint32_t(mesh.positions.size());
            for (const glm::dvec3& corner : {at - size * side, at + size * side, at + 0.8 * size * up})
                mesh.positions.emplace_back(corner);
            mesh.triangles.emplace_back(first, first + 1, first + 2);
        }
    return mesh;
}

/// The irradiance of the lit point by the formulas of KHR_lights_punctual.
double irradiance_of(const std::vector<Light>& lights) {
    double sum = 0;
    for (const Light& light : lights) {
        const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction));
        const glm::dvec3 towards = glm::dvec3(light.position) - lit_point;
        const bool far = light.kind == LightKind::directional || light.kind == LightKind::sun;
        const double d = glm::length(towards);
        const glm::dvec3 direction = far ? -axis : towards / d;
        double irradiance = far ? 1 : 1 / (d * d);
        const double share = !far && light.range > 0 ? d / double(light.range) : 0;
        irradiance *= std::max(1 - (light.linear_range ? share : std::pow(share, 4)), 0.0);
        if (light.kind == LightKind::spot) {
            const double outer = std::cos(double(light.outer_angle)), inner = std::cos(double(light.inner_angle));
            irradiance *= std::pow(std::clamp((glm::dot(axis, -direction) - outer) / (inner - outer), 0.0, 1.0), 2);
        }
        sum += double(light.intensity.x) * irradiance * std::max(direction.y, 0.0);
    }
    return sum;
}

std::vector<Light> points(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Light> lights;
    for (std::size_t i = 0; i < count; ++i)
        lights.push_back(point_light(glm::vec3(0, 2.5f, 0) + random.in_cube(2.f), glm::vec3(random.uniform(1, 5))));
    return lights;
}

/// One or more of every kind, with ranges and cones.
std::vector<Light> all_kinds(std::uint64_t seed) {
    std::vector<Light> lights = points(12, seed);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        Light& light = lights[i];
        light.kind = i % 3 == 1 ? LightKind::spot
                     : i == 0   ? LightKind::directional
                     : i == 3   ? LightKind::sun
                                : LightKind::point;
        light.direction = glm::vec3(lit_point) - light.position + glm::vec3(0.3f, 0.f, 0.2f);
        light.inner_angle = i == 3 ? 0.f : 0.1f, light.outer_angle = i == 3 ? 0.05f : 0.6f;
        light.range = i % 4 == 2 ? 9.f : 0.f, light.linear_range = i % 8 == 2;
        if (i == 0 || i == 3) light.intensity *= 0.2f;
    }
    return lights;
}

LitScene under_lights(const char* name, std::vector<Light> lights, unsigned spp) {
    Scene scene = lit_floor();
    const double irradiance = irradiance_of(lights);
    scene.lights = std::move(lights);
    return lit_floor(name, std::move(scene), irradiance, spp);
}

/// Linear in the sine of the elevation, so that the irradiance is pi horizon + 2/3 pi (zenith - horizon).
LitScene under_gradient() {
    Scene scene = lit_floor();
    scene.sky.horizon = glm::vec3(0.5f), scene.sky.zenith = glm::vec3(2.f);
    return lit_floor("a sky", std::move(scene), pi * (0.5 + 1.5 * 2 / 3), 256);
}

/// The same by an image.
LitScene under_image() {
    Scene scene = lit_floor();
    Texture image;
    image.width = 128, image.height = 256, image.channels = 3, image.format = TexelFormat::float32;
    for (unsigned y = 0; y < image.height; ++y) {
        const double elevation = std::cos((y + 0.5) * pi / image.height);
        image.floats.insert(image.floats.end(), std::size_t(3) * image.width,
                            float(0.25 + 0.75 * std::max(elevation, 0.0)));
    }
    scene.environment.images = {image}, scene.environment.strength = 2.f;
    return lit_floor("an image of a sky", std::move(scene), pi * (0.5 + 1.5 * 2 / 3), 512);
}

Mesh lamp_square() {
    Mesh lamp = square(1.f, 1.5f, 1);
    lamp.uvs.clear();
    return lamp;
}

void direct_light(Run& run) {
    const std::vector<LitScene> scenes = {
        under_lights("three points", points(3, run.seed() + 121), 4),
        under_lights("points by lists", points(64, run.seed() + 122), 512),
        under_lights("lights of all kinds", all_kinds(run.seed() + 123), 512),
        under_lamp("a square lamp", lamp_square(), false, 512),
        under_lamp("a ball lamp", sphere(1, 0.7f, {0.6f, 1.6f, -0.3f}), true, 512),
        under_lamp("many lamps", many_lamps(run.seed() + 124), false, 1024),
        under_gradient(),
        under_image(),
    };
    Firsts firsts;
    judge_light(run, scenes, {.max_depth = 1}, firsts);
}

// ---- closed rooms ------------------------------------------------------------------------------------------------

constexpr float room_albedo = 0.5f, room_emission = 1.f;
constexpr double room_radiance = room_emission / (1 - room_albedo);

/// All surfaces emit and scatter the same, so that all directions have the same radiance, whatever is in the room.
Scene room() {
    Scene scene;
    scene.materials = {grey(room_albedo, room_emission)};
    Mesh walls;
    for (int i = 0; i < 8; ++i) walls.positions.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    walls.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    scene.meshes = {walls};
    scene.camera = Camera{{0.1f, 0.2f, 0.9f}, {0, 0, 0}, {0, 1, 0}, 80.f};
    return scene;
}

Scene room_with_ball() {
    Scene scene = room();
    scene.meshes.push_back(sphere(2, 0.4f, {0.3f, -0.2f, -0.1f}));
    return scene;
}

PrimitiveSet set_of(PrimitiveSet::Kind kind, std::vector<glm::vec4> points, std::vector<std::uint32_t> segments = {}) {
    PrimitiveSet set;
    set.kind = kind, set.points = std::move(points), set.segments = std::move(segments);
    return set;
}

Scene room_with_primitives() {
    using Kind = PrimitiveSet::Kind;
    Scene scene = room();
    scene.primitives = {
        set_of(Kind::spheres, {{-0.4f, -0.3f, 0.f, 0.35f}}),
        set_of(Kind::discs, {{0.4f, 0.3f, 0.f, 0.4f}, {1, 1, 1, 0}}),
        set_of(Kind::cylinders, {{0.5f, -0.7f, 0.f, 0.2f}, {0.6f, -0.1f, -0.4f, 1.f}}),
        set_of(Kind::bezier_curves,
               {{-0.8f, 0.5f, 0, 0.1f}, {-0.3f, 0.8f, 0, 0.1f}, {0.3f, 0.5f, 0.2f, 0.1f}, {0.8f, 0.8f, 0, 0.1f}}, {0})};
    return scene;
}

void closed_rooms(Run& run) {
    const std::vector<LitScene> scenes = {{"a room", room(), room_radiance, 512},
                                          {"a room with a ball", room_with_ball(), room_radiance, 512}};
    Firsts firsts;
    judge_light(run, scenes, {}, firsts);
    Difference of_parts, of_primitives;
    judge_light(run, {"a room with primitives", room_with_primitives(), room_radiance, 512}, {}, "own kernels", firsts,
                of_primitives);
    judge_light(run, scenes[1], {.parts = 2}, "a tree in parts", firsts, of_parts);
    of_parts.check(run, "a tree in parts");
}

}  // namespace

Cases light_cases() {
    return {
        {{"direct-light", "light", "Light of lamps, skies and suns on a floor in closed form, by every form"},
         direct_light},
        {{"closed-rooms", "light", "Light in rooms that emit and scatter evenly, by every form and with primitives"},
         closed_rooms},
    };
}

}  // namespace claray::verify
