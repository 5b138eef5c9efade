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
    std::vector<LightTrail> trails;       // of triangles, where there is a tree
    std::vector<HotSpot> hot_spots;       // of points close to surfaces
    std::vector<std::uint32_t> lamps;     // of triangles, where an image is on some: see lights/light_triangle.clh
    std::vector<float> environment_texels, environment_cdf;
    LightsData data{};

    /// Of those that shadow rays are sent to, the environment included.
    [[nodiscard]] std::size_t size() const { return data.count; }
};

/// With as many near lights, a tree picks among them.
inline constexpr std::size_t lights_for_a_tree = 16;

/// Emissive triangles that can be hit, lights without extent, and the environment, each picked in proportion to its
/// radiant power: 2 pi times area times the luminance of its radiance (both sides emit), the luminance of its intensity
/// times the solid angle that it shines into, or, for lights from far away, of its irradiance times the scene's cross
/// section. Where there are near lights and far ones, either get at least a quarter: which of them matter is a question
/// of place. Throws ErrorKind::user where a texel of the environment is negative or not finite.
/// `most_points`: see mean_texel.
[[nodiscard]] Lights collect_lights(const Scene& scene, std::size_t for_a_tree = lights_for_a_tree,
                                    unsigned most_points = 1024);

/// Whether a light has a range, or another attenuation than the inverse square.
[[nodiscard]] bool has_falloff(const Light& light);
/// Emissive triangles, points and spots, among them perhaps some that can't be hit.
[[nodiscard]] std::size_t near_lights(const Scene& scene);

/// Instance::tag: the number of an instance's first triangle among those of all instances whose objects shine.
/// Ascending in the order of the instances; 0 for those that don't. TriangleLight::primitive counts like this.
[[nodiscard]] std::vector<std::uint32_t> first_light_numbers(const Scene& scene);

}  // namespace claray
