// Example 6: instances. Thousands of crates and balls ride on a wave: one of your own kernels moves their
// transforms in device memory, claray builds its top level anew for every frame, and another kernel traces the picture:
// field_000.png, field_001.png, ... The meshes' own trees are built once.
//   example_06_instances [FRAMES [SIDE]]      SIDE x SIDE instances
#include <algorithm>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr unsigned width = 480, height = 270;

const char* source = R"(
    #include "claray/shared/scene.h"
    #include "trace/traverse_instances.clh"

    // Puts a turned and scaled copy on every point of a grid over -1 .. 1 in x and z, as high as the wave is there.
    kernel void move(global Instance* instances, uint side, float time) {
        const uint i = get_global_id(0);
        if (i >= side * side) return;
        const float x = 2.0f * (i % side + 0.5f) / side - 1.0f, z = 2.0f * (i / side + 0.5f) / side - 1.0f;
        const float distance = sqrt(x * x + z * z), phase = 12.0f * distance - 3.0f * time;
        const float size = 1.6f / side, s = size * sin(phase), c = size * cos(phase);
        const float transform[12] = {c, 0.0f, s, x, 0.0f, size, 0.0f, 0.08f * sin(phase), -s, 0.0f, c, z};
        for (uint k = 0; k < 4; ++k) {
            instances[i].row0[k] = transform[k];
            instances[i].row1[k] = transform[4 + k];
            instances[i].row2[k] = transform[8 + k];
        }
        instances[i].bottom = i % 2;
        instances[i].mask = 0xffffffffu;
        instances[i].id = i;
    }

    float3 corner_of(global const float* positions, global const uint* indices, uint corner) {
        return vload3(indices[corner], positions);
    }

    // The triangle's normal in the object becomes the world's by the transposed inverse of the transform.
    float3 normal_of(InstanceHit hit, global const PlacedInstance* placed, global const float* positions,
                     global const uint* indices) {
        const float3 a = corner_of(positions, indices, 3 * hit.primitive);
        const float3 n = cross(corner_of(positions, indices, 3 * hit.primitive + 1) - a,
                               corner_of(positions, indices, 3 * hit.primitive + 2) - a);
        global const PlacedInstance* p = &placed[hit.instance];
        return normalize(n.x * vload3(0, p->row0) + n.y * vload3(0, p->row1) + n.z * vload3(0, p->row2));
    }

    // A colour for every instance, in the light of a sun and of a pale sky.
    kernel void draw(CLARAY_INSTANCES_PARAMETERS, global const float* crate_positions, global const uint* crate_indices,
                     global const float* ball_positions, global const uint* ball_indices, CameraData camera, uint width,
                     uint height, global float* image) {
        const uint pixel = get_global_id(0);
        if (pixel >= width * height) return;
        const float sx = 2.0f * (pixel % width + 0.5f) / width - 1.0f, sy = 1.0f - 2.0f * (pixel / width + 0.5f) / height;
        const float3 d = (float3)(camera.forward_x + sx * camera.right_x + sy * camera.up_x,
                                  camera.forward_y + sx * camera.right_y + sy * camera.up_y,
                                  camera.forward_z + sx * camera.right_z + sy * camera.up_z);
        const Ray ray = {camera.x, camera.y, camera.z, 0.0f, d.x, d.y, d.z, INFINITY};
        const InstanceHit hit = claray_closest_instance(CLARAY_INSTANCES, ray);
        float3 color = (float3)(0.05f, 0.07f, 0.1f);
        if (hit.primitive != CLARAY_MISS) {
            const uint id = claray_placed[hit.instance].id;
            const float3 p = (float3)(camera.x, camera.y, camera.z) + hit.t * d;
            const bool is_ball = claray_placed[hit.instance].bottom == 1;
            float3 n = normal_of(hit, claray_placed, is_ball ? ball_positions : crate_positions,
                                 is_ball ? ball_indices : crate_indices);
            n = dot(n, d) > 0.0f ? -n : n;
            const float3 sun = normalize((float3)(0.5f, 1.0f, 0.3f)), from = p + 1e-4f * n;
            const Ray to_sun = {from.x, from.y, from.z, 0.0f, sun.x, sun.y, sun.z, INFINITY};
            const bool lit = dot(n, sun) > 0.0f && !claray_any_instance(CLARAY_INSTANCES, to_sun);
            const float light = 0.2f + 0.1f * n.y + (lit ? dot(n, sun) : 0.0f);
            color = light * (0.5f + 0.35f * cos(id * (float3)(0.9f, 1.7f, 2.3f)));
        }
        vstore3(color, pixel, image);
    })";

// The first mesh of that name in a built-in scene, scaled and moved into the unit cube round the origin.
std::vector<claray::Mesh> in_unit_cube(const char* scene_name, const char* mesh_name) {
    const claray::Scene scene = claray::builtin_scene(scene_name).value();
    const auto found = std::find_if(scene.meshes.begin(), scene.meshes.end(),
                                    [&](const claray::Mesh& mesh) { return mesh.name == mesh_name; });
    if (found == scene.meshes.end())
        throw claray::Error(claray::ErrorKind::user, std::string("no mesh '") + mesh_name + "' in " + scene_name);
    claray::Mesh mesh = *found;
    const claray::Bounds bounds = claray::bounds_of(mesh);
    const glm::vec3 size = bounds.extent();
    for (glm::vec3& p : mesh.positions) p = (p - bounds.center()) / std::max({size.x, size.y, size.z});
    return {mesh};
}

}  // namespace

int main(int argc, char** argv) try {
    const unsigned frames = argc > 1 ? unsigned(std::max(0, std::atoi(argv[1]))) : 30;
    const unsigned side = argc > 2 ? unsigned(std::clamp(std::atoi(argv[2]), 1, 4096)) : 60;
    const claray::Device device = claray::Device::open();

    // The bottom levels: the structures that are placed.
    const std::vector<claray::Bvh> bottoms = {claray::Bvh::build(device, in_unit_cube("crate", "crate")),
                                              claray::Bvh::build(device, in_unit_cube("spheres", "sphere"))};

    // The instances live in device memory: a kernel writes them, `rebuild` reads them there.
    const claray::Buffer<claray::Instance> instances(device, std::size_t(side) * side);
    const claray::Defines defines = bottoms[0].defines();
    claray::Kernel move = claray::compile_kernel(device, source, "move", defines);
    claray::Kernel draw = claray::compile_kernel(device, source, "draw", defines);
    move.run({instances.size(), 64}, instances, side, 0.f);
    claray::InstancedBvh bvh = claray::InstancedBvh::build(bottoms, instances);

    claray::Buffer<float> pixels(device, width * height * 3);
    const claray::Camera camera{{0.f, 0.6f, 1.3f}, {0.f, -0.1f, 0.f}, {0.f, 1.f, 0.f}, 50.f};
    const claray::CameraData camera_data = claray::camera_data(camera, float(width) / height);
    for (unsigned frame = 0; frame < frames; ++frame) {
        move.run({instances.size(), 64}, instances, side, 0.1f * float(frame));
        bvh.rebuild();
        const claray::TriangleBuffers &crate = bottoms[0].triangles(), &ball = bottoms[1].triangles();
        draw.run({width * height, 64}, bvh, crate.positions, crate.indices, ball.positions, ball.indices, camera_data,
                 width, height, pixels);

        claray::Image image{width, height, {}};
        const std::vector<float> values = pixels.read();
        for (std::size_t i = 0; i < values.size(); i += 3)
            image.pixels.emplace_back(values[i], values[i + 1], values[i + 2]);
        char name[32];
        std::snprintf(name, sizeof name, "field_%03u.png", frame);
        claray::write_image(name, image);
    }
    const claray::InstanceStatistics s = bvh.statistics();
    std::printf("%u instances of a crate of %zu and a ball of %zu triangles; top level %.1f MB, bottom level %.1f MB\n",
                s.instances, bottoms[0].triangle_count(), bottoms[1].triangle_count(), double(s.top_bytes) * 1e-6,
                double(s.bottom_bytes) * 1e-6);
    for (const auto& [kernel, summary] : device.profiler().summary())
        std::printf("%-24s %8.3f ms on average\n", kernel.c_str(), summary.milliseconds / double(summary.count));
    return s.instances == instances.size() ? 0 : 1;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
