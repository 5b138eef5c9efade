// What deferred shading reads back from the G-buffer: positions from depths, normals from codes.
#include <algorithm>
#include <cmath>

#include "claray/program.hpp"
#include "claray/renderer.hpp"
#include "host/base/format.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/cases/rendering/bsdf.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Of any length; 0 for equal directions.
double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

/// Axes, edges of the octahedron, directions close to both, and random ones.
std::vector<float> directions_to_pack(std::size_t random_ones, std::uint64_t seed) {
    std::vector<float> directions;
    const auto add = [&](const glm::dvec3& d) {
        const glm::vec3 n(glm::normalize(d));
        directions.insert(directions.end(), {n.x, n.y, n.z});
    };
    const double parts[] = {-1, -0.3, -1e-4, -1e-9, -0.0, 0.0, 1e-9, 1e-4, 0.3, 1};
    for (const double x : parts)
        for (const double y : parts)
            for (const double z : parts)
                if (std::abs(x) + std::abs(y) + std::abs(z) > 0) add({x, y, z});
    Random random(seed);
    while (directions.size() < 3 * random_ones) {
        const glm::dvec3 d(random.in_cube(1.f));
        if (const double square = glm::dot(d, d); square > 1e-6 && square <= 1) add(d);
    }
    return directions;
}

struct PackedDirections {
    std::vector<std::uint32_t> codes;
    std::vector<float> restored;
};

PackedDirections pack_on_device(const Run& run, const std::vector<float>& directions, bool spherical) {
    const auto count = std::uint32_t(directions.size() / 3);
    const Buffer<float> input(run.device(), directions), restored(run.device(), directions.size());
    const Buffer<std::uint32_t> codes(run.device(), count);
    load_kernel(run.device(), "verify/gbuffer_codes.cl", "pack_normals")
        .run({count, 64}, count, std::uint32_t(spherical), arg("directions", input), codes, arg("restored", restored));
    return {codes.read(), restored.read()};
}

std::vector<float> unpack_on_host(const std::vector<std::uint32_t>& codes, bool spherical) {
    std::vector<float> directions;
    for (const std::uint32_t code : codes) {
        const UnitVector got = spherical ? claray_unpack_spherical(code) : claray_unpack_octahedral(code);
        directions.insert(directions.end(), {got.x, got.y, got.z});
    }
    return directions;
}

PackedDirections pack_on_host(const std::vector<float>& directions, bool spherical) {
    PackedDirections packed;
    for (std::size_t i = 0; i < directions.size(); i += 3) {
        const UnitVector n = {directions[i], directions[i + 1], directions[i + 2]};
        const std::uint32_t code = spherical ? claray_pack_spherical(n) : claray_pack_octahedral(n);
        packed.codes.push_back(code);
    }
    packed.restored = unpack_on_host(packed.codes, spherical);
    return packed;
}

/// The largest angle between two lists of directions.
double largest_angle(Run& run, const char* what, const std::vector<float>& from, const std::vector<float>& to) {
    double worst = 0;
    std::size_t where = 0;
    for (std::size_t i = 0; i < from.size(); i += 3) {
        const double angle = degrees_between({from[i], from[i + 1], from[i + 2]}, {to[i], to[i + 1], to[i + 2]});
        if (!(angle <= worst)) worst = angle, where = i;
    }
    if (!(worst < 0.01))
        run.failure(printed("%s: %a %a %a becomes %a %a %a", what, double(from[where]), double(from[where + 1]),
                            double(from[where + 2]), double(to[where]), double(to[where + 1]), double(to[where + 2])));
    return worst;
}

/// The bounds are half a step of each number: on the octahedron at most sqrt(18) times as long an arc (in the middle of
/// a face, towards a corner); on the sphere pi and pi / 2 times, at right angles. Added are 2 % for float32, and 5 %
/// where OpenCL allows 6 ulp to atan2 and 4 to sin and cos.
void packed_normals(Run& run) {
    const double half_step = 1 / 65534.0, bounds[] = {std::sqrt(18.0) * half_step, pi * std::sqrt(1.25) * half_step};
    const auto directions = directions_to_pack(run.count<std::size_t>(200'000, 10'000'000), run.seed());
    const std::size_t count = directions.size() / 3;
    for (const bool spherical : {false, true}) {
        const std::string name = spherical ? "spherical" : "octahedral";
        const double bound = (spherical ? 1.05 : 1.02) * glm::degrees(bounds[spherical]);
        const PackedDirections device = pack_on_device(run, directions, spherical),
                               host = pack_on_host(directions, spherical);
        run.check("largest error of " + name + " codes, device", count,
                  largest_angle(run, "device", directions, device.restored), bound, "degrees");
        run.check("largest error of " + name + " codes, host", count,
                  largest_angle(run, "host", directions, host.restored), bound, "degrees");
        run.check("largest error of " + name + " codes of the device, read by the host", count,
                  largest_angle(run, "read by the host", directions, unpack_on_host(device.codes, spherical)), bound,
                  "degrees");
        const PackedDirections again = pack_on_device(run, device.restored, spherical);
        run.check("drift of " + name + " codes that are packed again", count,
                  largest_angle(run, "packed again", device.restored, again.restored), 1e-4, "degrees");
        Tally none;
        for (const std::uint32_t code : device.codes) none.add(code != CLARAY_NO_SURFACE);
        run.check(name + " codes that mean no surface", none, "codes");
    }
}

/// Triangles before the camera, at distances of 1e-3 to 1, that face it by half a right angle or more.
Mesh triangles_in_view(const glm::vec3& camera, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    Mesh mesh;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float distance = std::pow(10.f, random.uniform(-3.f, 0.f)), size = 0.03f * distance;
        const glm::vec3 at =
            camera + distance * glm::normalize(glm::vec3(random.uniform(-0.6f, 0.6f), random.uniform(-0.6f, 0.6f), -1));
        for (int corner = 0; corner < 3; ++corner) {
            const float turn = 2.1f * float(corner) + random.uniform();
            mesh.positions.push_back(at +
                                     size * glm::vec3(std::cos(turn), std::sin(turn), random.uniform(-0.3f, 0.3f)));
        }
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

std::vector<float> positions_on_device(const Run& run, const GBuffer& buffer) {
    const glm::mat4 m(buffer.world_from_image);
    const Buffer<GBufferPixel> pixels(run.device(), buffer.pixels);
    const Buffer<float> positions(run.device(), 3 * buffer.pixels.size());
    load_kernel(run.device(), "verify/gbuffer_codes.cl", "restore_positions")
        .run({buffer.pixels.size(), 64}, buffer.width, buffer.height, m[0], m[1], m[2], m[3], pixels, positions);
    return positions.read();
}

/// Positions from reversed depths in float32, by the host in float64 and by the device in float32, against the oracle's
/// distances along the rays of the pixels. Errors are relative to the distance and the camera's coordinates.
void depth_to_position(Run& run) {
    const unsigned size = run.count(64u, 400u);
    Scene scene;
    const glm::vec3 eye(0.3f, -0.2f, 0.5f);
    scene.materials = {Material{}};
    scene.meshes = {triangles_in_view(eye, run.count<std::size_t>(3'000, 10'000), run.seed())};
    scene.camera = Camera{eye, eye - glm::vec3(0, 0, 1), {0, 1, 0}, 60.f};
    const Renderer renderer(run.device(), scene, {.width = size, .height = size, .spp = 1});
    const GBuffer buffer = renderer.gbuffer();
    const std::vector<std::uint32_t> primitives = renderer.aovs().primitive;
    const std::vector<float> on_device = positions_on_device(run, buffer);
    const CameraData c = camera_data(*scene.camera, 1.f);
    const Oracle oracle(scene.meshes);
    double worst_host = 0, worst_device = 0, nearest = 1e30, farthest = 0;
    std::uint64_t tried = 0;
    for (std::size_t i = 0; i < buffer.pixels.size(); ++i) {
        if (primitives[i] == CLARAY_MISS) continue;
        const float x = 2.f * (float(i % size) + 0.5f) / float(size) - 1.f,
                    y = 1.f - 2.f * (float(i / size) + 0.5f) / float(size);
        const glm::vec3 d = glm::vec3(c.forward_x, c.forward_y, c.forward_z) +
                            x * glm::vec3(c.right_x, c.right_y, c.right_z) + y * glm::vec3(c.up_x, c.up_y, c.up_z);
        const OracleHit hit = oracle.closest_hit(make_ray(eye, d));
        if (hit.primitive != primitives[i]) continue;  // an edge in the pixel's centre
        const glm::dvec3 exact = glm::dvec3(eye) + hit.t * glm::dvec3(d);
        const double distance = glm::length(exact - glm::dvec3(eye)), unit = distance + glm::length(glm::dvec3(eye));
        const glm::dvec3 by_device(on_device[3 * i], on_device[3 * i + 1], on_device[3 * i + 2]);
        worst_host = std::max(worst_host, glm::length(glm::dvec3(position_of(buffer, i)) - exact) / unit);
        worst_device = std::max(worst_device, glm::length(by_device - exact) / unit);
        nearest = std::min(nearest, distance), farthest = std::max(farthest, distance), ++tried;
    }
    run.fact("distances", printed("%.3g to %.3g", nearest, farthest));
    run.check("pixels without a position", size * size, 1 - double(tried) / double(size * size), 0.25, "of all");
    run.check("largest error of positions, host", tried, worst_host, 5e-7, "of the distance");
    run.check("largest error of positions, device", tried, worst_device, 5e-7, "of the distance");
}

}  // namespace

Cases gbuffer_cases() {
    return {
        {{"depth-to-position", "images", "Positions restored from reversed float depth are those of the surfaces"},
         depth_to_position},
        {{"packed-normals", "images", "Octahedral and spherical normals of 2 x 16 bits are within half a step"},
         packed_normals},
    };
}

}  // namespace claray::verify
