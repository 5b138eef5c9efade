// The beams of spinning and solid-state lidars.
#include <cmath>
#include <numbers>

#include "claray/sensors.hpp"

namespace claray {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& is, const std::string& use) {
    throw Error(ErrorKind::usage, name + ": is " + is, use);
}

void check_count(const char* name, std::size_t count) {
    if (count == 0) refuse(name, "0", "use 1 or more");
}

void check_finite(const char* name, double value) {
    if (!std::isfinite(value)) refuse(name, std::to_string(value), "use a finite number");
}

void check_field(const char* name, double field) {
    if (!(field >= 0 && field < std::numbers::pi)) refuse(name, std::to_string(field), "use an angle below pi");
}

SensorBeam beam_at(double azimuth, double elevation, double time) {
    const double level = std::cos(elevation);
    return {float(level * std::cos(azimuth)), float(level * std::sin(azimuth)), float(std::sin(elevation)),
            float(time)};
}

/// Angle `i` of `count`, from +field / 2 to -field / 2.
double spread(double field, std::uint32_t i, std::uint32_t count) {
    return count == 1 ? 0 : field * (0.5 - double(i) / (count - 1));
}

}  // namespace

BeamPattern spinning_beams(std::span<const double> elevations, std::uint32_t columns, double begin, double turn) {
    check_count("elevations", elevations.size());
    check_count("columns", columns);
    check_finite("begin", begin);
    check_finite("turn", turn);
    BeamPattern pattern{std::uint32_t(elevations.size()), columns};
    for (const double elevation : elevations) {
        check_finite("elevations", elevation);
        for (std::uint32_t j = 0; j < columns; ++j) {
            const double time = double(j) / columns;
            pattern.beams.push_back(beam_at(begin + turn * time, elevation, time));
        }
    }
    return pattern;
}

BeamPattern raster_beams(std::uint32_t rows, std::uint32_t columns, double horizontal_fov, double vertical_fov) {
    check_count("rows", rows);
    check_count("columns", columns);
    check_field("horizontal_fov", horizontal_fov);
    check_field("vertical_fov", vertical_fov);
    BeamPattern pattern{rows, columns};
    const double all = double(rows) * columns;
    for (std::uint32_t i = 0; i < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j)
            pattern.beams.push_back(beam_at(spread(horizontal_fov, j, columns), spread(vertical_fov, i, rows),
                                            (double(i) * columns + j) / all));
    return pattern;
}

BeamPattern rosette_beams(std::uint32_t beams, double fov, double first, double second, double phase) {
    check_count("beams", beams);
    check_field("fov", fov);
    check_finite("first", first);
    check_finite("second", second);
    check_finite("phase", phase);
    BeamPattern pattern{1, beams};
    for (std::uint32_t i = 0; i < beams; ++i) {
        const double time = double(i) / beams;
        const double a = 2 * std::numbers::pi * (first * (phase + time));
        const double b = 2 * std::numbers::pi * (second * (phase + time));
        const double left = fov / 4 * (std::cos(a) + std::cos(b)), up = fov / 4 * (std::sin(a) + std::sin(b));
        const double off = std::hypot(left, up), scale = off > 0 ? std::sin(off) / off : 1;
        pattern.beams.push_back({float(std::cos(off)), float(scale * left), float(scale * up), float(time)});
    }
    return pattern;
}

}  // namespace claray
