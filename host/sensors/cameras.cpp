// The pixels of cameras as beams: the maps of lenses, inverted.
#include <cmath>
#include <optional>

#include "claray/sensors.hpp"

namespace claray {
namespace {

struct Derivatives {
    glm::dvec2 value;
    glm::dmat2 jacobian;  // columns: derivatives by x and by y
};

/// Brown's model: where an undistorted point of the plane z = 1 appears.
Derivatives distorted(const std::array<double, 5>& d, glm::dvec2 p) {
    const auto [k1, k2, p1, p2, k3] = d;
    const double x = p.x, y = p.y, r2 = x * x + y * y;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), slope = k1 + r2 * (2 * k2 + r2 * 3 * k3);  // by r2
    const double cross = 2 * x * y * slope + 2 * p1 * x + 2 * p2 * y;
    return {{x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y},
            {{radial + 2 * x * x * slope + 2 * p1 * y + 6 * p2 * x, cross},
             {cross, radial + 2 * y * y * slope + 6 * p1 * y + 2 * p2 * x}}};
}

/// By Newton's method from the middle, where every lens is undistorted. None if no step leads nearer, or if the image
/// folds before.
std::optional<glm::dvec2> undistorted(const std::array<double, 5>& distortion, glm::dvec2 seen) {
    glm::dvec2 p(0);
    for (int part = 1; part <= 8; ++part) {  // along the way from the middle, so that the solution is the nearest
        const glm::dvec2 wanted = seen * (part / 8.0);
        for (int step = 0; step < 30; ++step) {
            const Derivatives at = distorted(distortion, p);
            const glm::dvec2 rest = wanted - at.value;
            if (!(glm::determinant(at.jacobian) > 0)) return {};
            if (glm::length(rest) <= 1e-14 * (1 + glm::length(wanted))) break;
            p += glm::inverse(at.jacobian) * rest;
        }
        if (!(glm::length(distorted(distortion, p).value - wanted) <= 1e-9 * (1 + glm::length(wanted)))) return {};
    }
    return p;
}

/// The angle to the axis at which the distorted angle is `seen`; none beyond half a turn, or where the map turns back.
std::optional<double> undistorted_angle(const std::array<double, 5>& k, double seen) {
    constexpr double most = 3.14159265358979323846;
    const auto map = [&](double a) {
        return a * (1 + a * a * (k[0] + a * a * (k[1] + a * a * (k[2] + a * a * k[3]))));
    };
    const auto slope = [&](double a) {
        return 1 + a * a * (3 * k[0] + a * a * (5 * k[1] + a * a * (7 * k[2] + a * a * 9 * k[3])));
    };
    double low = 0, high = 0;
    while (map(high) < seen) {
        if (high >= most || !(slope(high) > 0)) return {};
        low = high, high = std::min(high + 0.01, most);
    }
    for (int step = 0; step < 60; ++step) (map(0.5 * (low + high)) < seen ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
}

glm::dvec3 direction_of(const Lens& lens, glm::dvec2 seen) {
    if (lens.kind == LensKind::pinhole) {
        const std::optional<glm::dvec2> p = undistorted(lens.distortion, seen);
        return p ? glm::normalize(glm::dvec3(*p, 1)) : glm::dvec3(0);
    }
    const double radius = glm::length(seen);
    const std::optional<double> angle = undistorted_angle(lens.distortion, radius);
    if (!angle) return glm::dvec3(0);
    const glm::dvec2 outwards = radius > 0 ? seen / radius : glm::dvec2(0);
    return {std::sin(*angle) * outwards, std::cos(*angle)};
}

}  // namespace

BeamPattern camera_beams(std::uint32_t width, std::uint32_t height, const Lens& lens, double shutter) {
    if (width == 0 || height == 0)
        throw Error(ErrorKind::usage, std::string(width == 0 ? "width" : "height") + ": is 0", "use 1 or more");
    if (!(lens.fx > 0 && lens.fy > 0) || !std::isfinite(lens.fx + lens.fy))
        throw Error(ErrorKind::usage,
                    "focal length: is " + std::to_string(lens.fx) + ", " + std::to_string(lens.fy) + " pixels",
                    "use positive numbers");
    if (!(shutter >= 0 && shutter <= 1))
        throw Error(ErrorKind::usage, "shutter: is " + std::to_string(shutter), "use a part of a scan, 0 to 1");
    BeamPattern pattern{height, width};
    for (std::uint32_t i = 0; i < height; ++i)
        for (std::uint32_t j = 0; j < width; ++j) {
            const glm::dvec3 d = direction_of(lens, {(j - lens.cx) / lens.fx, (i - lens.cy) / lens.fy});
            pattern.beams.push_back({float(d.x), float(d.y), float(d.z), float(shutter * i / height)});
        }
    return pattern;
}

}  // namespace claray
