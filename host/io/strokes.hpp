// Points and lines as surfaces that rays can meet: spheres and tubes.
#pragma once

#include "claray/mesh.hpp"

namespace claray {

/// A mesh whose triangles are points (a, a, a) and segments (a, b, b): strokes that have no width yet.
using Strokes = Mesh;

/// The default radius: a 400th of the diagonal of the scene's `bounds`, less if there are so many strokes that they
/// would hide each other.
[[nodiscard]] float stroke_radius(const Bounds& bounds, std::size_t strokes);

/// A sphere for each vertex that a stroke has and a tube for each segment, with the vertices' coordinates and colours
/// and the strokes' materials. The more there are, the coarser they are.
[[nodiscard]] Mesh solid_strokes(const Strokes& strokes, float radius);

}  // namespace claray
