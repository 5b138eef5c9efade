// The lights of a scene, as the kernels of lights/light.clh read them.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// How lights are picked.
struct LightSelection {
    std::size_t for_a_tree = 16;  ///< near lights from which on a tree picks among them
    /// Two or more lights with a position are picked by their contributions, from the lists of a grid, if the lists are
    /// at most so long (see mean_list_length). The lights of the longest ranges, first those without one, stay outside
    /// the grid until this holds. 0: no grid.
    double most_per_cell = 128;
    unsigned most_points = 1024;  ///< see mean_texel
    bool hot_spots = true;
    bool compensates = true;  ///< see environment_image; false where BSDF sampling finds less than all light
};

/// Host data of a scene's lights. Arrays that the scene does not need are empty.
struct Lights {
    std::vector<TriangleLight> triangles;
    std::vector<PunctualLight> punctual;                              // near ones, far ones, those of the grid
    std::vector<std::uint32_t> triangle_materials, punctual_sources;  // indices in the scene, of each of them
    std::vector<LightNode> tree;                                      // empty: lights are picked by power alone
    std::vector<LightLeaf> leaves;                                    // of the tree
    std::vector<LightTrail> trails;                                   // of triangles; only with a tree
    std::vector<std::uint32_t> lists;  // over the last lights of `punctual`; see build_light_lists
    std::vector<HotSpot> hot_spots;    // of points close to surfaces
    std::vector<std::uint32_t> lamps;  // of triangles; only with emission maps: see lights/light_triangle.clh
    std::vector<float> environment_texels, environment_cdf;
    LightsData data{};

    glm::dvec3 center{0};          // of the scene
    double radius = 1;             // of the scene
    double environment_power = 0;  // 0: no environment
    LightSelection selection;      // as passed to collect_lights

    [[nodiscard]] std::size_t listed() const { return lists.empty() ? 0 : punctual.size() - data.first_listed; }
    /// Number of lights for shadow rays, including the environment.
    [[nodiscard]] std::size_t size() const { return data.count + listed(); }
};

/// Returns whether there are lights for shadow rays.
[[nodiscard]] inline bool has_lights(const LightsData& data) { return data.count != 0 || data.grid_probability > 0; }

/// Emissive triangles that can be hit, lights without extent, and the environment, each picked in proportion to its
/// radiant power: 2 pi times area times the luminance of its radiance (both sides emit), the luminance of its intensity
/// times the solid angle that it shines into, or, for lights from far away, of its irradiance times the scene's cross
/// section. If there are near and far lights, each group gets at least a quarter, because it depends on the place which
/// of them matter. Throws ErrorKind::user if a texel of the environment is negative or not finite.
[[nodiscard]] Lights collect_lights(const Scene& scene, const LightSelection& selection = {});

/// Replaces the lights that are not emissive triangles, and all probabilities. The radius of the scene is kept.
void replace_punctual_lights(const Scene& scene, Lights& lights);
/// The same with the emissive triangles.
void replace_triangle_lights(const Scene& scene, Lights& lights);

/// Returns whether a light has a range, or an attenuation other than the inverse square.
[[nodiscard]] bool has_falloff(const Light& light);
/// Returns whether its range ends linearly.
[[nodiscard]] bool has_linear_range(const Light& light);
/// The distance beyond which it does not shine; 0: none.
[[nodiscard]] float range_of(const PunctualLight& light);
/// An upper bound on the number of emissive triangles, points and spots; some triangles may be impossible to hit.
[[nodiscard]] std::size_t near_lights(const Scene& scene);
/// Returns whether lights of the scene may be picked from lists; a few more scenes than those whose lights are.
[[nodiscard]] bool may_have_lists(const Scene& scene);

/// Instance::tag: the number of an instance's first triangle among those of all instances with emissive objects,
/// ascending in the order of the instances; 0 for other instances. TriangleLight::primitive uses the same numbers.
[[nodiscard]] std::vector<std::uint32_t> first_light_numbers(const Scene& scene);

}  // namespace claray
