// Instances of more than two levels, flattened: against meshes that are transformed level by level.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "claray/instances.hpp"
#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/meshes.hpp"

namespace claray::test {
namespace {

glm::mat4 placement(int i) {
    const float a = float(i);
    return glm::scale(glm::rotate(glm::translate(glm::mat4(1.f), {a * 2, a * 0.5f, -a}), a, {1, 2, a}),
                      glm::vec3(1 + 0.1f * a));
}

/// Four levels: a leaf in a twig, twigs and a leaf in a branch, branches in a tree.
struct Forest {
    std::vector<InstanceGroup> groups = {
        {{make_instance(placement(1), 0, 0xff, 11), make_instance(placement(2), 1, 0x0f, 12)}},  // 2: twig
        {{make_instance(placement(3), 2, 0xfc), make_instance(placement(4), 0, 0xff, 13)}},      // 3: branch
        {{make_instance(placement(-1), 3), make_instance(placement(5), 3, 0x3f), make_instance(placement(2), 2)}}};
    std::vector<Instance> roots = {make_instance(placement(-2), 4), make_instance(placement(-3), 1, 0xf0, 14)};
    FlatInstances flat = flatten(roots, groups, 2);
};

TEST(NestedInstances, AreReachedByTheirSteps) {
    const Forest forest;
    ASSERT_EQ(forest.flat.instances.size(), 3u + 3u + 2u + 1u);
    ASSERT_EQ(forest.flat.offsets.size(), 10u);
    for (std::size_t i = 0; i < forest.flat.instances.size(); ++i) {
        const Instance* at = nullptr;
        glm::dmat4 placed(1.0);
        std::uint32_t mask = 0xffffffffu;
        std::span<const Instance> members = forest.roots;
        for (std::uint32_t s = forest.flat.offsets[i]; s < forest.flat.offsets[i + 1]; ++s) {
            at = &members[forest.flat.steps[s]];
            glm::dmat4 m(1.0);
            for (int k = 0; k < 4; ++k) m[k] = glm::dvec4(at->row0[k], at->row1[k], at->row2[k], k == 3);
            placed = placed * m;
            mask &= at->mask;
            if (at->bottom >= 2) members = forest.groups[at->bottom - 2].members;
        }
        const Instance& flat = forest.flat.instances[i];
        ASSERT_LT(at->bottom, 2u) << "the last step is a structure";
        EXPECT_EQ(flat.bottom, at->bottom);
        EXPECT_EQ(flat.id, at->id);
        EXPECT_EQ(flat.mask, mask);
        for (int k = 0; k < 4; ++k) {
            EXPECT_EQ(flat.row0[k], float(placed[k].x));
            EXPECT_EQ(flat.row1[k], float(placed[k].y));
            EXPECT_EQ(flat.row2[k], float(placed[k].z));
        }
    }
}

TEST(NestedInstances, AreHitWhereTheirCopiesAre) {
    const Forest forest;
    const Mesh meshes[] = {sphere(2), soup(60, 0.5f, 3)};
    const Bvh bottoms[] = {Bvh::build(device(), std::span(meshes, 1)), Bvh::build(device(), std::span(meshes + 1, 1))};
    const InstancedBvh placed = InstancedBvh::build(bottoms, forest.flat.instances);
    std::vector<Mesh> copies;
    for (const Instance& instance : forest.flat.instances) {
        Mesh copy = meshes[instance.bottom];
        for (glm::vec3& p : copy.positions) {
            const auto row = [&](const float* r) { return r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3]; };
            p = {row(instance.row0), row(instance.row1), row(instance.row2)};
        }
        copies.push_back(std::move(copy));
    }
    const std::vector<Ray> rays = random_rays(2000, 8.f, 4.f, 5);
    const std::vector<Hit> expected = closest_hit(Bvh::build(device(), copies), rays);
    const std::vector<InstanceHit> hits = closest_hit(placed, rays);
    std::size_t hit = 0, equal = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (expected[i].primitive == CLARAY_MISS) continue;
        ++hit;
        equal += hits[i].instance == expected[i].geometry && std::abs(hits[i].t - expected[i].t) < 1e-3f;
    }
    EXPECT_GT(hit, 300u);
    EXPECT_GT(double(equal), 0.99 * double(hit)) << "rays past edges may differ, since copies are rounded";
}

TEST(NestedInstances, RefuseWhatCannotBePlaced) {
    const Instance root[] = {make_instance(glm::mat4(1.f), 1)};
    const std::vector<InstanceGroup> circle = {{{make_instance(glm::mat4(1.f), 2)}},
                                               {{make_instance(glm::mat4(1.f), 1)}}};
    EXPECT_TRUE(throws_error(ErrorKind::usage, "group 0 contains itself", [&] { (void)flatten(root, circle, 1); }));
    EXPECT_TRUE(throws_error(ErrorKind::usage, "bottom level 1 of 1", [&] { (void)flatten(root, {}, 1); }));
    EXPECT_TRUE(flatten({}, circle, 1).instances.empty());
}

}  // namespace
}  // namespace claray::test
