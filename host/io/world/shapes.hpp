// Shapes of scene files as triangles. Fronts are counter-clockwise and normals point outwards.
#pragma once

#include <functional>

#include "claray/mesh.hpp"

namespace claray {

/// A surface over 0..1 x 0..1 in `columns` x `rows` cells, with the coordinates (u, v). `at(u, v)` gives the place and
/// the unit normal there; triangles face the side to which their normals point.
struct SurfacePoint {
    glm::dvec3 position, normal;
};
[[nodiscard]] Mesh mesh_of_surface(unsigned columns, unsigned rows,
                                   const std::function<SurfacePoint(double u, double v)>& at);

/// A part of the sphere of radius 1 about z: longitudes up to `most_phi`, polar angles from `from_theta` to `to_theta`,
/// radians, along u and v.
[[nodiscard]] Mesh sphere_part(double most_phi, double from_theta, double to_theta);
/// 1,280 triangles of the area of a sphere of radius 1, for lamps: a convex body's light depends on its area alone.
[[nodiscard]] Mesh sphere_for_lamps();
/// A disc of radius 1 in z = 0 that faces +z, with a hole. u is the angle, v the radius.
[[nodiscard]] Mesh disc_part(double hole_radius, double most_phi);
/// A tube of radius 1 about z from z = 0 to 1. u is the angle, v the height.
[[nodiscard]] Mesh tube_part(double most_phi);
/// -1..1 in x and y, facing +z.
[[nodiscard]] Mesh square();
/// -1..1 on all axes, with a square of coordinates on each side.
[[nodiscard]] Mesh cube();

/// Moves the mesh in float64; normals by the inverse transpose. Fronts stay fronts where the transform mirrors.
void transform(Mesh& mesh, const glm::dmat4& to_world);
/// Exchanges fronts and backs, and turns the normals round.
void turn_round(Mesh& mesh);
/// Turns the triangles round that face away from the normals at their vertices.
void face_normals(Mesh& mesh);
/// Normals at vertices: those of the triangles there, weighed by their angles. Vertices of one place share a normal.
void add_smooth_normals(Mesh& mesh);
[[nodiscard]] double area_of(const Mesh& mesh);

}  // namespace claray
