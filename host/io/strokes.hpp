// Points and lines as surfaces that rays can meet: spheres and tubes, as primitives or as triangles.
#pragma once

#include "claray/io.hpp"

namespace claray {

/// A mesh whose triangles are points (a, a, a) and segments (a, b, b): strokes that have no width yet.
using Strokes = Mesh;

/// The default radius: a 400th of the diagonal of the scene's `bounds`, less if there are so many strokes that they
/// would hide each other.
[[nodiscard]] float stroke_radius(const Bounds& bounds, std::size_t strokes);

/// A sphere for each vertex that a stroke has and a tube for each segment, with the vertices' coordinates and colours
/// and the strokes' materials. The more there are, the coarser they are.
[[nodiscard]] Mesh solid_strokes(const Strokes& strokes, float radius);

/// Adds strokes that stand in the world to a scene. They become primitives, exactly round, where their materials have
/// no maps and let no ray through, else triangles; a few lamps are triangles, too, which are sampled as lights.
/// `radius`: empty for the default; 0 leaves them out. A warning tells the radius. Throws ErrorKind::usage if it is
/// negative or not finite.
void add_strokes(Scene& scene, const std::vector<Strokes>& strokes, std::optional<float> radius, Warnings& warnings);

}  // namespace claray
