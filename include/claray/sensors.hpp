// Sensors: lidars, depth cameras and radars in scenes that move.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "claray/bvh.hpp"
#include "claray/scene.hpp"
#include "claray/shared/sensors/beams.h"

#pragma GCC visibility push(default)
#pragma GCC visibility push(default)
namespace claray {

/// The beams of a sensor, row by row. Rows are the rings of a lidar, or those of an image.
struct BeamPattern {
    std::uint32_t rows = 0, columns = 0;
    std::vector<SensorBeam> beams = {};  ///< directions of unit length
};

/// A lidar that turns round z: row i has the elevation elevations[i], in radians above the plane of x and y. Column j
/// is sent at the time j / columns, at the azimuth begin + turn * j / columns, from x towards y; a negative turn is
/// clockwise from above. Throws ErrorKind::usage for no elevations or columns, and for angles that are not finite.
[[nodiscard]] BeamPattern spinning_beams(std::span<const double> elevations, std::uint32_t columns, double begin,
                                         double turn);
/// A solid-state lidar that looks along x and sends rows from the top, each from left to right: evenly spaced angles
/// over the fields of view, in radians. Throws ErrorKind::usage for empty patterns and for fields of pi or more.
[[nodiscard]] BeamPattern raster_beams(std::uint32_t rows, std::uint32_t columns, double horizontal_fov,
                                       double vertical_fov);
/// A solid-state lidar with two prisms that turn, along x: its beams draw a rosette, one row in the order of time. Each
/// prism tilts the beam by fov / 4, so that both reach fov / 2 (first-order theory of Risley prisms: Marshall 1999,
/// "Risley prism scan patterns"). `first` and `second`: turns of the prisms in a scan, `phase` as a part of a turn:
/// what they have turned before. Throws ErrorKind::usage for no beams, and for fields of pi or more.
[[nodiscard]] BeamPattern rosette_beams(std::uint32_t beams, double fov, double first, double second, double phase);

/// How a camera's lens maps directions to its image. x is to the right, y down and z forwards.
enum class LensKind {
    pinhole,     ///< x / z and y / z, distorted (Brown 1966, "Decentering distortion of lenses")
    equidistant  ///< the angle to the axis, distorted (Kannala and Brandt 2006, "A generic camera model")
};

/// A camera's lens and image, in pixels. The centre of the first pixel is at (0, 0), as in OpenCV.
struct Lens {
    LensKind kind = LensKind::pinhole;
    double fx = 0, fy = 0, cx = 0, cy = 0;
    /// `pinhole`: k1, k2, p1, p2, k3 in OpenCV's order; `equidistant`: k1 to k4.
    std::array<double, 5> distortion = {};
};

/// The pixels of a camera. Row i is exposed at the time i / height (times `shutter`: 0 is a global shutter). A pixel
/// whose direction the lens does not reach has a direction of zero, and never a return. Throws ErrorKind::usage for
/// empty images and for a focal length that is not positive.
[[nodiscard]] BeamPattern camera_beams(std::uint32_t width, std::uint32_t height, const Lens& lens, double shutter);

/// The pose of a sensor whose frame is mapped to the world by these matrices at the begin and at the end of a scan.
/// Throws ErrorKind::usage if one is not a rotation with a translation, within 1e-4, or if the sensor turns by half a
/// turn or more.
[[nodiscard]] SensorPose sensor_pose(const glm::dmat4& begin, const glm::dmat4& end);

/// Which returns of a beam are kept, and how they are ordered.
enum class ReturnOrder : std::uint32_t {
    strongest = CLARAY_STRONGEST_FIRST,
    first = CLARAY_NEAREST_FIRST,
    last = CLARAY_FARTHEST_FIRST
};

/// A sensor. Lengths are in units of the scene, taken for metres; angles are in radians, times in seconds.
struct SensorConfig {
    BeamPattern pattern = {};
    std::uint32_t rays = 1;     ///< of a beam, 1 to 64
    std::uint32_t returns = 1;  ///< most of a beam, 1 to `rays`
    ReturnOrder order = ReturnOrder::strongest;
    /// Full angles of a beam, to the sides and up, at which its power falls to 1 / e^2 of its middle's.
    std::array<double, 2> divergence = {};
    float nearest = 0, farthest = 1000;  ///< ranges that are measured; what is nearer still hides what is behind
    /// Surfaces of a beam within these become one return.
    float range_resolution = 0.1f, velocity_resolution = INFINITY;
    /// Standard deviations: of ranges, of velocities, and of intensities relative to these.
    float range_noise = 0, velocity_noise = 0, intensity_noise = 0;
    float dropout = 0;          ///< probability that a return is lost
    float reference_range = 1;  ///< where a white surface has the intensity 1; 0: intensities don't fall with the range
    float extinction = 0;       ///< of the air, per unit of length
    float least_intensity = 0;  ///< weaker returns are lost
    float duration = 0.1f;      ///< of a scan; 0: velocities are 0
    bool in_world = false;      ///< places and normals in the world, instead of the frame of the sensor
    std::uint32_t seed = 0;     ///< of noise and dropouts
};

/// What sensors see: the triangles of a scene. Instances that do not move are one structure, as far as float32 allows
/// for; the others may move from scan to scan and within scans. A handle: copies share the world.
class SensorWorld {
public:
    /// `movers`: instances of the scene that may move; those that move in the scene may, too. `reflectances`: one for
    /// each material of the scene, relative to a white surface that scatters evenly. Empty: the red of their albedos,
    /// which is nearest to infrared. Primitives and cut-outs are not seen. Throws ErrorKind::usage for a scene without
    /// triangles, for numbers out of range, and for reflectances that are negative or not finite.
    [[nodiscard]] static SensorWorld build(const Device& device, const Scene& scene,
                                           std::span<const std::uint32_t> movers = {},
                                           std::span<const float> reflectances = {},
                                           Builder builder = Builder::automatic);

    /// The instances of the scene that may move, in increasing order.
    [[nodiscard]] const std::vector<std::uint32_t>& movers() const;
    /// Places all movers: where they are at the begin of the following scans, and at their end. Throws
    /// ErrorKind::usage if there are not as many matrices as movers.
    void move(std::span<const glm::mat4> begins, std::span<const glm::mat4> ends);

    [[nodiscard]] const Device& device() const;
    [[nodiscard]] std::size_t triangle_count() const;  ///< of all instances

    struct State;  ///< not for users

private:
    friend struct Internals;
    std::shared_ptr<State> state_;
};

/// A sensor on a device. A handle: copies share the buffers of rays.
class Sensor {
public:
    /// Throws ErrorKind::usage, beginning with the member's name, for a configuration that is out of range.
    Sensor(const Device& device, const SensorConfig& config);

    /// Scans the world from all poses and writes `returns` returns for each beam of each pose. The buffer must hold as
    /// many (`size`). Asynchronous. Noise is a function of the seed, of `number`, and of the indices of pose and beam.
    /// Results have the same bits on every device with float64. Throws ErrorKind::usage for another device's world, and
    /// for more than 2^32 - 2 rays or returns.
    void scan(const SensorWorld& world, std::span<const SensorPose> poses, std::uint32_t number,
              Buffer<SensorReturn>& returns);
    /// As above. Blocks.
    [[nodiscard]] std::vector<SensorReturn> scan(const SensorWorld& world, std::span<const SensorPose> poses,
                                                 std::uint32_t number = 0);

    /// Number of returns of a scan from so many poses.
    [[nodiscard]] std::size_t size(std::size_t poses) const;
    [[nodiscard]] const SensorConfig& config() const;
    [[nodiscard]] const Device& device() const;

    struct State;  ///< not for users

private:
    std::shared_ptr<State> state_;
};

}  // namespace claray
#pragma GCC visibility pop
#pragma GCC visibility pop
