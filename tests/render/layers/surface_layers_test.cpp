// AOVs that tell which surface a pixel shows, where it is and how it moves: render/write_aovs.cl and
// host/render/layers/surface_numbers.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <set>
#include <span>

#include "claray/instances.hpp"
#include "claray/renderer.hpp"
#include "host/scene/camera.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

constexpr unsigned image_side = 48;

glm::mat4 placed_at(const glm::vec3& position) { return glm::translate(glm::mat4(1.f), position); }

Aovs aovs_in(const Scene& scene) {
    return Renderer(device(), scene, {.width = image_side, .height = image_side, .spp = 1}).aovs();
}

/// Through the centres of the pixels, as the camera's own formulas aim them.
std::vector<Ray> center_rays(const Scene& scene) {
    const CameraData camera = camera_data(*scene.camera, 1.f);
    std::vector<Ray> rays;
    for (unsigned i = 0; i < image_side * image_side; ++i) {
        const CameraRay ray = camera_ray(camera, 2 * (i % image_side + 0.5) / image_side - 1,
                                         1 - 2 * (i / image_side + 0.5) / image_side);
        const glm::vec3 o(ray.origin), d(glm::normalize(ray.direction));
        rays.push_back({o.x, o.y, o.z, 0.f, d.x, d.y, d.z, std::numeric_limits<float>::infinity()});
    }
    return rays;
}

/// A floor, and balls of two meshes of which one is shown once and the other three times; the second mesh is empty.
Scene placed_balls() {
    Scene scene;
    scene.materials = {lambert(0.5f), lambert(0.6f), lambert(0.7f)};
    scene.meshes = {square(4.f, 0.f), Mesh{}, sphere(2), sphere(1)};
    scene.meshes[2].materials.assign(scene.meshes[2].triangles.size(), 1);
    scene.meshes[3].materials.assign(scene.meshes[3].triangles.size(), 2);
    scene.instances = {{3, placed_at({-1.5f, 1, 0})}, {1, placed_at({0, 0, 0})},    {2, placed_at({0, 1, -1})},
                       {0, glm::mat4(1.f)},           {3, placed_at({1.5f, 1, 0})}, {3, placed_at({0, 0.5f, 2})}};
    scene.camera = Camera{{0, 4, 7}, {0, 0.5f, 0}, {0, 1, 0}, 45.f};
    return scene;
}

/// Compares with rays that are traced apart from the renderer. Edges of triangles may go either way.
void expect_share_equal(const std::vector<std::uint32_t>& seen, const std::vector<std::uint32_t>& traced) {
    ASSERT_EQ(seen.size(), traced.size());
    std::size_t equal = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) equal += seen[i] == traced[i] ? 1 : 0;
    EXPECT_GE(double(equal), 0.995 * double(seen.size()));
}

TEST(SurfaceLayers, ObjectsAreTheGeometriesOfHits) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(3.f, 0.f), Mesh{}, sphere(2), sphere(1)};
    for (glm::vec3& p : scene.meshes[2].positions) p += glm::vec3(-1, 1, 0);
    for (glm::vec3& p : scene.meshes[3].positions) p += glm::vec3(1.2f, 1, 0.5f);
    scene.camera = Camera{{0, 4, 7}, {0, 0.5f, 0}, {0, 1, 0}, 45.f};
    const Aovs aovs = aovs_in(scene);
    const std::vector<Ray> rays = center_rays(scene);
    std::vector<std::uint32_t> objects, primitives;
    for (const Hit& hit : closest_hit(Bvh::build(device(), scene.meshes), rays)) {
        objects.push_back(hit.primitive == CLARAY_MISS ? CLARAY_MISS : hit.geometry);
        primitives.push_back(hit.primitive);
    }
    expect_share_equal(aovs.object, objects);
    expect_share_equal(aovs.primitive, primitives);
    EXPECT_EQ(std::set<std::uint32_t>(aovs.object.begin(), aovs.object.end()),
              (std::set<std::uint32_t>{0, 2, 3, CLARAY_MISS}));
    for (const std::uint32_t instance : aovs.instance) ASSERT_EQ(instance, CLARAY_MISS);
}

/// The renderer bakes two of the instances into the world and reorders the rest.
TEST(SurfaceLayers, InstancesAreThoseOfHits) {
    const Scene scene = placed_balls();
    const Aovs aovs = aovs_in(scene);
    std::vector<Bvh> bottoms;
    for (const Mesh& mesh : scene.meshes) bottoms.push_back(Bvh::build(device(), std::span(&mesh, 1)));
    std::vector<Instance> instances;
    for (const MeshInstance& instance : scene.instances)
        instances.push_back(make_instance(instance.transform, instance.mesh));
    std::vector<std::uint32_t> traced, meshes;
    for (const InstanceHit& hit : closest_hit(InstancedBvh::build(bottoms, instances), center_rays(scene))) {
        traced.push_back(hit.instance);
        meshes.push_back(hit.instance == CLARAY_MISS ? CLARAY_MISS : scene.instances[hit.instance].mesh);
    }
    expect_share_equal(aovs.instance, traced);
    expect_share_equal(aovs.object, meshes);
    EXPECT_EQ(std::set<std::uint32_t>(aovs.instance.begin(), aovs.instance.end()),
              (std::set<std::uint32_t>{0, 2, 3, 4, 5, CLARAY_MISS}));
}

TEST(SurfaceLayers, InstancesThatAreAllBakedKeepTheirNumbers) {
    Scene scene = placed_balls();
    scene.instances.resize(4);
    const Aovs aovs = aovs_in(scene);
    EXPECT_EQ(std::set<std::uint32_t>(aovs.instance.begin(), aovs.instance.end()),
              (std::set<std::uint32_t>{0, 2, 3, CLARAY_MISS}));
    for (std::size_t i = 0; i < aovs.instance.size(); ++i)
        if (aovs.instance[i] != CLARAY_MISS) {
            ASSERT_EQ(aovs.object[i], scene.instances[aovs.instance[i]].mesh);
        }
}

/// Their numbers in hits are ordered by kind, those of objects by the scene.
TEST(SurfaceLayers, SetsOfPrimitivesFollowTheMeshes) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(3.f, 0.f)};
    scene.primitives = {{.kind = PrimitiveSet::Kind::discs, .points = {{2, 1, 0, 0.9f}, {0, 0, 1, 0}}},
                        {.kind = PrimitiveSet::Kind::spheres, .points = {{-2, 1, 0, 0.9f}}},
                        {.kind = PrimitiveSet::Kind::spheres, .points = {{0, 1, 0, 0.9f}}}};
    scene.camera = Camera{{0, 1, 9}, {0, 1, 0}, {0, 1, 0}, 45.f};
    const Aovs aovs = aovs_in(scene);
    const auto object_at = [&](float x) {
        return aovs.object[image_side / 2 * image_side +
                           unsigned(image_side * (0.5f + x / (2 * 9 * std::tan(glm::radians(22.5f)))))];
    };
    EXPECT_EQ(object_at(2), 1u);
    EXPECT_EQ(object_at(-2), 2u);
    EXPECT_EQ(object_at(0), 3u);
}

TEST(SurfaceLayers, PositionsAndCoordinatesAreThoseOfTheTriangle) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {square(2.f, 0.f), square(2.f, 0.f)};
    scene.meshes[0].uvs = {{-1, 2}, {3, 2}, {3, 6}, {-1, 6}};
    const glm::mat4 turned = glm::rotate(placed_at({0, 1, 0}), 0.3f, glm::vec3(1, 0, 0));
    scene.instances = {{0, turned}, {0, placed_at({9, 0, 0})}, {1, placed_at({4, 0, 0})}};
    scene.camera = Camera{{0, 6, 3}, {0, 0, 0}, {0, 1, 0}, 60.f};
    const Aovs aovs = aovs_in(scene);
    const std::vector<Ray> rays = center_rays(scene);
    const Mesh& mesh = scene.meshes[0];
    // The square's uvs are an affine function of its positions.
    const glm::vec3 origin = mesh.positions[0], along = mesh.positions[1] - origin, down = mesh.positions[3] - origin;
    const glm::mat4 inverse = glm::inverse(turned);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (aovs.primitive[i] == CLARAY_MISS) {
            ASSERT_EQ(aovs.position[i], glm::vec3(0));
            continue;
        }
        const glm::vec3 point = glm::vec3(rays[i].ox, rays[i].oy, rays[i].oz) +
                                aovs.depth[i] * glm::vec3(rays[i].dx, rays[i].dy, rays[i].dz);
        ASSERT_LT(glm::distance(aovs.position[i], point), 2e-5f);
        if (aovs.instance[i] != 0) {
            ASSERT_EQ(aovs.uv[i], glm::vec2(0)) << "no coordinates";
            continue;
        }
        ++hits;
        const glm::vec3 local = glm::vec3(inverse * glm::vec4(point, 1)) - origin;
        const glm::vec2 place(glm::dot(local, along) / glm::dot(along, along),
                              glm::dot(local, down) / glm::dot(down, down));
        const glm::vec2 expected =
            mesh.uvs[0] + place.x * (mesh.uvs[1] - mesh.uvs[0]) + place.y * (mesh.uvs[3] - mesh.uvs[0]);
        ASSERT_LT(glm::distance(aovs.uv[i], expected), 2e-5f);
    }
    EXPECT_GT(hits, 100u);
}

TEST(SurfaceLayers, RoughnessAndEmissionAreTheMaterials) {
    const auto of = [](const Material& material) {
        Scene scene;
        scene.materials = {material};
        scene.meshes = {square(9.f, 0.f)};
        scene.camera = Camera{{0, 4, 0}, {0, 0, 0}, {0, 0, -1}, 40.f};
        const Aovs aovs = aovs_in(scene);
        return std::pair(aovs.roughness[0], aovs.emission[0]);
    };
    Material metal = material(MaterialKind::metal, 0.5f, 0.35f);
    metal.emission = {1, 20, 3};
    EXPECT_EQ(of(metal), std::pair(0.35f, glm::vec3(1, 20, 3)));
    EXPECT_EQ(of(material(MaterialKind::mirror, 0.5f, 0.35f)).first, 0.f);
    EXPECT_EQ(of(lambert(0.5f)).first, 1.f);
}

/// The centre of the image moves as the camera's matrix says.
TEST(SurfaceLayers, MotionIsThatOfTheImage) {
    Scene scene;
    scene.materials = {lambert(0.5f)};
    scene.meshes = {sphere(3)};
    const glm::vec3 way(0.5f, -0.25f, 0);
    scene.instances = {{0, glm::mat4(1.f), placed_at(way)}};
    scene.camera = Camera{{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 40.f};
    const std::size_t middle = image_side / 2 * image_side + image_side / 2;
    const auto pixels_per_unit = [](float distance) {
        return float(image_side) / (2 * distance * std::tan(glm::radians(20.f)));
    };
    const glm::vec2 expected = pixels_per_unit(7.f) * glm::vec2(way.x, -way.y);
    const Aovs moving = aovs_in(scene);
    EXPECT_LT(glm::distance(moving.motion[middle], expected), 0.02f);
    EXPECT_EQ(moving.motion[0], glm::vec2(0)) << "the sky stays";
    scene.instances[0].transform_end.reset();
    for (const glm::vec2& none : aovs_in(scene).motion) ASSERT_EQ(none, glm::vec2(0));
    scene.camera->position_end = scene.camera->position - way, scene.camera->target_end = -way;
    const Aovs camera = aovs_in(scene);
    EXPECT_LT(glm::distance(camera.motion[middle], expected), 0.02f);
    EXPECT_LT(glm::length(camera.motion[0]), 1e-4f) << "what is far away only turns";
    scene.camera->position_end.reset(), scene.camera->target_end = glm::vec3(8 * std::tan(0.1f), 0, 0);
    EXPECT_NEAR(aovs_in(scene).motion[middle].x, -pixels_per_unit(1.f) * std::tan(0.1f), 0.2f);
}

}  // namespace
}  // namespace claray::test
