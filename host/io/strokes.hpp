// Points and lines as surfaces that rays can meet: spheres and tubes, as primitives or as triangles.
#pragma once

#include "claray/scene.hpp"

namespace claray {

/// A mesh whose triangles are points (a, a, a) and segments (a, b, b): strokes that have no width yet.
using Strokes = Mesh;

/// The default radius: a 400th of the diagonal of the scene's `bounds`, less if there are so many strokes that they
/// would hide each other.
[[nodiscard]] float stroke_radius(const Bounds& bounds, std::size_t strokes);

/// A sphere for each vertex that a stroke has and a tube for each segment, with the vertices' coordinates and colours
/// and the strokes' materials. The more there are, the coarser they are.
[[nodiscard]] Mesh solid_strokes(const Strokes& strokes, float radius);

/// Whether primitives show the strokes as well as triangles: their materials have no maps, let no ray through, and are
/// no lamps, which would not be sampled as lights.
[[nodiscard]] bool suit_primitives(const Strokes& strokes, const std::vector<Material>& materials);

/// The same spheres and tubes as primitives, exactly round.
[[nodiscard]] std::vector<PrimitiveSet> primitive_strokes(const Strokes& strokes, float radius);

}  // namespace claray
