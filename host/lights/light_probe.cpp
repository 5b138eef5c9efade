#include "host/lights/light_probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/base/in_parallel.hpp"
#include "host/base/percentile.hpp"
#include "host/base/random.hpp"
#include "host/lights/lights.hpp"
#include "host/lights/luminance.hpp"
#include "host/scene/camera.hpp"
#include "host/textures/cutouts.hpp"
#include "host/textures/mean_texel.hpp"
#include "host/textures/texture_use.hpp"
#include "host/trace/host_rays.hpp"

namespace claray {
namespace {

using std::numbers::pi;
constexpr double endless = std::numeric_limits<double>::infinity();
constexpr unsigned side = 32;            // of the grid of camera rays
constexpr unsigned bounces = 4;          // rays from each visible point, or surfaces along a path
constexpr std::size_t most_lights = 16;  // lights evaluated per point; of more lights this many are drawn at random
constexpr unsigned most_layers = 32;     // transparent surfaces along a ray
constexpr double grey = 0.5;             // albedo of surfaces that light others

/// Which surfaces stop a ray. Paths find lamps behind glass, but glass stops shadow rays to lights without extent.
enum class Through { openings, glass };

/// A point for which light is estimated.
struct ProbeSight {
    glm::dvec3 point, normal;  // normal on the viewer's side
    bool glows = false;        // emits visible light
    bool plain = false;        // its material emits nothing
    double distance = 0;       // from the viewer
    double passed = 0;         // distance of the last one-sided surface before it, seen from its back; 0: none
};

class Probe {
public:
    /// `lit` has the lights that count.
    Probe(const ProbedScene& probed, const Scene& lit)
        : scene_(probed.scene()),
          lit_(lit),
          rays_(probed.rays()),
          lights_(collect_lights(lit, {std::numeric_limits<std::size_t>::max(), 0, 32})) {
        const Bounds bounds = bounds_of(scene_);
        if (!bounds.empty()) nudge_ = 1e-6 * glm::length(glm::dvec3(bounds.extent()));
        for (const TriangleLight& light : lights_.triangles) last_numbers_.push_back(light.cumulative);
        for (const PunctualLight& light : lights_.punctual) last_numbers_.push_back(light.cumulative);
    }

    [[nodiscard]] std::optional<ProbeSight> look(const glm::dvec3& origin, const glm::dvec3& direction) const;
    [[nodiscard]] std::size_t lights() const { return lights_.size(); }
    /// Luminance of a grey surface there, lit by the lights and by surfaces that they light.
    [[nodiscard]] double lit_grey(const ProbeSight& sight, scenes::Random& random, unsigned& open) const;
    /// Of a white surface there, lit from around the scene, too.
    [[nodiscard]] double lit_white(const ProbeSight& sight, scenes::Random& random) const;

private:
    [[nodiscard]] const Material& material_of(const HostHit& hit) const {
        const Mesh& mesh = scene_.meshes[hit.mesh];
        return scene_.materials[mesh.materials.empty() ? 0 : mesh.materials[hit.triangle]];
    }
    [[nodiscard]] glm::vec2 coordinates(const TextureUse& use, const HostHit& hit) const;
    [[nodiscard]] bool glows_at(const HostHit& hit) const;
    [[nodiscard]] double opacity_of(const HostHit& hit) const;
    [[nodiscard]] bool passes(const HostHit& hit, const glm::dvec3& direction, Through through) const;
    [[nodiscard]] bool passes_back(const HostHit& hit, const glm::dvec3& direction) const {
        return material_of(hit).cull_back && glm::dot(hit.normal, direction) > 0;
    }
    [[nodiscard]] std::optional<HostHit> stop_of(const glm::dvec3& origin, const glm::dvec3& direction, double distance,
                                                 Through through, double* passed_back = nullptr) const;
    [[nodiscard]] double irradiance(const ProbeSight& sight, scenes::Random& random) const;
    [[nodiscard]] double background(const glm::dvec3& direction) const;
    [[nodiscard]] double from_light(std::size_t light, const ProbeSight& sight, scenes::Random& random) const;
    [[nodiscard]] double from_lamp(const TriangleLight& light, const ProbeSight& sight, scenes::Random& random) const;
    [[nodiscard]] double from_punctual(const PunctualLight& light, const ProbeSight& sight) const;

    const Scene& scene_;
    const Scene& lit_;
    const HostRays& rays_;
    Lights lights_;
    std::vector<std::uint32_t> last_numbers_;  // of all lights, see TriangleLight::cumulative
    double nudge_ = 1e-6;                      // offset of rays from surfaces and from lights
};

glm::vec2 Probe::coordinates(const TextureUse& use, const HostHit& hit) const {
    const Mesh& mesh = scene_.meshes[hit.mesh];
    const std::vector<glm::vec2>& uvs = use.uv_set == 0 ? mesh.uvs : mesh.uvs1;
    if (uvs.empty()) return transformed(use, glm::vec2(0.f));
    const glm::uvec3 t = mesh.triangles[hit.triangle];
    return transformed(use, float(1 - hit.u - hit.v) * uvs[t.x] + float(hit.u) * uvs[t.y] + float(hit.v) * uvs[t.z]);
}

bool Probe::glows_at(const HostHit& hit) const {
    const Material& material = material_of(hit);
    glm::vec3 emission = material.emission;
    if (emission == glm::vec3(0.f)) return false;
    if (material.emission_map.used()) {
        const Texture& texture = scene_.textures[material.emission_map.texture];
        emission *= glm::vec3(nearest_texel(texture, coordinates(material.emission_map, hit)));
    }
    return luminance(emission) >= visible_luminance;
}

double Probe::opacity_of(const HostHit& hit) const {
    const Material& material = material_of(hit);
    if (material.alpha_mode == AlphaMode::opaque) return 1;
    float opacity = material.opacity;
    const auto texel = [&](const TextureUse& use) {
        return nearest_texel(scene_.textures[use.texture], coordinates(use, hit));
    };
    if (material.albedo_map.used()) opacity *= texel(material.albedo_map).w;
    if (material.opacity_map.used()) opacity *= texel(material.opacity_map).x;
    return material.alpha_mode == AlphaMode::blend ? opacity : passes_alpha_test(material, opacity) ? 1 : 0;
}

bool Probe::passes(const HostHit& hit, const glm::dvec3& direction, Through through) const {
    const Material& material = material_of(hit);
    const bool glass =
        transmits(material.kind) || (material.kind == MaterialKind::principled && material.transmission > 0.5f);
    if (glass) return through == Through::glass;
    return passes_back(hit, direction) || opacity_of(hit) < 0.5;
}

/// The first surface that stops the ray. `passed_back`: the distance of the last back that the ray passes before.
std::optional<HostHit> Probe::stop_of(const glm::dvec3& origin, const glm::dvec3& direction, double distance,
                                      Through through, double* passed_back) const {
    const double step = nudge_ / glm::length(direction);
    double gone = 0;
    for (unsigned layer = 0; layer < most_layers; ++layer) {
        std::optional<HostHit> hit = rays_.closest(origin + gone * direction, direction, distance - gone);
        if (!hit) return {};
        hit->distance += gone;
        if (!passes(*hit, direction, through)) return hit;
        if (passed_back && passes_back(*hit, direction)) *passed_back = hit->distance;
        gone = hit->distance + step;
    }
    return {};
}

/// The surface that the camera sees along a ray; glass before an empty background counts as a surface.
std::optional<ProbeSight> Probe::look(const glm::dvec3& origin, const glm::dvec3& direction) const {
    double passed = 0;
    std::optional<HostHit> hit = stop_of(origin, direction, endless, Through::openings, &passed);
    if (!hit) return {};
    if (const auto behind = stop_of(origin, direction, endless, Through::glass)) hit = behind;
    const glm::dvec3 normal = glm::dot(hit->normal, direction) > 0 ? -hit->normal : hit->normal;
    const Material& material = material_of(*hit);
    const bool plain = material.emission == glm::vec3(0.f) && material.kind != MaterialKind::unlit;
    const glm::dvec3 point = origin + hit->distance * direction + nudge_ * normal;
    return ProbeSight{point, normal, glows_at(*hit), plain, hit->distance, passed};
}

/// Light from a random point of an emissive triangle, on the sides on which it emits.
double Probe::from_lamp(const TriangleLight& light, const ProbeSight& sight, scenes::Random& random) const {
    const glm::dvec3 e1(light.e1x, light.e1y, light.e1z), e2(light.e2x, light.e2y, light.e2z);
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const glm::dvec3 way = glm::dvec3(light.v0x, light.v0y, light.v0z) + u * e1 + v * e2 - sight.point;
    const double distance2 = glm::dot(way, way), cosine = glm::dot(way, sight.normal) / std::sqrt(distance2);
    double there = -glm::dot(way, glm::normalize(glm::cross(e1, e2))) / std::sqrt(distance2);
    if (light.area > 0) there = std::abs(there);
    if (!(cosine > 0 && there > 0)) return 0;
    const double end = 1 - nudge_ / std::sqrt(distance2);
    if (stop_of(sight.point, way, end, Through::glass)) return 0;
    const glm::dvec3 emission(light.emission_r, light.emission_g, light.emission_b);
    return luminance(emission) * std::abs(light.area) * cosine * there / distance2;
}

/// As in kernels/lights/kinds.clh.
double Probe::from_punctual(const PunctualLight& light, const ProbeSight& sight) const {
    const double intensity = luminance({light.intensity_r, light.intensity_g, light.intensity_b});
    const glm::dvec3 axis(light.direction_x, light.direction_y, light.direction_z);
    const LightTraits& kind = *traits_of(LightKind(light.kind));
    const glm::dvec3 way = kind.far ? -axis : glm::dvec3(light.x, light.y, light.z) - sight.point;
    const double distance2 = glm::dot(way, way), distance = std::sqrt(distance2);
    const double cosine = glm::dot(way, sight.normal) / distance;
    double arriving = intensity;
    if (!kind.far) {
        const double near = distance2 * light.inverse_range * light.inverse_range;
        const double share = light.inverse_range < 0 ? 1 - std::sqrt(near) : 1 - near * near;
        arriving *= std::max(share, 0.0) /
                    (light.attenuation_0 + light.attenuation_1 * distance + light.attenuation_2 * distance2);
    }
    if (!kind.far && kind.cone) {
        const double along = -glm::dot(axis, way) / distance;
        const double inside = std::clamp(along * light.cone_scale + light.cone_offset, 0.0, 1.0);
        arriving *= inside * inside;
    }
    if (!(cosine > 0 && arriving > 0)) return 0;
    return stop_of(sight.point, way, kind.far ? endless : 1.0, Through::openings) ? 0 : arriving * cosine;
}

double Probe::from_light(std::size_t light, const ProbeSight& sight, scenes::Random& random) const {
    const std::size_t lamps = lights_.triangles.size();
    return light < lamps ? from_lamp(lights_.triangles[light], sight, random)
                         : from_punctual(lights_.punctual[light - lamps], sight);
}

/// Luminance of the irradiance; an estimate if there are many lights.
double Probe::irradiance(const ProbeSight& sight, scenes::Random& random) const {
    const std::size_t count = last_numbers_.size();
    double sum = 0;
    if (count <= most_lights) {
        for (std::size_t i = 0; i < count; ++i) sum += from_light(i, sight, random);
        return sum;
    }
    for (std::size_t i = 0; i < most_lights; ++i) {
        const auto number = std::uint32_t(random.bits() >> 32);
        const auto found = std::lower_bound(last_numbers_.begin(), last_numbers_.end() - 1, number);
        const auto light = std::size_t(found - last_numbers_.begin());
        const double numbers = double(last_numbers_[light]) - (light > 0 ? double(last_numbers_[light - 1]) : -1.0);
        sum += from_light(light, sight, random) * 4294967296.0 / numbers;
    }
    return sum / double(most_lights);
}

/// A direction distributed by the cosine.
glm::dvec3 scattered(const glm::dvec3& normal, scenes::Random& random) {
    const glm::dvec3 in_ball(random.in_ball());
    return glm::normalize(normal + 0.999 * in_ball / std::max(glm::length(in_ball), 1e-9));
}

double Probe::lit_grey(const ProbeSight& sight, scenes::Random& random, unsigned& open) const {
    double arriving = irradiance(sight, random);
    for (unsigned i = 0; i < bounces; ++i) {
        const auto next = look(sight.point, scattered(sight.normal, random));
        next ? arriving += grey * irradiance(*next, random) / bounces : open += 1;
    }
    return grey / pi * arriving;
}

/// Radiance from where no surface is; as in kernels/lights/sky.clh and environment.clh.
double Probe::background(const glm::dvec3& direction) const {
    if (lit_.environment.images.empty())
        return luminance(glm::mix(lit_.sky.horizon, lit_.sky.zenith, float(std::clamp(direction.y, 0.0, 1.0))));
    const glm::vec2 at(std::atan2(direction.x, -direction.z) / (2 * pi) + 0.5,
                       std::acos(std::clamp(direction.y, -1.0, 1.0)) / pi);
    return double(lit_.environment.strength) * luminance(glm::vec3(nearest_texel(lit_.environment.images[0], at)));
}

double Probe::lit_white(const ProbeSight& sight, scenes::Random& random) const {
    constexpr unsigned paths = 64;  // noise would darken the log-average
    double sum = paths * irradiance(sight, random);
    for (unsigned i = 0; i < paths; ++i) {
        ProbeSight at = sight;
        double share = 1;
        for (unsigned bounce = 0; bounce < bounces; ++bounce) {
            const glm::dvec3 direction = scattered(at.normal, random);
            const std::optional<ProbeSight> next = look(at.point, direction);
            if (!next) {
                sum += share * pi * background(direction);
                break;
            }
            at = *next, share *= grey;
            sum += share * irradiance(at, random);
        }
    }
    return sum / (pi * paths);
}

/// The counts of one row of camera rays.
struct ProbedRow {
    unsigned seen = 0, lit = 0, visible = 0, open = 0, plain = 0, plain_lit = 0;
    std::vector<double> behind_backs;  // of each surface seen: as in LightProbe
    std::vector<double> luminances;    // of those that are lit

    void add(const ProbeSight& sight, double luminance, double depth_of_distance) {
        constexpr double part = 0.25;  // of the way from the back to the surface
        const bool is_lit = luminance >= visible_luminance;
        if (is_lit) luminances.push_back(luminance);
        seen += 1, lit += is_lit, visible += is_lit || sight.glows;
        plain += sight.plain, plain_lit += sight.plain && is_lit;
        const double place = sight.passed > 0 ? sight.passed + part * (sight.distance - sight.passed) : 0;
        behind_backs.push_back(place * depth_of_distance);
    }
    void add(const ProbedRow& row) {
        seen += row.seen, lit += row.lit, visible += row.visible, open += row.open;
        plain += row.plain, plain_lit += row.plain_lit;
        behind_backs.insert(behind_backs.end(), row.behind_backs.begin(), row.behind_backs.end());
        luminances.insert(luminances.end(), row.luminances.begin(), row.luminances.end());
    }
};

/// Calls `visit` with the surfaces of one row of camera rays, their directions and random numbers.
template <class Visit>
void look_along(const Probe& probe, const CameraData& camera, unsigned row, const Visit& visit) {
    scenes::Random random(row);
    for (unsigned column = 0; column < side; ++column) {
        const double x = 2 * (column + random.uniform()) / side - 1, y = 1 - 2 * (row + random.uniform()) / side;
        const CameraRay ray = camera_ray(camera, x, y);
        const glm::dvec3 direction = glm::normalize(ray.direction);
        if (const std::optional<ProbeSight> sight = probe.look(ray.origin, direction)) visit(*sight, direction, random);
    }
}

ProbedRow probe_row(const Probe& probe, const CameraData& camera, unsigned row) {
    ProbedRow found;
    const glm::dvec3 forward(camera.forward_x, camera.forward_y, camera.forward_z);
    look_along(probe, camera, row, [&](const ProbeSight& sight, const glm::dvec3& direction, scenes::Random& random) {
        const double luminance = probe.lit_grey(sight, random, found.open);
        found.add(sight, luminance, glm::dot(direction, forward));
    });
    return found;
}

struct SumOfLogarithms {
    double sum = 0;
    unsigned count = 0;
};

/// Adds a tube of four sides.
void add_tube(Mesh& mesh, const glm::vec4& a, const glm::vec3& b, std::uint32_t material) {
    const glm::vec3 begin(a), along = b - begin;
    const glm::vec3 other = std::abs(along.x) < std::abs(along.y) ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 u = glm::normalize(glm::cross(along, other)), v = glm::normalize(glm::cross(along, u));
    const auto first = std::uint32_t(mesh.positions.size());
    for (const glm::vec3& side : {u, v, -u, -v})
        mesh.positions.insert(mesh.positions.end(), {begin + a.w * side, b + a.w * side});
    for (std::uint32_t i = 0; i < 4; ++i) {
        const std::uint32_t here = first + 2 * i, next = first + 2 * ((i + 1) % 4);
        mesh.triangles.insert(mesh.triangles.end(), {{here, next, next + 1}, {here, next + 1, here + 1}});
    }
    mesh.materials.insert(mesh.materials.end(), 8, material);
}

void add_octahedron(Mesh& mesh, const glm::vec4& ball, std::uint32_t material) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {ball.w, -ball.w}) {
            mesh.positions.emplace_back(ball);
            mesh.positions.back()[axis] += side;
        }
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
        const std::uint32_t x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        const glm::uvec3 face(first + x, first + 2 + y, first + 4 + z);
        mesh.triangles.push_back((x + y + z) % 2 == 0 ? face : glm::uvec3(face.x, face.z, face.y));
    }
    mesh.materials.insert(mesh.materials.end(), 8, material);
}

/// Few triangles in the place of each primitive, for rays of the host. A disc counts as a ball.
Mesh stand_ins(const PrimitiveSet& set) {
    Mesh mesh;
    for (std::size_t i = 0; i < primitive_count(set); ++i) {
        const std::uint32_t material = set.materials.empty() ? 0 : set.materials[i];
        const glm::vec4* points = &set.points[are_curves(set) ? set.segments[i] : points_per_primitive(set.kind) * i];
        if (set.kind == PrimitiveSet::Kind::cylinders)
            add_tube(mesh, points[0], glm::vec3(points[1]), material);
        else if (are_curves(set))
            add_tube(mesh, points[1], glm::vec3(points[2]), material);
        else
            add_octahedron(mesh, points[0], material);
    }
    return mesh;
}

Scene with_stand_ins(Scene scene) {
    for (const PrimitiveSet& set : scene.primitives) {
        if (!scene.instances.empty()) scene.instances.push_back({std::uint32_t(scene.meshes.size())});
        scene.meshes.push_back(stand_ins(set));
    }
    scene.primitives.clear();
    return scene;
}

}  // namespace

ProbedScene::ProbedScene(const Scene& scene)
    : scene_(scene),
      with_stand_ins_(scene.primitives.empty() ? std::nullopt : std::optional(with_stand_ins(scene))),
      rays_(this->scene()) {}

LightProbe probe_light(const ProbedScene& scene, const Camera& camera, float aspect) {
    const Probe probe(scene, scene.scene());
    const CameraData view = camera_data(camera, aspect);
    std::vector<ProbedRow> rows(side);
    in_parallel(side, [&](std::size_t i) { rows[i] = probe_row(probe, view, unsigned(i)); });
    ProbedRow sum;
    for (const ProbedRow& row : rows) sum.add(row);
    LightProbe shares;
    shares.lights = probe.lights();
    if (sum.seen == 0) return shares;
    const double seen = sum.seen;
    shares.seen = seen / (side * side);
    shares.lit = sum.lit / seen, shares.visible = sum.visible / seen, shares.open = sum.open / (bounces * seen);
    shares.plain = sum.plain / seen, shares.plain_lit = sum.plain_lit / std::max(double(sum.plain), 1.0);
    shares.behind_backs = percentile(sum.behind_backs, 0.5);
    if (!sum.luminances.empty()) shares.brightness = percentile(sum.luminances, 0.75);
    return shares;
}

double log_average_of_white(const ProbedScene& scene, const Scene& lit, const Camera& camera, float aspect) {
    const Probe probe(scene, lit);
    const CameraData view = camera_data(camera, aspect);
    std::vector<SumOfLogarithms> rows(side);
    in_parallel(side, [&](std::size_t i) {
        look_along(probe, view, unsigned(i), [&](const ProbeSight& sight, const glm::dvec3&, scenes::Random& random) {
            const double bright = sight.glows ? 0 : probe.lit_white(sight, random);
            if (bright > 0) rows[i].sum += std::log(bright), ++rows[i].count;
        });
    });
    SumOfLogarithms all;
    for (const SumOfLogarithms& row : rows) all.sum += row.sum, all.count += row.count;
    return all.count > 0 ? std::exp(all.sum / all.count) : 0;
}

}  // namespace claray
