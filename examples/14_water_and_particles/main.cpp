// Example 14: water and particles. Kernels of your own move a fountain's drops and the water that they fall into;
// claray takes the new vertices and renders each frame: splash_000.png, splash_001.png, ...
//   example_14_water_and_particles [FRAMES [SIDE [DROPS [SAMPLES]]]]
// The water has SIDE x SIDE grid points, a frame SAMPLES per pixel.
#include <algorithm>
#include <chrono>
#include <claray/claray.hpp>
#include <claray/io.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

constexpr unsigned width = 480, height = 270;
constexpr unsigned steps_per_frame = 4;
constexpr float seconds_per_step = 1.f / 240;

struct Particle {
    float x, y, z, vx, vy, vz;
    std::uint32_t thrown;  // how often, which chooses its next throw
};

const char* source = R"(
    #include "claray/shared/rng.h"

    typedef struct { float x, y, z, vx, vy, vz; uint thrown; } Particle;

    // The grid point of a place; the water spans -1 .. 1 in x and z.
    static uint cell_of(float x, float z, uint side) {
        const float scale = 0.5f * (side - 1);
        const uint column = clamp((int)((x + 1.0f) * scale + 0.5f), 1, (int)side - 2);
        const uint row = clamp((int)((z + 1.0f) * scale + 0.5f), 1, (int)side - 2);
        return row * side + column;
    }

    static void throw_again(Particle* p, uint index) {
        const SamplePair a = independent_pair(index, hash_word(p->thrown)), b = independent_pair(index, hash_word(~p->thrown));
        const float turn = 6.2831853f * unit_float(a.x), outward = 0.15f + 0.45f * unit_float(a.y);
        p->x = p->z = 0.0f, p->y = 0.02f;
        p->vx = outward * cos(turn), p->vz = outward * sin(turn), p->vy = 2.2f + 0.5f * unit_float(b.x);
        ++p->thrown;
    }

    // Drops fall freely. Where one meets the water, it pushes it down and is thrown again. All pushes are equal, so that
    // the order of the drops does not matter.
    kernel void move_particles(global Particle* particles, uint count, global const float* heights, global uint* pushes, uint side,
                               float seconds) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        Particle p = particles[i];
        p.vy -= 9.81f * seconds;
        p.x += p.vx * seconds, p.y += p.vy * seconds, p.z += p.vz * seconds;
        const uint cell = cell_of(p.x, p.z, side);
        if (p.vy < 0.0f && p.y < heights[cell]) {
            pushes[cell] = 1;
            throw_again(&p, i);
        }
        particles[i] = p;
    }

    // The wave equation by leapfrog, see example 5, with friction (`kept` is a little below 1) and a pull back to the level
    // (`pull`), without which the pushes would sink the whole surface. `before` becomes `after`.
    kernel void step_water(global const float* now, global float* before, global uint* pushes, uint side, float courant, float kept,
                           float pull, float push) {
        const uint i = get_global_id(0), x = i % side, y = i / side;
        if (x == 0 || y == 0 || x + 1 >= side || y + 1 >= side) return;
        const float laplacian = now[i - 1] + now[i + 1] + now[i - side] + now[i + side] - 4.0f * now[i];
        before[i] = now[i] + kept * (now[i] - before[i]) + courant * courant * laplacian - pull * now[i] - (pushes[i] ? push : 0.0f);
        pushes[i] = 0;
    }

    // Positions and, by central differences, normals of the water.
    kernel void write_water(global const float* heights, uint side, global float* positions, global float* normals) {
        const uint i = get_global_id(0);
        if (i >= side * side) return;
        const uint x = clamp(i % side, 1u, side - 2), y = clamp(i / side, 1u, side - 2), k = y * side + x;
        const float spacing = 2.0f / (side - 1);
        positions[3 * i + 1] = heights[i];
        const float3 slope = (float3)(heights[k - 1] - heights[k + 1], 2.0f * spacing, heights[k - side] - heights[k + side]);
        vstore3(normalize(slope), i, normals);
    }

    // A tetrahedron for every drop.
    kernel void write_drops(global const Particle* particles, uint count, float radius, global float* positions) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        const float3 center = (float3)(particles[i].x, particles[i].y, particles[i].z);
        vstore3(center + radius * (float3)(1, 1, 1), 4 * i, positions);
        vstore3(center + radius * (float3)(1, -1, -1), 4 * i + 1, positions);
        vstore3(center + radius * (float3)(-1, 1, -1), 4 * i + 2, positions);
        vstore3(center + radius * (float3)(-1, -1, 1), 4 * i + 3, positions);
    })";

claray::Mesh water_mesh(unsigned side) {
    claray::Mesh mesh;
    for (unsigned y = 0; y < side; ++y)
        for (unsigned x = 0; x < side; ++x) {
            const glm::vec2 at = 2.f * glm::vec2(x, y) / float(side - 1) - 1.f;
            mesh.positions.emplace_back(at.x, 0.f, at.y);
            mesh.normals.emplace_back(0.f, 1.f, 0.f);
            if (x + 1 == side || y + 1 == side) continue;
            const unsigned i = y * side + x;
            mesh.triangles.emplace_back(i, i + side, i + 1);
            mesh.triangles.emplace_back(i + 1, i + side, i + side + 1);
        }
    mesh.materials.assign(mesh.triangles.size(), 0);
    return mesh;
}

claray::Mesh drops_mesh(unsigned count) {
    claray::Mesh mesh;
    mesh.positions.resize(4 * std::size_t(count));
    for (unsigned i = 0; i < count; ++i)
        for (const glm::uvec3 face : {glm::uvec3(0, 1, 2), {0, 3, 1}, {0, 2, 3}, {1, 3, 2}})
            mesh.triangles.push_back(4 * i + face);
    mesh.materials.assign(mesh.triangles.size(), 1);
    return mesh;
}

claray::Scene make_scene(unsigned side, unsigned drops) {
    claray::Scene scene;
    claray::Material water, drop;
    water.kind = claray::MaterialKind::principled;
    water.albedo = {0.02f, 0.10f, 0.13f}, water.roughness = 0.1f;
    drop.albedo = {0.75f, 0.85f, 0.9f};
    scene.materials = {water, drop};
    scene.meshes = {water_mesh(side), drops_mesh(drops)};
    scene.sky = {{0.9f, 0.75f, 0.6f}, {0.15f, 0.35f, 0.8f}};
    claray::Light sun;
    sun.kind = claray::LightKind::directional;
    sun.direction = {-0.5f, -0.6f, -0.4f}, sun.intensity = {2.5f, 2.2f, 1.8f};
    scene.lights = {sun};
    scene.camera = claray::Camera{{0.f, 0.55f, 1.5f}, {0.f, 0.08f, 0.f}, {0.f, 1.f, 0.f}, 36.f};
    return scene;
}

/// What is moved on the device.
class Fountain {
public:
    Fountain(const claray::Device& device, unsigned side, unsigned drops, const claray::Mesh& water)
        : side_(side),
          drops_(drops),
          particles_(device, first_throws(drops)),
          now_(device, water.positions.size()),
          before_(device, water.positions.size()),
          water_positions_(device, flat(water.positions)),
          water_normals_(device, 3 * water.positions.size()),
          drop_positions_(device, 12 * std::size_t(drops)),
          pushes_(device, water.positions.size()) {
        now_.fill(0), before_.fill(0), pushes_.fill(0);
        for (auto [kernel, name] : {std::pair(&move_, "move_particles"),
                                    {&step_, "step_water"},
                                    {&water_, "write_water"},
                                    {&write_drops_, "write_drops"}})
            *kernel = claray::compile_kernel(device, source, name);
    }

    void step() {
        constexpr float courant = 0.5f, kept = 0.998f, pull = 0.002f, push = 0.003f;
        move_.run({drops_, 64}, particles_, drops_, now_, pushes_, side_, seconds_per_step);
        step_.run({now_.size(), 64}, now_, before_, pushes_, side_, courant, kept, pull, push);
        std::swap(now_, before_);
    }

    void write_to(claray::Scene& scene) {
        const float radius = 0.006f;
        water_.run({now_.size(), 64}, now_, side_, water_positions_, water_normals_);
        write_drops_.run({drops_, 64}, particles_, drops_, radius, drop_positions_);
        read_into(scene.meshes[0].positions, water_positions_);
        read_into(scene.meshes[0].normals, water_normals_);
        read_into(scene.meshes[1].positions, drop_positions_);
    }

private:
    // Falling from heights that they reach the water from one after the other, within the time of a throw.
    static std::vector<Particle> first_throws(unsigned count) {
        std::vector<Particle> particles(count);
        for (unsigned i = 0; i < count; ++i) {
            const float seconds = 0.5f * float(i) / float(count);
            particles[i] = {0.f, 0.5f * 9.81f * seconds * seconds, 0.f, 0.f, 0.f, 0.f, i};
        }
        return particles;
    }
    static std::vector<float> flat(const std::vector<glm::vec3>& vectors) {
        return {&vectors[0].x, &vectors[0].x + 3 * vectors.size()};
    }
    static void read_into(std::vector<glm::vec3>& vectors, const claray::Buffer<float>& buffer) {
        buffer.read(std::span<float>(&vectors[0].x, buffer.size()));
    }

    std::uint32_t side_, drops_;
    claray::Buffer<Particle> particles_;
    claray::Buffer<float> now_, before_, water_positions_, water_normals_, drop_positions_;
    claray::Buffer<std::uint32_t> pushes_;
    claray::Kernel move_, step_, water_, write_drops_;
};

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

int main(int argc, char** argv) try {
    const auto number = [&](int i, int otherwise, int least, int most) {
        return unsigned(argc > i ? std::clamp(std::atoi(argv[i]), least, most) : otherwise);
    };
    const unsigned frames = number(1, 60, 1, 100'000), side = number(2, 160, 8, 2048),
                   drops = number(3, 4000, 1, 1'000'000), samples = number(4, 8, 1, 65'536);
    const claray::Device device = claray::Device::open();
    claray::Scene scene = make_scene(side, drops);
    Fountain fountain(device, side, drops, scene.meshes[0]);
    for (unsigned i = 0; i < 240; ++i) fountain.step();  // until the first drops have fallen
    fountain.write_to(scene);
    claray::Renderer renderer(device, scene, {.width = width, .height = height, .spp = samples, .max_depth = 4});
    renderer.settle();

    for (unsigned frame = 0; frame < frames; ++frame) {
        const auto begin = std::chrono::steady_clock::now();
        for (unsigned i = 0; i < steps_per_frame; ++i) fountain.step();
        fountain.write_to(scene);
        const double moved = milliseconds_since(begin);
        renderer.update(scene, {.vertices = true});
        (void)renderer.render();
        const double rendered = milliseconds_since(begin) - moved;

        char name[32];
        std::snprintf(name, sizeof name, "splash_%03u.png", frame);
        claray::write_image(name, {width, height, renderer.image()});
        float highest = 0, airborne = 0;
        for (const glm::vec3& p : scene.meshes[0].positions)
            highest = std::isfinite(p.y) ? std::max(highest, std::abs(p.y)) : INFINITY;
        for (std::size_t i = 0; i < scene.meshes[1].positions.size(); i += 4)
            airborne += scene.meshes[1].positions[i].y > 0;
        std::printf("%s: %.0f drops in the air, waves up to %.4f, moved in %.2f ms, rendered in %.2f ms\n", name,
                    double(airborne), double(highest), moved, rendered);
        if (!(highest < 0.5f))
            throw claray::Error(claray::ErrorKind::device, "the waves grow: the simulation is unstable");
    }
    return 0;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
