// Example 4: trace rays inside your own OpenCL kernel. The kernel below includes claray's device headers, makes its own
// camera rays, and from every point that they hit sends rays over the hemisphere to see how open it is to the sky
// (ambient occlusion). No ray ever leaves the device.
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cstdio>

namespace {

constexpr unsigned width = 480, height = 270, samples = 64;

const char* source = R"(
    #include "claray/shared/scene.h"    // CameraData
    #include "trace/closest_hit.clh"    // Ray, Hit, claray_closest_hit, claray_any_hit

    // Of the triangle that was hit, towards where the ray came from.
    static float3 normal_of(global const float* positions, global const uint* indices, uint triangle, float3 direction) {
        const uint3 t = 3 * vload3(triangle, indices);
        const float3 a = vload3(0, positions + t.x), b = vload3(0, positions + t.y), c = vload3(0, positions + t.z);
        const float3 n = normalize(cross(b - a, c - a));
        return dot(n, direction) > 0.0f ? -n : n;
    }

    static uint hash(uint v) {  // PCG (Jarzynski and Olano 2020)
        v = v * 747796405u + 2891336453u;
        v = ((v >> ((v >> 28u) + 4u)) ^ v) * 277803737u;
        return (v >> 22u) ^ v;
    }

    // The golden-ratio sequences of two dimensions: evenly spread points in the unit square (Roberts 2018).
    static float2 point_in_square(uint i, float shift) {
        const float2 p = shift + (float)i * (float2)(0.754877666f, 0.569840291f);
        return p - floor(p);
    }

    // Cosine-distributed about n: a point on the unit sphere around its tip (Shirley and Morley).
    static float3 direction_about(float3 n, float2 p) {
        const float z = 1.0f - 2.0f * p.x, r = sqrt(fmax(0.0f, 1.0f - z * z)), a = 6.2831853f * p.y;
        return n + 0.999f * (float3)(r * cos(a), r * sin(a), z);
    }

    // CLARAY_BVH_PARAMETERS declares the structure's buffers, CLARAY_BVH passes them on.
    kernel void openness(CLARAY_BVH_PARAMETERS, global const float* positions, global const uint* indices, CameraData camera,
                         uint width, uint height, uint samples, global float* image) {
        const uint pixel = get_global_id(0);
        if (pixel >= width * height) return;
        const uint x = pixel % width, y = pixel / width;
        const float sx = 2.0f * (x + 0.5f) / width - 1.0f, sy = 1.0f - 2.0f * (y + 0.5f) / height;
        const float3 d = (float3)(camera.forward_x + sx * camera.right_x + sy * camera.up_x,
                                  camera.forward_y + sx * camera.right_y + sy * camera.up_y,
                                  camera.forward_z + sx * camera.right_z + sy * camera.up_z);
        const Ray ray = {camera.x, camera.y, camera.z, 0.0f, d.x, d.y, d.z, INFINITY};
        const Hit hit = claray_closest_hit(CLARAY_BVH, ray);
        if (hit.primitive == CLARAY_MISS) { image[pixel] = 1.0f; return; }

        const float3 n = normal_of(positions, indices, hit.primitive, d);
        // Back along the ray by a hair, so that the surface doesn't shadow itself.
        const float3 p = (float3)(camera.x, camera.y, camera.z) + hit.t * (1.0f - 1e-4f) * d;
        const float shift = hash(pixel) * 0x1p-32f;  // another set of directions for every pixel
        uint open = 0;
        for (uint i = 0; i < samples; ++i) {
            const float3 o = direction_about(n, point_in_square(i, shift));
            const Ray shadow = {p.x, p.y, p.z, 0.0f, o.x, o.y, o.z, INFINITY};
            open += !claray_any_hit(CLARAY_BVH, shadow);
        }
        image[pixel] = (float)open / samples;
    })";

}  // namespace

int main() try {
    const claray::Device device = claray::Device::open();
    const claray::Scene scene = claray::builtin_scene("crate").value();
    const claray::Bvh bvh = claray::Bvh::build(device, scene.meshes);
    const claray::Camera camera = claray::camera_of(scene, 16.f / 9.f);

    // Compiled for this structure's layout; `bvh` stands for all the parameters that CLARAY_BVH_PARAMETERS declares.
    claray::Buffer<float> image(device, width * height);
    claray::Kernel openness = claray::compile_kernel(device, source, "openness", bvh.defines());
    openness.run({width * height, 64}, bvh, bvh.triangles().positions, bvh.triangles().indices,
                 claray::camera_data(camera, float(width) / height), width, height, samples, image);

    claray::Image picture{width, height, {}};
    for (const float value : image.read()) picture.pixels.emplace_back(value);
    claray::write_image("openness.png", picture, 0.f, claray::ToneMap::none);
    std::printf("openness.png: %zu triangles, %.1f ms on %s\n", bvh.triangle_count(),
                device.profiler().milliseconds("openness"), device.info().name.c_str());
    return 0;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
