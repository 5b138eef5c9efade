#include "host/render/lights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace claray {
namespace {

double luminance(const glm::vec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

/// As the acceleration structure sees it: others are left out there and can't be hit.
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

void collect_triangles(const Scene& scene, std::vector<TriangleLight>& lights) {
    std::uint32_t primitive = 0;
    for (const Mesh& mesh : scene.meshes)
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i, ++primitive) {
            const Material& material = scene.materials[mesh.materials.empty() ? 0 : mesh.materials[i]];
            const glm::vec3 emission = material.emission;
            if (!(luminance(emission) > 0) || material.emission_map.used()) continue;  // maps: found by chance alone
            const glm::uvec3 t = mesh.triangles[i];
            const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
            if (!can_be_hit(a, b, c)) continue;
            lights.push_back(triangle_light(a, b, c, emission));
            lights.back().primitive = primitive;
            if (!(lights.back().area > 0)) lights.pop_back();
        }
}

/// Hands out 2^32 numbers in proportion to power, at least one to every light, so that none is lost to rounding.
class Distribution {
public:
    Distribution(double total_power, std::size_t lights) : total_(total_power), left_(lights) {}

    template <class Light>
    void add(Light& light, double power) {
        --left_;
        sum_ += power;
        const double range = 4294967296.0;
        const auto ideal = std::uint64_t(std::clamp(std::round(sum_ / total_ * range), 0.0, range));
        const std::uint64_t end =
            left_ == 0 ? std::uint64_t(range) : std::clamp(ideal, begin_ + 1, std::uint64_t(range) - left_);
        light.cumulative = std::uint32_t(end - 1);
        light.probability = float(double(end - begin_) / range);
        begin_ = end;
    }

private:
    double total_, sum_ = 0;
    std::size_t left_;
    std::uint64_t begin_ = 0;
};

}  // namespace

Lights collect_lights(const Scene& scene) {
    Lights lights;
    collect_triangles(scene, lights.triangles);
    for (const Light& light : scene.lights) {
        if (!(luminance(light.intensity) > 0)) continue;
        lights.points.push_back({light.position.x, light.position.y, light.position.z, light.intensity.x,
                                 light.intensity.y, light.intensity.z, 0u, 0.f});
    }
    const auto power_of_triangle = [](const TriangleLight& l) {
        return 2 * std::numbers::pi * l.area * luminance({l.emission_r, l.emission_g, l.emission_b});
    };
    const auto power_of_point = [](const PointLightData& l) {
        return 4 * std::numbers::pi * luminance({l.intensity_r, l.intensity_g, l.intensity_b});
    };
    double total = 0;
    for (const TriangleLight& light : lights.triangles) total += power_of_triangle(light);
    for (const PointLightData& light : lights.points) total += power_of_point(light);
    Distribution distribution(total, lights.size());
    for (TriangleLight& light : lights.triangles) distribution.add(light, power_of_triangle(light));
    for (PointLightData& light : lights.points) distribution.add(light, power_of_point(light));
    if (!lights.triangles.empty()) lights.density = float(2 * std::numbers::pi / total);
    return lights;
}

}  // namespace claray
