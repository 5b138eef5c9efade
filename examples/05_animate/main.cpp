// Example 5: animate. A water surface obeys the wave equation: one of your own kernels steps it, another writes the new
// heights into the mesh on the device, claray refits its tree (and builds it anew now and then), and a third kernel
// traces the picture of every frame: wave_000.png, wave_001.png, ...
//   example_05_animate [FRAMES [SIDE [COURANT [STEPS]]]]
// SIDE x SIDE grid points, STEPS time steps a frame. COURANT is c dt / h: how many grid cells a wave passes in a step.
#include <algorithm>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr unsigned width = 480, height = 270;
constexpr unsigned frames_between_builds = 16;

const char* source = R"(
    #include "claray/shared/scene.h"
    #include "trace/closest_hit.clh"

    // Leapfrog: u(t + dt) = 2 u(t) - u(t - dt) + C^2 laplacian u(t). The rim stays at rest. `before` becomes `after`.
    kernel void step_wave(global const float* now, global float* before, uint side, float courant) {
        const uint i = get_global_id(0), x = i % side, y = i / side;
        if (x == 0 || y == 0 || x + 1 >= side || y + 1 >= side) return;
        const float laplacian = now[i - 1] + now[i + 1] + now[i - side] + now[i + side] - 4.0f * now[i];
        before[i] = 2.0f * now[i] - before[i] + courant * courant * laplacian;
    }

    kernel void move_vertices(global const float* heights, global float* positions, uint count) {
        const uint i = get_global_id(0);
        if (i < count) positions[3 * i + 1] = heights[i];
    }

    // By central differences; the surface spans -1 .. 1 in x and z.
    static float3 normal_at(global const float* heights, uint side, uint vertex) {
        const uint x = clamp(vertex % side, 1u, side - 2), y = clamp(vertex / side, 1u, side - 2), i = y * side + x;
        const float twice_spacing = 4.0f / (side - 1);
        return (float3)(heights[i - 1] - heights[i + 1], twice_spacing, heights[i - side] - heights[i + side]);
    }

    static float3 sky(float3 d) {
        const float3 sun = (float3)(0.36f, 0.3f, -0.884f);
        const float glare = pow(fmax(0.0f, dot(d, sun)), 2000.0f);
        return mix((float3)(0.9f, 0.65f, 0.4f), (float3)(0.05f, 0.15f, 0.45f), sqrt(fmax(0.0f, d.y))) + 30.0f * glare;
    }

    kernel void draw(CLARAY_BVH_PARAMETERS, global const uint* indices, global const float* heights, uint side,
                     CameraData camera, uint width, uint height, global float* image) {
        const uint pixel = get_global_id(0);
        if (pixel >= width * height) return;
        const float sx = 2.0f * (pixel % width + 0.5f) / width - 1.0f, sy = 1.0f - 2.0f * (pixel / width + 0.5f) / height;
        const float3 d = normalize((float3)(camera.forward_x + sx * camera.right_x + sy * camera.up_x,
                                            camera.forward_y + sx * camera.right_y + sy * camera.up_y,
                                            camera.forward_z + sx * camera.right_z + sy * camera.up_z));
        const Ray ray = {camera.x, camera.y, camera.z, 0.0f, d.x, d.y, d.z, INFINITY};
        const Hit hit = claray_closest_hit(CLARAY_BVH, ray);
        float3 color = sky(d);
        if (hit.primitive != CLARAY_MISS) {
            const uint3 t = vload3(hit.primitive, indices);
            const float3 n = normalize((1.0f - hit.u - hit.v) * normal_at(heights, side, t.x) +
                                       hit.u * normal_at(heights, side, t.y) + hit.v * normal_at(heights, side, t.z));
            const float cosine = fmax(0.0f, -dot(n, d));
            const float fresnel = 0.02f + 0.98f * pow(1.0f - cosine, 5.0f);  // Schlick 1994, water
            const float3 reflected = d + 2.0f * cosine * n;
            color = mix((float3)(0.0f, 0.07f, 0.1f), sky(reflected), fresnel);
        }
        vstore3(color, pixel, image);
    })";

claray::Mesh grid(unsigned side) {
    claray::Mesh mesh;
    for (unsigned y = 0; y < side; ++y)
        for (unsigned x = 0; x < side; ++x) {
            mesh.positions.emplace_back(2.f * float(x) / float(side - 1) - 1.f, 0.f,
                                        2.f * float(y) / float(side - 1) - 1.f);
            if (x + 1 == side || y + 1 == side) continue;
            const unsigned i = y * side + x;
            mesh.triangles.emplace_back(i, i + side, i + 1);
            mesh.triangles.emplace_back(i + 1, i + side, i + side + 1);
        }
    return mesh;
}

// Two drops, at rest.
std::vector<float> drops(const claray::Mesh& mesh) {
    std::vector<float> heights;
    const auto drop = [](const glm::vec3& p, float x, float z) {
        return std::exp(-120.f * ((p.x - x) * (p.x - x) + (p.z - z) * (p.z - z)));
    };
    for (const glm::vec3& p : mesh.positions)
        heights.push_back(std::max(std::abs(p.x), std::abs(p.z)) == 1.f
                              ? 0.f
                              : 0.25f * drop(p, -0.3f, 0.1f) - 0.2f * drop(p, 0.45f, -0.35f));
    return heights;
}

claray::Image picture_of(const claray::Buffer<float>& pixels) {
    const std::vector<float> values = pixels.read();
    claray::Image image{width, height, {}};
    for (std::size_t i = 0; i < values.size(); i += 3)
        image.pixels.emplace_back(values[i], values[i + 1], values[i + 2]);
    return image;
}

// Above 1 / sqrt(2) the shortest waves of a two-dimensional grid grow without bound (Courant, Friedrichs and Lewy
// 1928).
void check_courant(float courant) {
    if (courant > 0.f && courant <= std::sqrt(0.5f)) return;
    throw claray::Error(claray::ErrorKind::usage,
                        "Courant number " + std::to_string(courant) + ": the waves would grow without bound",
                        "c dt / h must be above 0 and at most 1 / sqrt(2) = 0.70710");
}

}  // namespace

int main(int argc, char** argv) try {
    const unsigned frames = argc > 1 ? unsigned(std::max(0, std::atoi(argv[1]))) : 90;
    const unsigned side = argc > 2 ? unsigned(std::clamp(std::atoi(argv[2]), 8, 4096)) : 256;
    const float courant = argc > 3 ? float(std::atof(argv[3])) : 0.7f;
    const unsigned steps = argc > 4 ? unsigned(std::max(0, std::atoi(argv[4]))) : 3;
    check_courant(courant);

    const claray::Device device = claray::Device::open();
    const claray::Mesh mesh = grid(side);
    claray::Bvh bvh = claray::Bvh::build(device, {&mesh, 1}, {.builder = claray::Builder::fast});
    claray::Kernel step_wave = claray::compile_kernel(device, source, "step_wave", bvh.defines());
    claray::Kernel move_vertices = claray::compile_kernel(device, source, "move_vertices", bvh.defines());
    claray::Kernel draw = claray::compile_kernel(device, source, "draw", bvh.defines());

    claray::Buffer<float> now(device, drops(mesh)), before(device, drops(mesh)), pixels(device, width * height * 3);
    const claray::Camera camera{{0.f, 0.45f, 1.15f}, {0.f, -0.1f, 0.1f}, {0.f, 1.f, 0.f}, 50.f};
    const claray::CameraData camera_data = claray::camera_data(camera, float(width) / height);

    float highest = 0;
    for (unsigned frame = 0; frame < frames; ++frame) {
        for (unsigned i = 0; i < steps; ++i) {
            step_wave.run({std::size_t(side) * side, 64}, now, before, side, courant);
            std::swap(now, before);
        }
        move_vertices.run({now.size(), 64}, now, bvh.triangles().positions, std::uint32_t(now.size()));
        if (frame % frames_between_builds == 0)
            bvh.rebuild();
        else
            bvh.refit();
        draw.run({width * height, 64}, bvh, bvh.triangles().indices, now, side, camera_data, width, height, pixels);

        char name[32];
        std::snprintf(name, sizeof name, "wave_%03u.png", frame);
        claray::write_image(name, picture_of(pixels));
        highest = 0;
        for (const float h : now.read()) highest = std::isfinite(h) ? std::max(highest, std::abs(h)) : INFINITY;
        std::printf("%s: highest wave %.4f\n", name, double(highest));
        if (highest > 1.f) throw claray::Error(claray::ErrorKind::device, "the waves grow: the simulation is unstable");
    }
    for (const auto& [kernel, summary] : device.profiler().summary())
        std::printf("%-24s %8.3f ms on average\n", kernel.c_str(), summary.milliseconds / double(summary.count));
    return 0;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
