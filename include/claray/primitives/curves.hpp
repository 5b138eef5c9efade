// Cubic curves with a radius at each control point: hair, grass, wires.
#pragma once

#include "claray/primitives/primitives.hpp"

#pragma GCC visibility push(default)
namespace claray {

enum class CurveBasis {
    bspline,  ///< uniform cubic B-spline; neighbouring segments share three control points
    bezier    ///< cubic Bezier
};
enum class CurveShape {
    round,  ///< the hull of spheres along the curve; seen from outside only
    flat    ///< a ribbon that faces every ray. Hit::v is the place across it, -1 to 1
};

/// The kind of such curves (kernels/primitives/curves.clh), made like a program's own. Hit::u is the place along the
/// segment, 0 to 1. A curve is drawn as at least eight straight pieces, none of them farther from the exact curve than
/// a 32nd of the segment's largest radius (at most 128 pieces).
[[nodiscard]] PrimitiveKind curve_kind(CurveShape shape);

/// The data of segments for curve_kind: 16 floats each. Write it to Primitives::data() and refit or rebuild to move
/// curves. Arguments and errors as of build_curves.
[[nodiscard]] std::vector<float> curve_data(std::span<const glm::vec4> points, std::span<const std::uint32_t> segments,
                                            CurveBasis basis);

/// Builds a structure over segments; a segment has four control points in a row, from its index on. `points` hold x, y,
/// z and radius. Segments with a coordinate that is not finite or without a positive radius are left out. Throws
/// ErrorKind::user if a segment reaches beyond the control points.
[[nodiscard]] Primitives build_curves(const Device& device, std::span<const glm::vec4> points,
                                      std::span<const std::uint32_t> segments, CurveBasis basis, CurveShape shape,
                                      const Bvh::Config& config);
[[nodiscard]] Primitives build_curves(const Device& device, std::span<const glm::vec4> points,
                                      std::span<const std::uint32_t> segments, CurveBasis basis = CurveBasis::bspline,
                                      CurveShape shape = CurveShape::round);

}  // namespace claray
#pragma GCC visibility pop
