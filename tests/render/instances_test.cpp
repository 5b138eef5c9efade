// Scenes with instances: placed, traced, shaded and lit as if every object were a mesh in the world.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

#include "host/bvh/instances_state.hpp"
#include "host/render/structure.hpp"
#include "host/scene/placement.hpp"
#include "tests/oracle/instances.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/instances.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

glm::mat4 at(const glm::vec3& position) { return glm::translate(glm::mat4(1.f), position); }

/// The scene with each instance as a separate mesh in world space, computed in float64.
Scene flattened(const Scene& scene) {
    Scene flat = scene;
    flat.meshes.clear(), flat.instances.clear();
    for (const MeshInstance& instance : scene.instances) {
        Mesh mesh = scene.meshes[instance.mesh];
        const glm::dmat4 m(instance.transform);
        for (glm::vec3& p : mesh.positions) p = glm::vec3(m * glm::dvec4(p, 1));
        for (glm::vec3& n : mesh.normals)
            n = glm::vec3(glm::transpose(glm::inverse(glm::dmat3(m))) * glm::dvec3(n));  // of any length
        if (glm::determinant(glm::dmat3(m)) < 0)
            for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
        flat.meshes.push_back(mesh);
    }
    return flat;
}

Mesh smooth_sphere_of(int levels, std::uint32_t material) {
    Mesh mesh = sphere(levels);
    mesh.normals = mesh.positions;
    mesh.materials.assign(mesh.triangles.size(), material);
    return mesh;
}

/// A floor and a wall, and spheres of several kinds that share one mesh, under a sky.
Scene spheres_and_floor() {
    Scene scene;
    scene.materials = {lambert(0.6f), lambert(0.4f), material(MaterialKind::metal, 0.9f, 0.3f),
                       material(MaterialKind::glass, 1.f)};
    scene.meshes = {square(4.f, 0.f), smooth_sphere_of(2, 1), smooth_sphere_of(3, 2), smooth_sphere_of(3, 3)};
    scene.instances.push_back({0});
    Random random(1);
    for (int i = 0; i < 9; ++i) {
        const glm::vec3 place(float(i % 3) * 1.2f - 1.2f, 0.5f, float(i / 3) * 1.2f - 1.2f);
        const glm::vec3 stretch(random.uniform(0.3f, 0.5f), random.uniform(0.3f, 0.5f) * (i % 2 ? -1.f : 1.f),
                                random.uniform(0.3f, 0.5f));
        scene.instances.push_back({std::uint32_t(1 + i % 3), glm::scale(at(place), stretch) * random_rotation(random)});
    }
    scene.sky = {glm::vec3(0.2f), glm::vec3(1.f)};
    scene.camera = Camera{{0.5f, 3, 5}, {0, 0.3f, 0}, {0, 1, 0}, 40.f};
    return scene;
}

Aovs aovs_of(const Scene& scene, const RenderConfig& config) { return Renderer(device(), scene, config).aovs(); }

/// Depths and normals agree, except in pixels with an edge.
void expect_same_aovs(const Aovs& a, const Aovs& b) {
    std::size_t differ = 0;
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
        const bool both_miss = std::isinf(a.depth[i]) && std::isinf(b.depth[i]);
        const bool near = both_miss || std::abs(a.depth[i] - b.depth[i]) <= 1e-5f * a.depth[i];
        if (!near || glm::distance(a.normal[i], b.normal[i]) > 1e-4f || a.albedo[i] != b.albedo[i]) ++differ;
    }
    EXPECT_LE(differ, a.depth.size() / 1000);
}

/// Means over tiles of both images, of the same expectation, differ by their noise only.
void expect_same_image(const Scene& a, const Scene& b, RenderConfig config) {
    const unsigned runs = 8;
    const unsigned tiles = 3;
    std::vector<double> sum[2], square_sum[2];
    for (int which = 0; which < 2; ++which) {
        sum[which].assign(tiles * tiles + 1, 0), square_sum[which] = sum[which];
        for (unsigned run = 0; run < runs; ++run) {
            config.seed = 2 * run + unsigned(which);
            const std::vector<glm::vec3> image = render_image(which ? b : a, config);
            std::vector<double> means(tiles * tiles + 1);
            std::vector<unsigned> counts(tiles * tiles + 1);
            for (std::size_t i = 0; i < image.size(); ++i) {
                const std::size_t x = i % config.width * tiles / config.width,
                                  y = i / config.width * tiles / config.height;
                for (const std::size_t tile : {x + tiles * y, std::size_t(tiles * tiles)})
                    means[tile] += image[i].y, ++counts[tile];
            }
            for (std::size_t t = 0; t < means.size(); ++t) {
                const double mean = means[t] / counts[t];
                sum[which][t] += mean, square_sum[which][t] += mean * mean;
            }
        }
    }
    for (std::size_t t = 0; t <= tiles * tiles; ++t) {
        double mean[2], variance = 0;
        for (int which = 0; which < 2; ++which) {
            mean[which] = sum[which][t] / runs;
            variance += (square_sum[which][t] / runs - mean[which] * mean[which]) / (runs - 1);
        }
        const bool whole = t == tiles * tiles;
        EXPECT_NEAR(mean[0], mean[1], (whole ? 3 : 4.5) * std::sqrt(variance) + 1e-6) << "tile " << t;
        if (whole) {
            EXPECT_NEAR(mean[0] / mean[1], 1, 0.005);
        }
    }
}

TEST(RenderedInstances, EqualTheFlatScene) {
    const Scene scene = spheres_and_floor(), flat = flattened(scene);
    ASSERT_FALSE(place_instances(scene).scene.instances.empty());
    const RenderConfig config{.width = 60, .height = 40, .spp = 8};
    expect_same_aovs(aovs_of(scene, config), aovs_of(flat, config));
    expect_same_image(scene, flat, config);
}

/// A stretched sphere of glass in a furnace: it vanishes if every ray that leaves a surface begins beyond it.
TEST(RenderedInstances, AreInvisibleInAFurnace) {
    for (const MaterialKind kind : {MaterialKind::glass, MaterialKind::lambert, MaterialKind::mirror}) {
        Scene scene;
        scene.materials = {material(kind, 1.f)};
        scene.meshes = {smooth_sphere_of(3, 0)};
        for (const float z : {0.f, -2.5f})
            scene.instances.push_back({0, glm::scale(at({1000.f, -300.f, 500.f + z}), glm::vec3(1.f, 0.2f, 0.6f)) *
                                              glm::rotate(glm::mat4(1.f), 1.f, glm::normalize(glm::vec3(1, 2, 3)))});
        scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
        scene.camera = Camera{{1000.f, -300.f, 503.f}, {1000.f, -300.f, 500.f}, {0, 1, 0}, 30.f};
        const glm::dvec3 radiance = mean(render_image(scene, {.width = 32, .height = 32, .spp = 16, .max_depth = 64}));
        EXPECT_NEAR(radiance.x, 1, 0.005) << int(kind);
    }
}

/// Lamps that are instances are sampled as lights with their place and size in the world.
TEST(RenderedInstances, LampsShineAsIfFlat) {
    Scene scene;
    scene.materials = {lambert(0.6f), emitter(4.f), emitter(9.f)};
    scene.meshes = {square(3.f, 0.f), square(0.3f, 0.f, 1), sphere(1)};
    scene.meshes[2].materials.assign(scene.meshes[2].triangles.size(), 2);
    scene.instances = {{0},
                       {1, at({-1, 1, 0})},
                       {1, glm::scale(at({1, 0.6f, 0.5f}), glm::vec3(2, 1, 0.5f))},
                       {2, glm::scale(at({0, 1.5f, -1}), glm::vec3(0.1f))},
                       {2, glm::scale(at({0.5f, 0.3f, 1}), glm::vec3(0.05f, -0.2f, 0.05f))}};
    scene.camera = Camera{{0, 4, 4}, {0, 0, 0}, {0, 1, 0}, 40.f};
    expect_same_image(scene, flattened(scene), {.width = 48, .height = 48, .spp = 32, .max_depth = 2});
    // By light sampling alone it is the same light: without it, lamps would hardly ever be found.
    EXPECT_GT(mean(render_image(scene, {.width = 16, .height = 16, .spp = 4, .max_depth = 1})).x, 0.1);
}

/// Shadow rays end before their lamp, although rays are rounded much when they are transformed into an object far from
/// its origin.
TEST(RenderedInstances, LampsFarFromTheirOriginsShineAsIfFlat) {
    Scene scene;
    scene.materials = {lambert(0.6f), emitter(4.f)};
    scene.meshes = {square(3.f, 0.f), square(0.3f, 0.f, 1)};
    const glm::vec3 away(3000, -1000, 2000);
    for (glm::vec3& p : scene.meshes[1].positions) p += away;
    const glm::mat4 turn = glm::rotate(glm::mat4(1.f), 0.7f, glm::normalize(glm::vec3(1, 2, 3)));
    const glm::vec3 home = -glm::vec3(turn * glm::vec4(away, 1.f));
    scene.instances = {{0}, {1, at(home + glm::vec3(-1, 1, 0)) * turn}, {1, at(home + glm::vec3(1, 0.5f, 0)) * turn}};
    scene.camera = Camera{{0, 4, 4}, {0, 0, 0}, {0, 1, 0}, 40.f};
    expect_same_image(scene, flattened(scene), {.width = 32, .height = 32, .spp = 64, .max_depth = 1});
}

// ---- motion

/// The edge of a lamp that moves to the left covers pixels for a share of the time that rises linearly.
TEST(MovingInstances, AnEdgeBecomesALinearRamp) {
    Scene scene;
    scene.materials = {emitter(1.f)};
    Mesh wall;
    wall.positions = {{0, -5, -2}, {5, -5, -2}, {5, 5, -2}, {0, 5, -2}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.meshes = {wall};
    scene.instances = {{0, glm::mat4(1.f), at({-0.3f, 0, 0})}};
    scene.camera = Camera{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, float(2 * std::atan(0.2) * 180 / 3.14159265358979)};
    const unsigned width = 40, height = 20, spp = 64;
    const std::vector<double> means = column_means(
        render_by_own_kernels(
            scene, {.width = width, .height = height, .spp = spp, .max_depth = 1, .sampler = Sampler::independent}),
        width);
    const auto integral = [](double x) {  // of the ramp from 0 at -0.15 to 1 at 0
        const double s = std::clamp((x + 0.15) / 0.15, 0.0, 1.0);
        return 0.5 * s * s * 0.15 + std::max(0.0, x);
    };
    for (unsigned i = 0; i < width; ++i) {
        const double a = (i * 2.0 / width - 1) * 0.4, b = ((i + 1) * 2.0 / width - 1) * 0.4;
        const double expected = (integral(b) - integral(a)) / (b - a);
        const double sigma = std::sqrt(std::max(0.0, expected * (1 - expected)) / (height * spp));
        EXPECT_NEAR(means[i], expected, 3 * sigma + 1e-6) << "column " << i;
    }
}

/// Objects that move, turn and grow, a mirror that shows them and a lamp among them: the image is the mean of the still
/// images of all times.
TEST(MovingInstances, ImageIsTheMeanOverAllTimes) {
    Scene scene;
    scene.materials = {lambert(0.7f), material(MaterialKind::mirror, 0.9f), emitter(5.f)};
    scene.meshes = {square(3.f, 0.f), smooth_sphere_of(3, 1), square(0.8f, 0.f, 2)};
    const glm::mat4 sphere_from = glm::scale(at({-0.6f, 0.5f, 0}), glm::vec3(0.4f)),
                    sphere_to = glm::scale(at({0.8f, 0.6f, 0.4f}), glm::vec3(0.5f, 0.6f, 0.4f)),
                    lamp_from = at({0, 2, -0.5f}), lamp_to = glm::rotate(at({0.8f, 1.6f, 0}), 0.8f, glm::vec3(0, 0, 1));
    scene.instances = {{0}, {1, sphere_from, sphere_to}, {2, lamp_from, lamp_to}};
    scene.camera = Camera{{0, 3, 4}, {0, 0.4f, 0}, {0, 1, 0}, 40.f};
    RenderConfig config{.width = 24, .height = 24, .spp = 64, .max_depth = 3};
    const glm::dvec3 moving = mean(render_image(scene, config));
    const int times = 16;
    glm::dvec3 expected(0.0);
    config.spp = 16;
    for (int i = 0; i < times; ++i) {
        const float t = (float(i) + 0.5f) / float(times);
        Scene still = scene;
        still.instances[1] = {1, sphere_from + (sphere_to - sphere_from) * t};
        still.instances[2] = {2, lamp_from + (lamp_to - lamp_from) * t};
        config.seed = std::uint32_t(i + 1);
        expected += mean(render_image(flattened(still), config)) / double(times);
    }
    EXPECT_NEAR(moving.x / expected.x, 1, 0.01);
}

/// A plate that moves away stands in the light's way for a quarter of the time.
TEST(MovingInstances, ShadowsMoveAlong) {
    Scene scene;
    scene.materials = {lambert(1.f)};
    scene.meshes = {square(3.f, 0.f), square(0.5f, 1.f)};
    scene.instances = {{0}, {1, glm::mat4(1.f), at({2, 0, 0})}};
    scene.lights = {point_light({0, 2, 0}, glm::vec3(4 * 3.14159265f))};
    scene.camera = narrow_camera({0, 1, 3}, {0, 0, 0});
    const RenderConfig config{.width = 4, .height = 4, .spp = 256, .max_depth = 1};
    EXPECT_NEAR(mean(render_image(scene, config)).x, 0.75, 0.005);
}

/// At shutter open.
TEST(MovingInstances, AovsAreOfTimeZero) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {sphere(2)};
    scene.instances = {{0, glm::mat4(1.f), at({3, 1, 0})}};
    scene.camera = Camera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40.f};
    const RenderConfig config{.width = 32, .height = 32, .spp = 1};
    const Aovs moving = aovs_of(scene, config);
    scene.instances[0].transform_end.reset();
    expect_same_aovs(moving, aovs_of(flattened(scene), config));
}

// ---- rays that leave a transformed triangle

struct Way {
    const char* name;
    float offset, scale;
    bool moves;
    float away = 0;  // of the triangles from their object's origin, which is then as far from the world's
};
void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }
class LeavingInstances : public testing::TestWithParam<Way> {};

TEST_P(LeavingInstances, NoRayHitsTheTriangleThatItLeaves) {
    const Way way = GetParam();
    const std::uint32_t triangles = 100, instance_count = 20, rays_each = 128;
    const std::uint32_t count = triangles * instance_count * rays_each;
    Mesh mesh = soup(triangles, 0.3f, 42);
    for (glm::vec3& p : mesh.positions) p += glm::vec3(way.away, 0, 0);
    std::vector<Instance> begins = random_instances(instance_count, 1, 3.f * way.scale, way.scale, 7), ends = begins;
    for (Instance& i : begins) {
        i.row0[3] += way.offset - i.row0[0] * way.away, i.row1[3] -= way.offset + i.row1[0] * way.away;
        i.row2[3] -= i.row2[0] * way.away;
        i.id = 0;
    }
    ends = begins;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        ends[i].row0[3] += way.scale, ends[i].row1[3] += 0.5f * way.scale;
        for (float& entry : ends[i].row2) entry *= 1.25f;
    }
    const Bvh bottom = Bvh::build(device(), std::span(&mesh, 1));
    const InstancedBvh bvh = way.moves ? InstancedBvh::build(std::span(&bottom, 1), begins, ends, {})
                                       : InstancedBvh::build(std::span(&bottom, 1), begins);
    Kernel leave = compile_kernel(
        device(), R"(
        #include "verify/leaving_rays.clh"
        kernel void leave(uint count, uint rays_each, uint triangles, global const float* positions,
                          global const uint* indices, global Ray* rays, global float* clearance INSTANCE_PARAMETERS) {
            const uint i = get_global_id(0);
            if (i >= count) return;
            const Leaving leaving = leaving_of(i, 1u);
            const uint number = i / rays_each;
            const Hit hit = point_that_is_left(leaving, number % triangles);
            const Placement placement = placement_of(number / triangles, 0.375f INSTANCE_BUFFERS);
            const Surface s = surface_of_instance(hit, &placement, view_of_leaving(leaving), positions, indices, 0);
            rays[i] = leaving_ray(leaving, &s);
            clearance[i] = s.clearance;
        })",
        "leave", {{"NORMALS", "0"}, {"TEXTURES", "0"}, {"INSTANCES", "1"}, {"INSTANCE_MOTION", way.moves ? "1" : "0"}});
    Buffer<Ray> rays(device(), count);
    const Buffer<float> clearance(device(), count);
    leave.run({count, 64}, count, rays_each, triangles, bottom.triangles().positions, bottom.triangles().indices, rays,
              clearance, bvh.instances(), bvh.ends(), state_of(bvh).placed);
    QueryOptions options;
    options.ray_times = Buffer<float>(device(), std::vector<float>(count, 0.375f));
    const std::vector<InstanceHit> hits = closest_hit(bvh, rays.read(), options);
    std::size_t self_hits = 0;
    float farthest = 0;
    const std::vector<float> clearances = clearance.read();
    for (std::uint32_t i = 0; i < count; ++i) {
        self_hits += hits[i].primitive == i / rays_each % triangles && hits[i].instance == i / rays_each / triangles;
        farthest = std::max(farthest, clearances[i]);
    }
    EXPECT_EQ(self_hits, 0u) << "of " << count;
    EXPECT_LT(farthest, 1e-4f * way.scale + 2e-6f * way.offset + 1e-5f * way.away);
}

INSTANTIATE_TEST_SUITE_P(Ways, LeavingInstances,
                         testing::Values(Way{"Origin", 0, 1, false}, Way{"Far", 1e4f, 1, false},
                                         Way{"Tiny", 0, 1e-4f, false}, Way{"AwayFromTheirOrigins", 0, 1, false, 1000},
                                         Way{"Moving", 0, 1, true}, Way{"MovingFar", 1e4f, 1, true}),
                         [](const auto& way) { return way.param.name; });

// ---- which instances are baked

TEST(PlaceInstances, BakesWhatHasNoOtherAndStandsStill) {
    Scene scene = spheres_and_floor();
    scene.instances = {{1, at({1, 2, 3})}, {0}};
    const PlacedScene baked = place_instances(scene);
    EXPECT_TRUE(baked.scene.instances.empty());
    ASSERT_EQ(baked.scene.meshes.size(), 2u);
    EXPECT_EQ(baked.scene.meshes[0].positions[5], scene.meshes[1].positions[5] + glm::vec3(1, 2, 3));
    EXPECT_EQ(baked.numbers.number_there(0), 2u);  // the first of the sphere, behind the floor's two
    EXPECT_EQ(baked.numbers.number_there(std::uint32_t(scene.meshes[1].triangles.size())), 0u);
    EXPECT_EQ(baked.numbers.number_there(CLARAY_MISS), CLARAY_MISS);

    scene.instances.push_back({2, glm::mat4(1.f), at({1, 0, 0})});  // moves
    scene.instances.push_back({3, at({0, 0, 1})});
    scene.instances.push_back({3, at({0, 0, 2})});
    const PlacedScene both = place_instances(scene);
    EXPECT_EQ(both.baked, 2u);
    ASSERT_EQ(both.scene.instances.size(), 5u);
    EXPECT_EQ(both.scene.meshes.size(), 4u);
    EXPECT_EQ(both.scene.instances[1].transform, glm::mat4(1.f));
    EXPECT_EQ(both.scene.instances[4].mesh, 3u);
    EXPECT_EQ(both.scene.instances[3].transform, at({0, 0, 1}));
}

TEST(PlaceInstances, LeavesWhatFloat32WouldBend) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {sphere(3)};
    scene.instances = {{0, at({1e3f, 0, 0})}};
    EXPECT_TRUE(place_instances(scene).scene.instances.empty());
    scene.instances = {{0, at({1e6f, 0, 0})}};
    EXPECT_EQ(place_instances(scene).scene.instances.size(), 1u);
}

TEST(PlaceInstances, MirroredFrontsStayFronts) {
    for (const glm::vec3 scale : {glm::vec3(-1, 2, 1), glm::vec3(-1, -2, 1), glm::vec3(-1, -2, -1)}) {
        const Mesh mirrored = transformed(smooth_sphere_of(1, 0), glm::scale(glm::mat4(1.f), scale));
        for (const glm::uvec3& t : mirrored.triangles) {
            const auto& p = mirrored.positions;
            const glm::vec3 normal = glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x]);
            EXPECT_GT(glm::dot(normal, p[t.x]), 0.f);
            EXPECT_GT(glm::dot(normal, mirrored.normals[t.x]), 0.f);
        }
    }
}

TEST(PlaceInstances, RefusesHalfATurn) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {sphere(1)};
    scene.instances = {{0, glm::mat4(1.f), glm::rotate(glm::mat4(1.f), 3.14159265f, glm::vec3(0, 1, 0))}};
    EXPECT_TRUE(throws_error(ErrorKind::user, "half a turn", [&] { (void)Renderer(device(), scene, {.spp = 1}); }));
}

/// AOVs number triangles as the scene does, whatever was baked.
TEST(PlaceInstances, AovsNumberTheScenesTriangles) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(1.f, 0.f), square(1.f, 0.f), square(1.f, 0.f)};
    scene.instances = {{2, at({2.5f, 0, 0})}, {0, at({-2.5f, 0, 0})}, {1, at({0, 0, -1.25f})}, {1, at({0, 0, 1.25f})}};
    scene.camera = Camera{{0, 6, 0}, {0, 0, 0}, {0, 0, -1}, 60.f};
    const Aovs aovs = aovs_of(scene, {.width = 33, .height = 33, .spp = 1});
    const auto number_at = [&](unsigned x, unsigned y) { return aovs.primitive[x + 33 * y] / 2; };
    EXPECT_EQ(number_at(28, 16), 2u);
    EXPECT_EQ(number_at(4, 16), 0u);
    EXPECT_EQ(number_at(16, 10), 1u);
    EXPECT_EQ(number_at(16, 22), 1u);
    EXPECT_EQ(aovs.primitive[0], CLARAY_MISS);
}

}  // namespace
}  // namespace claray::test
