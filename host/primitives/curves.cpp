#include "claray/primitives/curves.hpp"

namespace claray {
namespace {

/// Appends a segment as Bezier control points. Neighbours compute the end that they share by the same expression.
void append_segment(std::vector<float>& data, const glm::vec4* p, CurveBasis basis) {
    const glm::vec4 a = p[0], b = p[1], c = p[2], d = p[3];
    const bool bezier = basis == CurveBasis::bezier;
    const glm::vec4 of_spline[] = {(a + 4.f * b + c) * (1.f / 6), (2.f * b + c) * (1.f / 3), (b + 2.f * c) * (1.f / 3),
                                   (b + 4.f * c + d) * (1.f / 6)};
    for (int i = 0; i < 4; ++i) {
        const glm::vec4& q = bezier ? p[i] : of_spline[i];
        data.insert(data.end(), {q.x, q.y, q.z, q.w});
    }
}

}  // namespace

std::vector<float> curve_data(std::span<const glm::vec4> points, std::span<const std::uint32_t> segments,
                              CurveBasis basis) {
    std::vector<float> data;
    data.reserve(16 * segments.size());
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (std::size_t(segments[i]) + 4 > points.size())
            throw Error(ErrorKind::user, "curve segment " + std::to_string(i) + " begins at control point " +
                                             std::to_string(segments[i]) + ", but there are " +
                                             std::to_string(points.size()));
        append_segment(data, &points[segments[i]], basis);
    }
    return data;
}

PrimitiveKind curve_kind(CurveShape shape) {
    const std::string flat = shape == CurveShape::flat ? "#define CURVE_FLAT 1\n" : "";
    return {"curves", flat + "#include \"primitives/curves.clh\"\n", 16, true};
}

Primitives build_curves(const Device& device, std::span<const glm::vec4> points,
                        std::span<const std::uint32_t> segments, CurveBasis basis, CurveShape shape,
                        const Bvh::Config& config) {
    const std::vector<float> data = curve_data(points, segments, basis);
    return Primitives::build(device, curve_kind(shape), Buffer<float>(device, data), std::uint32_t(segments.size()),
                             config);
}

Primitives build_curves(const Device& device, std::span<const glm::vec4> points,
                        std::span<const std::uint32_t> segments, CurveBasis basis, CurveShape shape) {
    return build_curves(device, points, segments, basis, shape, {.builder = Builder::binned});
}

}  // namespace claray
