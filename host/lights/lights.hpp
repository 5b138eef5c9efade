// The lights of a scene, as the kernels of lights/light.clh read them.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// Host data of a scene's lights. Arrays that the scene does not need are empty.
struct Lights {
    std::vector<TriangleLight> triangles;
    std::vector<PunctualLight> punctual;  // near ones before far ones
    std::vector<LightNode> tree;          // empty: lights are picked by power alone
    std::vector<LightLeaf> leaves;        // of the tree
    std::vector<LightTrail> trails;       // of triangles; only with a tree
    std::vector<HotSpot> hot_spots;       // of points close to surfaces
    std::vector<std::uint32_t> lamps;     // of triangles; only with emission maps: see lights/light_triangle.clh
    std::vector<float> environment_texels, environment_cdf;
    LightsData data{};

    double radius = 1;             // of the scene
    double environment_power = 0;  // 0: no environment
    std::size_t for_a_tree = 0;    // as passed to collect_lights
    unsigned most_points = 0;

    /// Number of lights for shadow rays, including the environment.
    [[nodiscard]] std::size_t size() const { return data.count; }
};

/// From this number of near lights on, a tree picks among them.
inline constexpr std::size_t lights_for_a_tree = 16;

/// Emissive triangles that can be hit, lights without extent, and the environment, each picked in proportion to its
/// radiant power: 2 pi times area times the luminance of its radiance (both sides emit), the luminance of its intensity
/// times the solid angle that it shines into, or, for lights from far away, of its irradiance times the scene's cross
/// section. If there are near and far lights, each group gets at least a quarter, because it depends on the place which
/// of them matter. Throws ErrorKind::user if a texel of the environment is negative or not finite. `most_points`: see
/// mean_texel.
[[nodiscard]] Lights collect_lights(const Scene& scene, std::size_t for_a_tree = lights_for_a_tree,
                                    unsigned most_points = 1024);

/// Replaces the lights that are not emissive triangles, and all probabilities. The radius of the scene is kept.
void replace_punctual_lights(const Scene& scene, Lights& lights);
/// The same with the emissive triangles.
void replace_triangle_lights(const Scene& scene, Lights& lights);

/// Returns whether a light has a range, or an attenuation other than the inverse square.
[[nodiscard]] bool has_falloff(const Light& light);
/// An upper bound on the number of emissive triangles, points and spots; some triangles may be impossible to hit.
[[nodiscard]] std::size_t near_lights(const Scene& scene);

/// Instance::tag: the number of an instance's first triangle among those of all instances with emissive objects,
/// ascending in the order of the instances; 0 for other instances. TriangleLight::primitive uses the same numbers.
[[nodiscard]] std::vector<std::uint32_t> first_light_numbers(const Scene& scene);

}  // namespace claray
