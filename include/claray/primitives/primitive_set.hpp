// Primitives of a scene on the host.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/scene.h"

#pragma GCC visibility push(default)
namespace claray {

/// Primitives of one kind, in world space. They are traced as they are, not as triangles. Round curves are seen from
/// outside only, the other kinds from both sides. Their materials have no maps and no opacity; those of curves do not
/// transmit light. Lights are not sampled on primitives: an emissive material shines, but is found by scattered rays
/// only.
struct PrimitiveSet {
    enum class Kind : std::uint32_t {
        spheres = CLARAY_SPHERES,
        discs = CLARAY_DISCS,
        cylinders = CLARAY_CYLINDERS,
        curves = CLARAY_CURVES,                ///< round uniform cubic B-splines
        bezier_curves = CLARAY_BEZIER_CURVES,  ///< round cubic Bezier curves
        flat_curves = CLARAY_FLAT_CURVES,      ///< ribbons along B-splines that face every ray
        flat_bezier_curves = CLARAY_FLAT_BEZIER_CURVES,
    };
    std::string name = {};
    Kind kind = Kind::spheres;
    /// Sphere: centre and radius. Disc: centre and radius; normal (of any length) and radius of the hole (0: none).
    /// Cylinder: one end and radius; the other end and 1 for closed ends or 0 for a tube. Curves: control points, each
    /// a place and the radius there. Primitives that are not finite or have no radius are left out.
    std::vector<glm::vec4> points = {};
    /// Of curves: for each primitive the index of its first control point, of four in a row.
    std::vector<std::uint32_t> segments = {};
    /// Linear RGB that multiplies the albedo, two per primitive: at the begin and at the end of a curve or of a
    /// cylinder's axis, the first for spheres and discs. 0..1; empty: white.
    std::vector<glm::vec3> colors = {};
    std::vector<std::uint32_t> materials = {};  ///< per primitive, indices into Scene::materials; empty: material 0
};

struct PrimitiveKindName {
    PrimitiveSet::Kind kind;
    const char* name;
};
inline constexpr PrimitiveKindName primitive_kind_names[] = {
    {PrimitiveSet::Kind::spheres, "spheres"},
    {PrimitiveSet::Kind::discs, "discs"},
    {PrimitiveSet::Kind::cylinders, "cylinders"},
    {PrimitiveSet::Kind::curves, "curves"},
    {PrimitiveSet::Kind::bezier_curves, "bezier curves"},
    {PrimitiveSet::Kind::flat_curves, "flat curves"},
    {PrimitiveSet::Kind::flat_bezier_curves, "flat bezier curves"}};

[[nodiscard]] inline bool are_curves(const PrimitiveSet& set) { return set.kind >= PrimitiveSet::Kind::curves; }
/// Points of a primitive that is not a curve.
[[nodiscard]] inline std::size_t points_per_primitive(PrimitiveSet::Kind kind) {
    return kind == PrimitiveSet::Kind::spheres ? 1 : 2;
}
/// The number of its primitives.
[[nodiscard]] inline std::size_t primitive_count(const PrimitiveSet& set) {
    return are_curves(set) ? set.segments.size() : set.points.size() / points_per_primitive(set.kind);
}
/// Returns a box around all primitives that are finite.
[[nodiscard]] Bounds bounds_of(const PrimitiveSet& set);

}  // namespace claray
#pragma GCC visibility pop
