// Device::prepare compiles what structures and queries need.
#include <gtest/gtest.h>

#include "claray/instances.hpp"
#include "claray/program.hpp"
#include "claray/query/all_hits.hpp"
#include "claray/query/points.hpp"
#include "tests/support/device.hpp"

namespace claray::test {
namespace {

unsigned programs_loaded() { return compile_statistics().compiled + compile_statistics().from_cache; }

/// What a first program does. Returns how many programs it had to compile or load.
unsigned use_everything(const Device& on, Builder builder) {
    const unsigned before = programs_loaded();
    Bvh::Config config;
    config.builder = builder;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    Bvh bvh = Bvh::build(on, std::vector<Mesh>{mesh}, config);
    const std::vector<Ray> rays(2, Ray{0, 0, 5, 0, 0, 0, -1, 100});
    (void)closest_hit(bvh, rays);
    (void)any_hit(bvh, rays);
    (void)all_hits(bvh, rays);
    const std::vector<glm::vec3> points(2, glm::vec3(0.1f));
    (void)nearest_point(bvh, points);
    (void)signed_distance(bvh, points);
    InstancedBvh placed =
        InstancedBvh::build(std::vector<Bvh>{bvh}, std::vector<Instance>{make_instance(glm::mat4(1))});
    (void)closest_hit(placed, rays);
    (void)any_hit(placed, rays);
    placed.rebuild();
    bvh.refit();
    bvh.rebuild();
    on.finish();
    return programs_loaded() - before;
}

TEST(Prepare, LeavesNothingToCompile) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    fresh.prepare();
    EXPECT_EQ(use_everything(fresh, Builder::automatic), 0u);
    EXPECT_EQ(use_everything(fresh, Builder::high), 0u);
    const Device other = Device::open(std::to_string(device().info().index));
    EXPECT_GT(use_everything(other, Builder::automatic), 0u) << "without it";
}

}  // namespace
}  // namespace claray::test
