#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "host/base/format.hpp"
#include "host/sensors/world_state.hpp"

namespace claray {
namespace {

constexpr std::uint32_t most_rays = 64;

void check_number(const char* name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw Error(ErrorKind::usage, name + printed(": is %.9g", value),
                printed("use a number from %.9g to %.9g", least, most));
}

void check_pattern(const BeamPattern& pattern) {
    if (pattern.beams.empty() || pattern.beams.size() != std::uint64_t(pattern.rows) * pattern.columns)
        throw Error(ErrorKind::usage, "pattern: has " + std::to_string(pattern.beams.size()) + " beams in " +
                                          std::to_string(pattern.rows) + " rows of " + std::to_string(pattern.columns));
    for (std::size_t i = 0; i < pattern.beams.size(); ++i) {
        const SensorBeam& b = pattern.beams[i];
        const double length = std::hypot(double(b.x), double(b.y), double(b.z));
        if (!(length == 0 || std::abs(length - 1) < 1e-5))
            throw Error(
                ErrorKind::usage,
                "pattern: the direction of beam " + std::to_string(i) + " has the length " + std::to_string(length),
                "use unit vectors");
        if (!(b.time >= 0 && b.time <= 1))
            throw Error(ErrorKind::usage,
                        "pattern: beam " + std::to_string(i) + " has the time " + std::to_string(b.time),
                        "use times from 0 to 1");
    }
}

void check(const SensorConfig& config) {
    check_pattern(config.pattern);
    check_number("rays", config.rays, 1, most_rays);
    if (config.returns < 1 || config.returns > config.rays)
        throw Error(ErrorKind::usage, printed("returns: is %u, and a beam has %u rays", config.returns, config.rays),
                    "use a number from 1 to the number of rays");
    for (const double angle : config.divergence) check_number("divergence", angle, 0, 1);
    const double most = 1e18;
    check_number("nearest", config.nearest, 0, most);
    check_number("farthest", config.farthest, config.nearest, most);
    check_number("range_resolution", config.range_resolution, 0, INFINITY);
    check_number("velocity_resolution", config.velocity_resolution, 0, INFINITY);
    check_number("range_noise", config.range_noise, 0, most);
    check_number("velocity_noise", config.velocity_noise, 0, most);
    check_number("intensity_noise", config.intensity_noise, 0, most);
    check_number("dropout", config.dropout, 0, 1);
    check_number("reference_range", config.reference_range, 0, most);
    check_number("extinction", config.extinction, 0, most);
    check_number("least_intensity", config.least_intensity, 0, most);
    check_number("duration", config.duration, 0, most);
}

/// Rays on a spiral that covers the beam evenly (Vogel 1979, "A better way to construct the sunflower head"), with the
/// power of a Gaussian beam at 1 / e^2 at its edge.
std::vector<BeamRay> rays_of_beam(const SensorConfig& config) {
    if (config.rays == 1) return {{1, 0, 0, 1}};
    std::vector<double> shares;
    double sum = 0;
    for (std::uint32_t i = 0; i < config.rays; ++i) sum += shares.emplace_back(std::exp(-2 * (i + 0.5) / config.rays));
    std::vector<BeamRay> rays;
    for (std::uint32_t i = 0; i < config.rays; ++i) {
        const double radius = std::sqrt((i + 0.5) / config.rays), angle = i * std::numbers::pi * (3 - std::sqrt(5));
        const double left = radius * std::cos(angle) * std::tan(config.divergence[0] / 2);
        const double up = radius * std::sin(angle) * std::tan(config.divergence[1] / 2);
        const double scale = 1 / std::sqrt(1 + left * left + up * up);
        rays.push_back({float(scale), float(scale * left), float(scale * up), float(shares[i] / sum)});
    }
    return rays;
}

glm::dquat rotation_of(const glm::dmat4& pose, const char* name) {
    const glm::dmat3 m(pose), rest = glm::transpose(m) * m - glm::dmat3(1);
    double worst = 0;
    for (int i = 0; i < 3; ++i) worst = std::max(worst, glm::length(rest[i]));
    const bool affine = pose[0][3] == 0 && pose[1][3] == 0 && pose[2][3] == 0 && pose[3][3] == 1;
    if (!(worst < 1e-4) || !affine || glm::determinant(m) < 0 || !std::isfinite(glm::length(glm::dvec3(pose[3]))))
        throw Error(ErrorKind::usage, std::string(name) + ": is not a rotation with a translation",
                    "use a matrix without scale and without reflection");
    return glm::normalize(glm::quat_cast(m));
}

}  // namespace

SensorPose sensor_pose(const glm::dmat4& begin, const glm::dmat4& end) {
    const glm::dquat from = rotation_of(begin, "pose");
    glm::dquat to = rotation_of(end, "pose_end");
    if (glm::dot(from, to) < 0) to = -to;
    if (glm::dot(from, to) < 1e-3)
        throw Error(ErrorKind::usage, "pose_end: half a turn from pose, so that the way between is not known",
                    "make scans shorter");
    SensorPose pose{};
    for (int i = 0; i < 3; ++i) pose.begin[i] = float(begin[3][i]), pose.end[i] = float(end[3][i]);
    const auto copy = [](const glm::dquat& q, float* turn) {
        turn[0] = float(q.x), turn[1] = float(q.y), turn[2] = float(q.z), turn[3] = float(q.w);
    };
    copy(from, pose.turn_begin), copy(to, pose.turn_end);
    return pose;
}

struct Sensor::State {
    Device device;
    SensorConfig config;
    Buffer<SensorBeam> beams;
    Buffer<BeamRay> beam_rays;
    // Kept from scan to scan.
    Buffer<SensorPose> poses = {};
    Buffer<Ray> rays = {};
    Buffer<Hit> hits = {};

    [[nodiscard]] SensorSettings settings(std::size_t sensors, std::uint32_t number,
                                          const SensorWorld::State& world) const;
    [[nodiscard]] Defines defines() const {
        return {{"RAYS_PER_BEAM", std::to_string(config.rays)}, {"RETURNS_PER_BEAM", std::to_string(config.returns)}};
    }
    [[nodiscard]] Range range(const std::string& kernel, std::size_t beams_in_all) const {
        const std::size_t each = std::max(1u, device.tuning(kernel, "BEAMS_PER_ITEM"));
        return {(beams_in_all + each - 1) / each, device.tuning(kernel, "GROUP_SIZE")};
    }
};

SensorSettings Sensor::State::settings(std::size_t sensors, std::uint32_t number,
                                       const SensorWorld::State& world) const {
    return {.sensors = std::uint32_t(sensors),
            .beams = std::uint32_t(config.pattern.beams.size()),
            .columns = config.pattern.columns,
            .order = std::uint32_t(config.order),
            .in_world = config.in_world ? 1u : 0u,
            .seed = config.seed,
            .scan = number,
            .fixed_places = world.fixed_places,
            .nearest = config.nearest,
            .farthest = config.farthest,
            .range_resolution = config.range_resolution,
            .velocity_resolution = config.velocity_resolution,
            .range_noise = config.range_noise,
            .intensity_noise = config.intensity_noise,
            .velocity_noise = config.velocity_noise,
            .dropout = config.dropout,
            .reference_range = config.reference_range,
            .extinction = config.extinction,
            .least_intensity = config.least_intensity,
            .duration = config.duration,
            .per_second = config.duration > 0 ? 1 / config.duration : 0};
}

Sensor::Sensor(const Device& device, const SensorConfig& config) {
    check(config);
    state_ = std::make_shared<State>(State{.device = device,
                                           .config = config,
                                           .beams = Buffer<SensorBeam>(device, config.pattern.beams),
                                           .beam_rays = Buffer<BeamRay>(device, rays_of_beam(config))});
}

std::size_t Sensor::size(std::size_t poses) const {
    return poses * state_->config.pattern.beams.size() * state_->config.returns;
}
const SensorConfig& Sensor::config() const { return state_->config; }
const Device& Sensor::device() const { return state_->device; }

void Sensor::scan(const SensorWorld& seen, std::span<const SensorPose> poses, std::uint32_t number,
                  Buffer<SensorReturn>& returns) {
    SensorWorld::State& world = state_of(seen);
    State& self = *state_;
    const std::size_t beams = poses.size() * self.config.pattern.beams.size(), rays = beams * self.config.rays;
    if (rays > 4'000'000'000)
        throw Error(ErrorKind::usage, "poses: " + std::to_string(rays) + " rays are too many for one scan",
                    "scan for fewer sensors at a time");
    if (returns.size() < size(poses.size()))
        throw Error(ErrorKind::usage, "returns: has room for " + std::to_string(returns.size()) + " of " +
                                          std::to_string(size(poses.size())) + " returns");
    if (beams == 0) return;
    self.poses.reserve(self.device, poses.size());
    self.poses.write(poses);
    self.rays.reserve(self.device, rays);
    const SensorSettings settings = self.settings(poses.size(), number, world);
    load_kernel(self.device, "sensors/send_beams.cl", "send_beams", self.defines())
        .run(self.range("sensors/send_beams", beams), settings, self.poses, self.beams, self.beam_rays, self.rays);
    Defines defines = self.defines();
    defines.emplace_back("FIXED", world.query ? "1" : "0");
    if (world.query) {
        self.hits.reserve(self.device, rays);
        world.query->run(self.rays, self.hits, std::uint32_t(rays));
    }
    const Range range = self.range("sensors/find_returns", beams);
    const auto find = [&](const auto&... structure) {
        load_kernel(self.device, "sensors/find_returns.cl", "find_returns", defines)
            .run(range, structure..., settings, self.poses, self.beams, self.beam_rays, self.rays, self.hits,
                 world.triangles, world.places, world.reflectances, returns);
    };
    if (!world.movers) return find();
    for (const auto& define : world.movers->defines()) defines.push_back(define);
    defines.emplace_back("MOVERS", "1");
    find(*world.movers);
}

std::vector<SensorReturn> Sensor::scan(const SensorWorld& world, std::span<const SensorPose> poses,
                                       std::uint32_t number) {
    std::vector<SensorReturn> results(size(poses.size()));
    auto returns = Buffer<SensorReturn>::under(state_->device, std::span(results));
    scan(world, poses, number, returns);
    returns.fetch(results);
    return results;
}

}  // namespace claray
