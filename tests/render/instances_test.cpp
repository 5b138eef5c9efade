// Scenes with instances: placed, traced, shaded and lit as if every object lay in the world by itself.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

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

/// All instances as meshes of their own in the world, computed here in float64.
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

Mesh smooth_sphere(int levels, std::uint32_t material) {
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
    scene.meshes = {square(4.f, 0.f), smooth_sphere(2, 1), smooth_sphere(3, 2), smooth_sphere(3, 3)};
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

/// Depths and normals agree but where pixels see an edge.
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
    config.sampler = Sampler::independent;
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
    const RenderConfig config{.width = 60, .height = 40, .spp = 16};
    expect_same_aovs(aovs_of(scene, config), aovs_of(flat, config));
    expect_same_image(scene, flat, config);
}

/// A stretched sphere of glass in a furnace: it vanishes if every ray that leaves a surface begins beyond it.
TEST(RenderedInstances, AreInvisibleInAFurnace) {
    for (const MaterialKind kind : {MaterialKind::glass, MaterialKind::lambert, MaterialKind::mirror}) {
        Scene scene;
        scene.materials = {material(kind, 1.f)};
        scene.meshes = {smooth_sphere(3, 0)};
        for (const float z : {0.f, -2.5f})
            scene.instances.push_back({0, glm::scale(at({1000.f, -300.f, 500.f + z}), glm::vec3(1.f, 0.2f, 0.6f)) *
                                              glm::rotate(glm::mat4(1.f), 1.f, glm::normalize(glm::vec3(1, 2, 3)))});
        scene.sky = {glm::vec3(1.f), glm::vec3(1.f)};
        scene.camera = Camera{{1000.f, -300.f, 503.f}, {1000.f, -300.f, 500.f}, {0, 1, 0}, 30.f};
        const glm::dvec3 radiance = mean(render_image(scene, {.width = 32, .height = 32, .spp = 16, .max_depth = 64}));
        EXPECT_NEAR(radiance.x, 1, 0.005) << int(kind);
    }
}

/// Lamps that are instances are sampled as lights, each where it is and as large as it is.
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

}  // namespace
}  // namespace claray::test
