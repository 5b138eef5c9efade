// A tree over lights, for sampling a light by its importance at a point.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// The input of the tree for one light.
struct LightBounds {
    Bounds box;
    glm::vec3 axis{0, 0, 1};  // of the cone of directions of its largest intensity
    float spread = 0;         // radians from the axis to the cone's border; pi: all directions
    float reach = 0;          // radians from there to where its light ends; unused for two-sided lights
    bool two_sided = false;   // emits by the cosine on both sides
    float cone_scale = 0;     // as in PunctualLight; 0: no cone with an edge
    float range = 0;          // 0: unlimited
    float intensity = 0;
};

struct LightTree {
    std::vector<LightNode> nodes;       // the first is the root
    std::vector<LightLeaf> leaves;      // in the order of the nodes above them
    std::vector<std::uint32_t> trails;  // for each light: LightTrail::trail
    std::vector<std::uint32_t> places;  // for each light: LightTrail::leaf
};

/// Builds the tree top down by a simple form of the surface area orientation heuristic (Conty Estevez and Kulla 2018,
/// section 4.4).
[[nodiscard]] LightTree build_light_tree(const std::vector<LightBounds>& lights);

}  // namespace claray
