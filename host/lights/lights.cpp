#include "host/lights/lights.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "host/bsdf/material_data.hpp"
#include "host/lights/environment.hpp"
#include "host/lights/hot_spots.hpp"
#include "host/lights/light_lists.hpp"
#include "host/lights/light_tree.hpp"
#include "host/lights/luminance.hpp"
#include "host/lights/number_shares.hpp"
#include "host/scene/placement.hpp"
#include "host/textures/mean_texel.hpp"
#include "host/textures/texture_use.hpp"
#include "host/textures/textures.hpp"

namespace claray {
namespace {

using std::numbers::pi;

/// As in the acceleration structure, which leaves out other triangles, so that they cannot be hit.
bool can_be_hit(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const auto sound = [](const glm::vec3& v) {
        return std::abs(v.x) <= 1e18f && std::abs(v.y) <= 1e18f && std::abs(v.z) <= 1e18f;  // false for NaN
    };
    return sound(a) && sound(b) && sound(c) && a != b && b != c && c != a;
}

TriangleLight triangle_light(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& emission) {
    const glm::vec3 e1 = b - a, e2 = c - a;
    TriangleLight light{};
    light.v0x = a.x, light.v0y = a.y, light.v0z = a.z;
    light.e1x = e1.x, light.e1y = e1.y, light.e1z = e1.z;
    light.e2x = e2.x, light.e2y = e2.y, light.e2z = e2.z;
    light.area = float(0.5 * glm::length(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a))));
    light.emission_r = emission.x, light.emission_g = emission.y, light.emission_b = emission.z;
    return light;
}

/// Average emission of a triangle; of its map only the part on the triangle.
glm::vec3 mean_emission(const Scene& scene, const Material& material, const Mesh& mesh, const glm::uvec3& triangle,
                        unsigned most_points) {
    if (!has_emission_map(material)) return material.emission;
    const TextureUse& use = material.emission_map;
    const std::vector<glm::vec2>& uvs = use.uv_set == 0 ? mesh.uvs : mesh.uvs1;
    glm::vec2 corners[3];
    for (int k = 0; k < 3; ++k)
        corners[k] = transformed(use, triangle[k] < uvs.size() ? uvs[triangle[k]] : glm::vec2(0.f));
    return material.emission * mean_texel(scene.textures[use.texture], corners[0], corners[1], corners[2], most_points);
}

/// The number of a mesh's first triangle in hits, and its index in memory.
struct FirstTriangle {
    std::uint32_t number, in_memory;
};

/// Collects the lights of a mesh, placed by `transform`.
void collect_triangles(const Scene& scene, const Mesh& mesh, const glm::dmat4& transform, const FirstTriangle& first,
                       unsigned most_points, Lights& collected) {
    std::vector<TriangleLight>& lights = collected.triangles;
    const auto place = [&](std::uint32_t vertex) {
        return glm::vec3(transform * glm::dvec4(mesh.positions[vertex], 1.0));
    };
    const bool flips = glm::determinant(glm::dmat3(transform)) < 0;  // front sides stay those of the object
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const std::uint32_t number = mesh.materials.empty() ? 0 : mesh.materials[i];
        const Material& material = scene.materials[number];
        const bool mirrored = flips && material.cull_back;
        if (sampled_emission(material) == 0.f) continue;
        const glm::uvec3 t = mesh.triangles[i];
        const glm::vec3 emission = mean_emission(scene, material, mesh, t, most_points);
        if (!(luminance(emission) > 0)) continue;
        const glm::vec3 a = place(t.x), b = place(mirrored ? t.z : t.y), c = place(mirrored ? t.y : t.z);
        if (!can_be_hit(a, b, c)) continue;
        lights.push_back(triangle_light(a, b, c, emission));
        lights.back().primitive = first.number + std::uint32_t(i);
        if (!(lights.back().area > 0)) {
            lights.pop_back();
            continue;
        }
        collected.triangle_materials.push_back(number);
        if (material.cull_back) lights.back().area = -lights.back().area;
        const std::uint32_t turned = mirrored ? CLARAY_TURNED_LAMP : 0u;
        collected.lamps.push_back(has_emission_map(material) ? (first.in_memory + std::uint32_t(i)) | turned
                                                             : CLARAY_NO_MAP);
    }
}

/// Grows the bounds on the distance between a light of an instance and the end of a ray to it (docs/numerics.md): 8
/// roundings of |A| |A^-1| times the ray's length in the object.
void grow_instance_errors(const Mesh& mesh, const glm::dmat4& transform, LightsData& data) {
    if (transform == glm::dmat4(1.0)) return;  // the identity rounds nothing
    const glm::dmat3 linear(transform), inverse = glm::inverse(linear);
    double error = 0, reach = 0;
    for (int row = 0; row < 3; ++row) {
        double sum = 0;
        for (int i = 0; i < 9; ++i) sum += std::abs(linear[i % 3][row] * inverse[i / 3][i % 3]);
        error = std::max(error, 8 * 0x1p-24 * sum);
    }
    for (const glm::vec3& p : mesh.positions) reach = std::max(reach, glm::length(linear * glm::dvec3(p)));
    data.instance_error = std::max(data.instance_error, float(error));
    if (std::isfinite(reach)) data.instance_reach = std::max(data.instance_reach, float(reach));
}

/// Moving lights are not included: only BSDF sampling finds their light.
void collect_triangles(const Scene& scene, unsigned most_points, Lights& lights) {
    std::vector<std::uint32_t> in_memory = {0};
    for (const Mesh& mesh : scene.meshes) in_memory.push_back(in_memory.back() + std::uint32_t(mesh.triangles.size()));
    if (scene.instances.empty()) {
        for (std::size_t i = 0; i < scene.meshes.size(); ++i)
            collect_triangles(scene, scene.meshes[i], glm::dmat4(1.0), {in_memory[i], in_memory[i]}, most_points,
                              lights);
        return;
    }
    const std::vector<std::uint32_t> numbers = first_light_numbers(scene);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const MeshInstance& instance = scene.instances[i];
        if (moves(instance)) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        const glm::dmat4 transform(instance.transform);
        const std::size_t before = lights.triangles.size();
        collect_triangles(scene, mesh, transform, {numbers[i], in_memory[instance.mesh]}, most_points, lights);
        if (lights.triangles.size() != before) grow_instance_errors(mesh, transform, lights.data);
    }
}

bool shines_far(const Light& light) { return traits_of(light.kind)->far; }
const LightTraits& traits_of(const PunctualLight& light) { return *traits_of(LightKind(light.kind)); }

PunctualLight punctual_light(const Light& light) {
    PunctualLight data{};
    data.x = light.position.x, data.y = light.position.y, data.z = light.position.z;
    data.intensity_r = light.intensity.x, data.intensity_g = light.intensity.y, data.intensity_b = light.intensity.z;
    data.kind = std::uint32_t(light.kind);
    const glm::vec3 direction = glm::normalize(light.direction);
    data.direction_x = direction.x, data.direction_y = direction.y, data.direction_z = direction.z;
    // As in KHR_lights_punctual, except for its minimum difference of cosines, 0.001, which would widen narrow edges.
    constexpr double least_difference = 0x1p-22;  // the resolution of float32
    const double outer = std::cos(double(light.outer_angle));
    const double inner = shines_far(light) ? 1 : std::cos(double(light.inner_angle));
    const double scale = 1 / std::max(least_difference, inner - outer);
    if (traits_of(light.kind)->cone) data.cone_scale = float(scale), data.cone_offset = float(-outer * scale);
    data.inverse_range = light.range > 0.f ? 1.f / light.range : 0.f;
    if (has_linear_range(light)) data.inverse_range = -data.inverse_range;
    data.attenuation_0 = light.attenuation.x, data.attenuation_1 = light.attenuation.y;
    data.attenuation_2 = light.attenuation.z;
    return data;
}

/// For the light collected last.
void add_hot_spot(const HotSpotPlace& place, Lights& lights) {
    const double before = lights.hot_spots.empty() ? 0 : lights.hot_spots.back().last + 1.0;
    const double numbers = std::round(place.probability * 4294967296.0);
    if (!(numbers >= 1)) return;
    PunctualLight& light = lights.punctual.back();
    light.direction_x = place.way.x, light.direction_y = place.way.y, light.direction_z = place.way.z;
    light.cone_scale = float(numbers / 4294967296.0);
    lights.hot_spots.push_back({std::uint32_t(before + numbers - 1), light.cone_scale,
                                std::uint32_t(lights.triangles.size() + lights.punctual.size() - 1), 0, 0});
}

/// Infinite without a range. A range that ends far beyond the scene counts as none: then the light tree opens clusters,
/// and lists need no grid. Kernels heed it all the same, since the scene may grow.
float reach_of(const Lights& lights, const PunctualLight& light) {
    const float range = range_of(light);
    const double farthest = glm::length(glm::dvec3(light.x, light.y, light.z) - lights.center) + lights.radius;
    const bool far_beyond = light.inverse_range > 0 && range > 256 * farthest;
    return range > 0 && !far_beyond ? range : std::numeric_limits<float>::infinity();
}

/// Without a range if it ends far beyond the scene.
PunctualLight light_within(const Lights& lights, PunctualLight light) {
    if (std::isinf(reach_of(lights, light))) light.inverse_range = 0;
    return light;
}

bool has_place(const Light& light) { return !shines_far(light) && luminance(light.intensity) > 0; }

/// Makes the grid of lights with a position. Returns the longest reach in it; 0 if there is no grid.
float plant_grid(const Scene& scene, Lights& lights) {
    std::vector<PunctualLight> listed;
    for (const Light& light : scene.lights)
        if (has_place(light)) listed.push_back(light_within(lights, punctual_light(light)));
    std::vector<float> reaches;
    for (const PunctualLight& light : listed) reaches.push_back(reach_of(lights, light));
    std::sort(reaches.begin(), reaches.end());
    const auto shorter = [&] {  // first without all unlimited ones
        const auto limited = std::lower_bound(reaches.begin(), reaches.end(), std::numeric_limits<float>::infinity());
        return std::size_t(limited == reaches.end() ? reaches.size() / 2 : limited - reaches.begin());
    };
    for (; !reaches.empty() && lights.selection.most_per_cell > 0; reaches.resize(shorter())) {
        const float longest = reaches.back();
        std::erase_if(listed, [&](const PunctualLight& light) { return reach_of(lights, light) > longest; });
        if (listed.size() < 2) break;
        if (mean_list_length(listed) > lights.selection.most_per_cell) continue;
        lights.lists = build_light_lists(listed);
        return longest;
    }
    return 0;
}

/// Near lights, far ones, and those of the grid; black ones are left out.
void collect_punctual(const Scene& scene, Lights& lights) {
    std::map<std::size_t, HotSpotPlace> places;
    if (lights.selection.hot_spots)
        for (const HotSpotPlace& place : find_hot_spots(scene)) places[place.light] = place;
    const float longest = plant_grid(scene, lights);
    enum Group { near, far, of_grid };
    const auto group_of = [&](const PunctualLight& light) {
        if (traits_of(light).far) return far;
        return reach_of(lights, light) <= longest ? of_grid : near;
    };
    for (const Group group : {near, far, of_grid}) {
        if (group == of_grid) lights.data.first_listed = std::uint32_t(lights.punctual.size());
        for (std::size_t i = 0; i < scene.lights.size(); ++i) {
            const PunctualLight light = punctual_light(scene.lights[i]);
            if (group_of(light) != group || !(luminance(scene.lights[i].intensity) > 0)) continue;
            lights.punctual.push_back(light), lights.punctual_sources.push_back(std::uint32_t(i));
            if (const auto place = places.find(i); place != places.end()) add_hot_spot(place->second, lights);
        }
    }
    lights.data.hot_spots = std::uint32_t(lights.hot_spots.size());
    lights.data.not_to_hot_spots = 1.f;
    if (!lights.hot_spots.empty())
        lights.data.not_to_hot_spots = float(1 - (lights.hot_spots.back().last + 1.0) / 4294967296.0);
}

/// A light's largest intensity per steradian.
double intensity_of(const TriangleLight& l) {
    return std::abs(l.area) * luminance({l.emission_r, l.emission_g, l.emission_b});
}

/// `radius` of the scene: attenuation other than the inverse square is evaluated at half of it, as a typical distance.
double intensity_of(const PunctualLight& l, double radius) {
    const double intensity = luminance({l.intensity_r, l.intensity_g, l.intensity_b});
    if (l.attenuation_0 == 0.f && l.attenuation_1 == 0.f) return intensity / l.attenuation_2;
    const double d = 0.5 * radius;
    return intensity * d * d / (l.attenuation_0 + d * (l.attenuation_1 + d * l.attenuation_2));
}

double power_of(const TriangleLight& l) { return 2 * pi * intensity_of(l); }

double power_of(const PunctualLight& l, double radius) {
    if (traits_of(l).far) return luminance({l.intensity_r, l.intensity_g, l.intensity_b}) * pi * radius * radius;
    if (!traits_of(l).cone) return 4 * pi * intensity_of(l, radius);
    const double outer = -l.cone_offset / l.cone_scale, inner = outer + 1 / l.cone_scale;
    return 2 * pi * intensity_of(l, radius) * (1 - 0.5 * (outer + inner));
}

LightBounds bounds_of(const TriangleLight& l) {
    const glm::vec3 a(l.v0x, l.v0y, l.v0z), e1(l.e1x, l.e1y, l.e1z), e2(l.e2x, l.e2y, l.e2z);
    LightBounds bounds;
    bounds.box.grow(a), bounds.box.grow(a + e1), bounds.box.grow(a + e2);
    bounds.axis = glm::vec3(glm::normalize(glm::cross(glm::dvec3(e1), glm::dvec3(e2))));
    bounds.two_sided = l.area > 0;
    bounds.reach = float(pi / 2);
    return bounds;
}

LightBounds bounds_of(const PunctualLight& l) {
    LightBounds bounds;
    bounds.box.grow({l.x, l.y, l.z});
    bounds.axis = {l.direction_x, l.direction_y, l.direction_z};
    const bool cone = traits_of(l).cone;
    bounds.spread = cone ? 0.f : float(pi);
    if (cone) bounds.cone_scale = l.cone_scale;
    bounds.range = range_of(l);
    bounds.reach = cone ? float(std::acos(std::clamp(-double(l.cone_offset) / l.cone_scale, -1.0, 1.0))) : float(pi);
    return bounds;
}

/// Builds the tree over near lights. It uses intensities and cosines instead of power: the power of a spot says little
/// about the few directions in which it emits.
void plant_tree(Lights& lights, double radius) {
    std::vector<LightBounds> bounds;
    for (const TriangleLight& light : lights.triangles)
        bounds.push_back(bounds_of(light)), bounds.back().intensity = float(intensity_of(light));
    for (const PunctualLight& light : std::span(lights.punctual).first(lights.data.near - lights.triangles.size()))
        bounds.push_back(bounds_of(light_within(lights, light))),
            bounds.back().intensity = float(intensity_of(light, radius));
    LightTree tree = build_light_tree(bounds);
    lights.tree = std::move(tree.nodes), lights.leaves = std::move(tree.leaves);
    for (std::size_t i = 0; i < lights.triangles.size(); ++i)
        lights.trails.push_back({lights.triangles[i].primitive, tree.trails[i], tree.places[i]});
    for (HotSpot& spot : lights.hot_spots)
        if (spot.light < lights.data.near) spot.trail = tree.trails[spot.light], spot.leaf = tree.places[spot.light];
    const double begin = lights.lists.empty() ? 0 : lights.data.grid_last + 1.0;
    lights.data.tree_probability = float((lights.data.tree_last + 1.0 - begin) / 4294967296.0);
}

/// Near lights (the first ones) and far ones get at least a quarter of the probability each.
void balance(std::vector<double>& powers, std::size_t near) {
    double of_near = 0, of_far = 0;
    for (std::size_t i = 0; i < powers.size(); ++i) (i < near ? of_near : of_far) += powers[i];
    if (!(of_near > 0 && of_far > 0)) return;
    const double share = std::clamp(of_far / (of_near + of_far), 0.25, 0.75);
    const double factor = share / (1 - share) * of_near / of_far;
    for (std::size_t i = near; i < powers.size(); ++i) powers[i] *= factor;
}

/// A black environment is neither seen nor sampled.
void collect_environment(const Scene& scene, Lights& lights) {
    if (scene.environment.images.empty()) return;
    EnvironmentImage image = environment_image(scene.environment, lights.selection.compensates);
    if (!(image.integral > 0)) return;
    const double turn = scene.environment.rotation / (2 * pi);
    lights.data.environment = {image.width,    image.height,  float(turn - std::floor(turn)),
                               image.baseline, image.density, 0.f};
    lights.environment_texels = std::move(image.texels);
    lights.environment_cdf = std::move(image.cdf);
    lights.environment_power = image.integral * pi * lights.radius * lights.radius;
}

/// Which of both groups matters depends on the place: each gets at least a quarter.
double power_of_grid(const Lights& lights, double others) {
    double power = 0;
    for (const PunctualLight& light : std::span(lights.punctual).last(lights.listed()))
        power += power_of(light, lights.radius);
    return others > 0 && power > 0 ? std::clamp(power, others / 3, 3 * others) : power;
}

/// Computes the probabilities of lights.
void distribute(Lights& lights) {
    const double environment = lights.environment_power, radius = lights.radius;
    std::vector<double> powers;
    for (const TriangleLight& light : lights.triangles) powers.push_back(power_of(light));
    const auto others = std::span(lights.punctual).first(lights.punctual.size() - lights.listed());
    for (const PunctualLight& light : others) powers.push_back(power_of(light, radius));
    const auto far = std::size_t(
        std::count_if(others.begin(), others.end(), [](const auto& light) { return traits_of(light).far; }));
    const std::size_t near = powers.size() - far;
    if (environment > 0) powers.push_back(environment);
    balance(powers, near);

    double total = 0;
    for (const double power : powers) total += power;
    const double of_grid = power_of_grid(lights, total);
    total += of_grid;
    if (!(total > 0)) return;
    NumberShares shares(total, powers.size() + (lights.lists.empty() ? 0 : 1));
    LightsData& data = lights.data;
    if (!lights.lists.empty()) {
        const NumberShares::Share share = shares.next(of_grid);
        data.grid_last = share.last, data.grid_probability = share.probability;
    }
    for (std::size_t i = 0; i < powers.size(); ++i) {
        const NumberShares::Share share = shares.next(powers[i]);
        if (i < lights.triangles.size())
            lights.triangles[i].cumulative = share.last, lights.triangles[i].probability = share.probability;
        else if (i - lights.triangles.size() < others.size())
            lights.punctual[i - lights.triangles.size()].cumulative = share.last,
                                lights.punctual[i - lights.triangles.size()].probability = share.probability;
        else
            data.environment.probability = share.probability;
        if (i + 1 == near) data.tree_last = share.last;
    }
    data.triangles = std::uint32_t(lights.triangles.size());
    data.near = std::uint32_t(near);
    data.count = std::uint32_t(powers.size());
    if (!lights.triangles.empty()) data.density = float(2 * pi / total);
    if (near >= std::max<std::size_t>(lights.selection.for_a_tree, 2)) plant_tree(lights, radius);
}

bool has_lamp(const Scene& scene, const Mesh& mesh) {
    const auto shines = [&](std::uint32_t material) { return scene.materials[material].emission != glm::vec3(0.f); };
    return mesh.materials.empty() ? !mesh.triangles.empty() && shines(0)
                                  : std::any_of(mesh.materials.begin(), mesh.materials.end(), shines);
}

}  // namespace

bool has_falloff(const Light& light) {
    const bool physical = light.range == 0.f && light.attenuation == glm::vec3(0.f, 0.f, 1.f);
    return !shines_far(light) && !physical;
}

bool has_linear_range(const Light& light) { return light.linear_range && light.range > 0 && !shines_far(light); }

float range_of(const PunctualLight& light) {
    return light.inverse_range == 0.f ? 0.f : 1 / std::abs(light.inverse_range);
}

std::size_t near_lights(const Scene& scene) {
    std::size_t count = 0;
    for (const Light& light : scene.lights) count += has_place(light);
    std::vector<std::size_t> of_meshes;
    for (const Mesh& mesh : scene.meshes) {
        of_meshes.push_back(0);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            of_meshes.back() += luminance(scene.materials[mesh.materials.empty() ? 0 : mesh.materials[i]].emission) > 0;
        if (scene.instances.empty()) count += of_meshes.back();
    }
    for (const MeshInstance& instance : scene.instances) count += moves(instance) ? 0 : of_meshes[instance.mesh];
    return count;
}

bool may_have_lists(const Scene& scene) {
    std::size_t limited = 0, unlimited = 0;
    for (const Light& light : scene.lights) {
        if (!has_place(light)) continue;
        ++(light.range > 0 ? limited : unlimited);
    }
    return limited > 1 || (limited + unlimited > 1 && double(unlimited) <= LightSelection{}.most_per_cell);
}

Lights collect_lights(const Scene& scene, const LightSelection& selection) {
    Lights lights;
    lights.selection = selection;
    const Bounds bounds = bounds_of(scene);
    if (!bounds.empty()) {
        lights.center = bounds.center();
        lights.radius = std::max(0.5 * glm::length(glm::dvec3(bounds.extent())), 1e-18);
    }
    collect_environment(scene, lights);
    replace_triangle_lights(scene, lights);
    return lights;
}

void replace_triangle_lights(const Scene& scene, Lights& lights) {
    lights.triangles.clear(), lights.triangle_materials.clear(), lights.lamps.clear();
    lights.data.instance_error = lights.data.instance_reach = 0;
    collect_triangles(scene, lights.selection.most_points, lights);
    if (std::all_of(lights.lamps.begin(), lights.lamps.end(), [](auto lamp) { return lamp == CLARAY_NO_MAP; }))
        lights.lamps.clear();
    replace_punctual_lights(scene, lights);
}

void replace_punctual_lights(const Scene& scene, Lights& lights) {
    lights.punctual.clear(), lights.punctual_sources.clear(), lights.hot_spots.clear();
    lights.tree.clear(), lights.leaves.clear(), lights.trails.clear(), lights.lists.clear();
    LightsData& data = lights.data;
    data.triangles = data.near = data.count = data.tree_last = data.grid_last = data.first_listed = 0;
    data.density = data.tree_probability = data.grid_probability = data.environment.probability = 0;
    collect_punctual(scene, lights);
    distribute(lights);
}

std::vector<std::uint32_t> first_light_numbers(const Scene& scene) {
    std::vector<bool> shining;
    for (const Mesh& mesh : scene.meshes) shining.push_back(has_lamp(scene, mesh));
    std::vector<std::uint32_t> first;
    std::uint64_t numbers = 0;
    for (const MeshInstance& instance : scene.instances) {
        // Meshes baked into the world are always included: their triangles are numbered consecutively.
        const bool counts = shining[instance.mesh] || instance.transform == glm::mat4(1.f);
        first.push_back(counts ? std::uint32_t(numbers) : 0u);
        if (counts) numbers += scene.meshes[instance.mesh].triangles.size();
    }
    if (numbers > 0xffffffffu)
        throw Error(ErrorKind::user, "instances of objects that shine have more than 2^32 triangles",
                    "put what shines into a mesh of its own");
    return first;
}

}  // namespace claray
