// A tree over lights, for sampling a light by its importance at a point.
#pragma once

#include <vector>

#include "claray/scene.hpp"

namespace claray {

/// The input of the tree for one light.
struct LightBounds {
    Bounds box;
    glm::vec3 axis{0, 0, 1};  // of the cone that holds the directions in which it shines most
    float spread = 0;         // radians from the axis to the cone's border; pi: everywhere
    float reach = 0;          // radians from there to where its light ends; not of two-sided ones
    bool two_sided = false;   // shines by the cosine to both sides
    float intensity = 0;
};

struct LightTree {
    std::vector<LightNode> nodes;       // the first is the root
    std::vector<LightLeaf> leaves;      // in the order in which they hang below the nodes
    std::vector<std::uint32_t> trails;  // of every light: LightTrail::trail
    std::vector<std::uint32_t> places;  // of every light: LightTrail::leaf
};

/// Top down, by the surface area orientation heuristic in a simple form (Conty Estevez and Kulla 2018, section 4.4).
[[nodiscard]] LightTree build_light_tree(const std::vector<LightBounds>& lights);

}  // namespace claray
