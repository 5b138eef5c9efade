#include "claray/primitives/curves.hpp"

#include <bit>

namespace claray {
namespace {

/// The words that kernels/primitives/curves.clh reads.
Buffer<float> upload(const Device& device, std::span<const glm::vec4> points, std::span<const std::uint32_t> segments) {
    std::vector<float> words = {std::bit_cast<float>(std::uint32_t(points.size())), 0, 0, 0};
    words.reserve(4 + 4 * points.size() + segments.size());
    for (const glm::vec4& p : points) words.insert(words.end(), {p.x, p.y, p.z, p.w});
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (std::size_t(segments[i]) + 4 > points.size())
            throw Error(ErrorKind::user, "curve segment " + std::to_string(i) + " begins at control point " +
                                             std::to_string(segments[i]) + ", but there are " +
                                             std::to_string(points.size()));
        words.push_back(std::bit_cast<float>(segments[i]));
    }
    return {device, words};
}

}  // namespace

PrimitiveKind curve_kind(CurveBasis basis, CurveShape shape) {
    std::string text;
    if (basis == CurveBasis::bezier) text += "#define CURVE_BEZIER 1\n";
    if (shape == CurveShape::flat) text += "#define CURVE_FLAT 1\n";
    return {"curves", text + "#include \"primitives/curves.clh\"\n", 0, true};
}

Primitives build_curves(const Device& device, std::span<const glm::vec4> points,
                        std::span<const std::uint32_t> segments, CurveBasis basis, CurveShape shape,
                        const Bvh::Config& config) {
    return Primitives::build(device, curve_kind(basis, shape), upload(device, points, segments),
                             std::uint32_t(segments.size()), config);
}

Primitives build_curves(const Device& device, std::span<const glm::vec4> points,
                        std::span<const std::uint32_t> segments, CurveBasis basis, CurveShape shape) {
    return build_curves(device, points, segments, basis, shape, {.builder = Builder::binned});
}

}  // namespace claray
