// The tree that picks among many lights: host/lights/light_tree.cpp, lights/light_tree.clh.
#include "host/lights/light_tree.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "claray/program.hpp"
#include "host/lights/lights.hpp"
#include "tests/render/scenes.hpp"
#include "tests/support/device.hpp"
#include "tests/support/statistics.hpp"

namespace claray::test {
namespace {

/// Triangles, spots and points of very different power in a box; some at the same place.
Scene many(std::uint32_t triangles, std::uint32_t spots, std::uint32_t points) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    const auto place = [&] { return glm::vec3(2 * unit(random), 1.5f + unit(random), 2 * unit(random)); };
    Scene scene;
    scene.materials = {lambert(0.5f), emitter(0.3f), emitter(4.f)};
    scene.meshes = {square(5.f, 0.f), Mesh{}};
    Mesh& mesh = scene.meshes[1];
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const glm::vec3 at = place();
        for (int k = 0; k < 3; ++k)
            mesh.positions.push_back(at + 0.1f * glm::vec3(unit(random), unit(random), unit(random)));
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        mesh.materials.push_back(1 + i % 2);
    }
    for (std::uint32_t i = 0; i < spots + points; ++i) {
        Light light =
            point_light(i % 5 == 4 ? scene.lights.back().position : place(), glm::vec3(0.1f + std::abs(unit(random))));
        light.direction = place() - glm::vec3(0, 2, 0);
        if (i < spots) light.kind = LightKind::spot;
        scene.lights.push_back(light);
    }
    return scene;
}

Scene with_ranges(Scene scene, float range) {
    for (std::size_t i = 0; i < scene.lights.size(); ++i)
        scene.lights[i].range = range * (i % 3 == 0 ? 1.f : 0.6f), scene.lights[i].linear_range = i % 5 == 1;
    return scene;
}

const char* kernels = R"(
    #include "lights/light.clh"
    kernel void pick(global const LightNode* tree, global const LightLeaf* leaves, uint lights, float x, float y, float z, float nx, float ny, float nz,
                     global const uint* random, uint count, global uint* light, global float* probability) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        const SamplePair words = {random[i], hash_word(random[i])};
        float2 rest;
        float share;
        light[i] = pick_from_tree(tree, 1u, leaves, lights, (float3)(x, y, z), (float3)(nx, ny, nz), words, &rest, &share);
        probability[i] = share;
    }
    kernel void find(global const LightLeaf* leaves, uint lights, global const uint* numbers, uint count,
                     global uint* light) {
        const uint i = get_global_id(0);
        if (i < count) light[i] = find_leaf(leaves, lights, numbers[i]).light;
    }
    kernel void probabilities(global const LightNode* tree, global const LightLeaf* leaves, float x, float y, float z,
                              float nx, float ny, float nz, global const uint* trails, uint count,
                              global float* probability) {
        const uint i = get_global_id(0);
        if (i >= count) return;
        const uint light = leaves[i].light;
        probability[light] = tree_probability(tree, 1u, leaves + i, (float3)(x, y, z), (float3)(nx, ny, nz), trails[light]);
    })";

/// All trails of a tree, by walking through it; every light must be met once.
std::vector<std::uint32_t> trails_of(const std::vector<LightNode>& tree, std::size_t lights) {
    std::vector<std::uint32_t> trails(lights), met(lights, 0u);
    const std::function<void(std::uint32_t, unsigned, std::uint32_t)> walk = [&](std::uint32_t node, unsigned level,
                                                                                 std::uint32_t trail) {
        ASSERT_LT(level, unsigned(CLARAY_LIGHT_TREE_HEIGHT));
        for (std::uint32_t i = 0; i < CLARAY_LIGHT_TREE_WIDTH; ++i) {
            if (tree[node].intensity[i] == 0) continue;
            const std::uint32_t child = tree[node].child[i], below = trail | i << 2 * level;
            if (child & CLARAY_LIGHT_LEAF) {
                trails[child & ~CLARAY_LIGHT_LEAF] = below;
                ++met[child & ~CLARAY_LIGHT_LEAF];
            } else {
                walk(child, level + 1, below);
            }
        }
    };
    walk(0, 0, 0);
    EXPECT_EQ(met, std::vector<std::uint32_t>(lights, 1));
    return trails;
}

struct Case {
    const char* name;
    std::uint32_t triangles, spots, points;
    float range = 0;
};
class LightTrees : public testing::TestWithParam<Case> {};

TEST_P(LightTrees, LightsArePickedByTheProbabilityThatTheTrailGives) {
    const Case& of = GetParam();
    const Lights lights =
        collect_lights(with_ranges(many(of.triangles, of.spots, of.points), of.range), {.most_per_cell = 0});
    const std::size_t size = lights.data.near;
    ASSERT_FALSE(lights.tree.empty());
    const std::vector<std::uint32_t> trails = trails_of(lights.tree, size);
    for (std::size_t i = 0; i < lights.trails.size(); ++i) {
        EXPECT_EQ(lights.trails[i].trail, trails[i]);
        EXPECT_EQ(lights.trails[i].primitive, lights.triangles[i].primitive);
        EXPECT_EQ(lights.leaves[lights.trails[i].leaf].light, i);
    }
    const std::uint32_t count = 1u << 20;
    std::mt19937 generator(9);
    std::vector<std::uint32_t> random(count);
    for (std::uint32_t& word : random) word = std::uint32_t(generator());
    random[0] = 0, random[1] = 0xffffffffu;
    const Buffer<LightNode> tree(device(), lights.tree);
    const Buffer<LightLeaf> leaves(device(), lights.leaves);
    const Buffer<std::uint32_t> input(device(), random), trail_buffer(device(), trails), picked(device(), count);
    const Buffer<float> picked_probability(device(), count), probability(device(), size);
    Kernel pick = compile_kernel(device(), kernels, "pick"), all = compile_kernel(device(), kernels, "probabilities");
    for (const auto& [from, normal] : {std::pair{glm::vec3(0, 0, 0), glm::vec3(0, 1, 0)},
                                       {glm::vec3(0.3f, 1.4f, 0.2f), glm::vec3(0.6f, 0, 0.8f)},
                                       {glm::vec3(9, 1, 5), glm::vec3(0, 0, 0)},
                                       {glm::vec3(0, 1.5f, 3), glm::vec3(0, 0, -1)}}) {
        pick.run({count}, tree, leaves, std::uint32_t(size), from.x, from.y, from.z, normal.x, normal.y, normal.z,
                 input, count, picked, picked_probability);
        all.run({size}, tree, leaves, from.x, from.y, from.z, normal.x, normal.y, normal.z, trail_buffer,
                std::uint32_t(size), probability);
        const std::vector<float> expected_shares = probability.read(), shares = picked_probability.read();
        std::vector<double> observed(size + 1), expected(size + 1);  // the last is no light
        double total = 0;
        for (std::size_t i = 0; i < size; ++i)
            expected[i] = double(count) * expected_shares[i], total += expected_shares[i];
        if (of.spots == 0 && of.range == 0) {
            EXPECT_NEAR(total, 1, 1e-5);
        }
        EXPECT_LT(total, 1 + 1e-5);
        expected[size] = total < 1 - 1e-5 ? count * (1 - total) : 0;
        const std::vector<std::uint32_t> chosen = picked.read();
        for (std::size_t i = 0; i < count; ++i) {
            const bool none = shares[i] == 0.f;
            ASSERT_TRUE(none ? expected[size] > 0 : shares[i] == expected_shares[chosen[i]]);
            ++observed[none ? size : chosen[i]];
        }
        const ChiSquared chi2 = chi_squared(observed, expected);
        EXPECT_TRUE(chi2.degrees == 0 || chi2.plausible())
            << chi2.value << " for " << chi2.degrees << " degrees of freedom";
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, LightTrees,
                         testing::Values(Case{"Points", 0, 0, 17}, Case{"Triangles", 900, 0, 0},
                                         Case{"Mixed", 300, 60, 200}, Case{"Spots", 0, 40, 0},
                                         Case{"Ranges", 0, 0, 70, 3.f}, Case{"All", 20, 60, 200, 1.5f}),
                         [](const auto& c) { return c.param.name; });

/// The 2^32 numbers are assigned to the leaves in order, and for each number one leaf suffices to find its light.
TEST(LightTree, SharesItsNumbersByIntensity) {
    const std::uint32_t sizes[] = {2, 3, 17, 1000};
    for (const std::uint32_t size : sizes) {
        std::mt19937 random(size);
        std::uniform_real_distribution<float> unit(-1.f, 1.f);
        std::vector<LightBounds> bounds(size);
        double all = 0;
        for (LightBounds& light : bounds) {
            light.box.grow({unit(random), unit(random), unit(random)});
            light.spread = 3.2f, light.intensity = std::exp(12.f * unit(random));
            all += light.intensity;
        }
        const LightTree tree = build_light_tree(bounds);
        std::uint64_t next = 0;
        for (std::uint32_t i = 0; i < size; ++i) {
            const LightLeaf& leaf = tree.leaves[i];
            ASSERT_EQ(leaf.first, next);
            ASSERT_GE(leaf.last, leaf.first);
            next = std::uint64_t(leaf.last) + 1;
            EXPECT_EQ(tree.places[leaf.light], i);
            EXPECT_NEAR(double(next - leaf.first), 4294967296.0 * bounds[leaf.light].intensity / all, 2.0 + size);
        }
        EXPECT_EQ(next, std::uint64_t(1) << 32);
        for (const LightNode& node : tree.nodes)
            for (std::uint32_t i = 0; i < CLARAY_LIGHT_TREE_WIDTH; ++i) {
                double below = 0;  // of the leaves that have numbers from the child's share
                for (const LightLeaf& leaf : tree.leaves)
                    if (leaf.first >= node.first[i] && leaf.last - node.first[i] < node.span[i])
                        below += bounds[leaf.light].intensity;
                EXPECT_NEAR(below, node.intensity[i], 1e-5 * node.intensity[i]);
            }
        Kernel find = compile_kernel(device(), kernels, "find");
        std::vector<std::uint32_t> numbers = {0, 0xffffffffu}, expected = {0, size - 1};
        for (std::uint32_t i = 0; i < size; ++i) {
            numbers.insert(numbers.end(), {tree.leaves[i].first, tree.leaves[i].last});
            expected.insert(expected.end(), {i, i});
        }
        const auto count = std::uint32_t(numbers.size());
        const Buffer<std::uint32_t> found(device(), count);
        find.run({count}, Buffer<LightLeaf>(device(), tree.leaves), size, Buffer<std::uint32_t>(device(), numbers),
                 count, found);
        for (std::uint32_t& leaf : expected) leaf = tree.leaves[leaf].light;
        EXPECT_EQ(found.read(), expected) << size << " lights";
    }
}

/// A child's sphere holds the boxes of its lights, its cone their cones; and whether they look alike from far away is
/// told by the radius' sign. (Where a bound of light without an edge is too narrow, no light is lost, but there is
/// noise: LEAST_COSINE.)
TEST(LightTree, BoundsHoldTheirLights) {
    for (const int two_sided : {0, 1, 2}) {  // 2: some are
        std::mt19937 random(7);
        std::uniform_real_distribution<float> unit(-1.f, 1.f);
        std::vector<LightBounds> bounds(400);
        for (std::size_t i = 0; i < bounds.size(); ++i) {
            LightBounds& light = bounds[i];
            const glm::vec3 at(unit(random), unit(random), unit(random));
            light.box.grow(at), light.box.grow(at + 0.1f * glm::vec3(unit(random), unit(random), unit(random)));
            light.axis = glm::normalize(glm::vec3(0.5f * unit(random) + at.x, 0.5f * unit(random), 1.f));
            if (two_sided != 0 && i % 2 == 0) light.axis = -light.axis;
            light.spread = 0.4f + 0.4f * unit(random), light.reach = 1.f + 0.5f * unit(random), light.intensity = 1.f;
            light.two_sided = two_sided == 1 || (two_sided == 2 && i % 3 == 0);
        }
        const LightTree tree = build_light_tree(bounds);
        for (const LightNode& node : tree.nodes)
            for (std::uint32_t i = 0; i < CLARAY_LIGHT_TREE_WIDTH; ++i) {
                if (node.span[i] == 0) continue;
                const glm::vec3 center(node.x[i], node.y[i], node.z[i]),
                    axis(node.axis_x[i], node.axis_y[i], node.axis_z[i]);
                const bool both = node.cos_reach[i] == CLARAY_TWO_SIDED_CONE;
                const float spread = std::acos(node.cos_spread[i]);
                for (const LightLeaf& leaf : tree.leaves) {
                    if (leaf.first < node.first[i] || leaf.last - node.first[i] >= node.span[i]) continue;
                    const LightBounds& light = bounds[leaf.light];
                    for (const glm::vec3& corner : {light.box.lo, light.box.hi})
                        EXPECT_LE(glm::length(corner - center), 1.0001f * std::abs(node.radius[i]) + 1e-5f);
                    if (node.cos_spread[i] == -1.f) continue;  // all directions
                    EXPECT_EQ(both, light.two_sided);
                    const float cosine = glm::dot(axis, light.axis);
                    const float off = std::acos(std::clamp(both ? std::abs(cosine) : cosine, -1.f, 1.f));
                    EXPECT_LE(off + light.spread, spread + 2e-3f);
                    if (!both) {
                        EXPECT_LE(node.cos_reach[i], std::cos(light.reach) + 1e-5f);
                    }
                }
                EXPECT_EQ(node.radius[i] >= 0.f, spread < 0.3f) << spread;
            }
    }
}

/// No light that reaches a point may have probability 0 there, and points and spots that do not reach it have it.
void expect_picks_where_light_is(const Scene& scene) {
    const Lights lights = collect_lights(scene, {.most_per_cell = 0});
    const std::size_t size = lights.data.near;
    const std::vector<std::uint32_t> trails = trails_of(lights.tree, size);
    const Buffer<LightNode> tree(device(), lights.tree);
    const Buffer<LightLeaf> leaves(device(), lights.leaves);
    const Buffer<std::uint32_t> trail_buffer(device(), trails);
    const Buffer<float> probability(device(), size);
    Kernel all = compile_kernel(device(), kernels, "probabilities");
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(-1.f, 1.f);
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 from(2 * unit(random), 1.5f + unit(random), 2 * unit(random));
        const glm::vec3 normal = glm::normalize(glm::vec3(unit(random), unit(random), unit(random)));
        all.run({size}, tree, leaves, from.x, from.y, from.z, normal.x, normal.y, normal.z, trail_buffer,
                std::uint32_t(size), probability);
        const std::vector<float> shares = probability.read();
        for (std::size_t l = 0; l < size; ++l) {
            bool reaches = false, ends_before = false;
            if (l < lights.triangles.size()) {
                const TriangleLight& t = lights.triangles[l];
                const glm::vec3 v0(t.v0x, t.v0y, t.v0z), e1(t.e1x, t.e1y, t.e1z), e2(t.e2x, t.e2y, t.e2z);
                for (const glm::vec3& corner : {v0, v0 + e1, v0 + e2})
                    reaches = reaches || glm::dot(corner - from, normal) > 0.f;
            } else {
                const PunctualLight& p = lights.punctual[l - lights.triangles.size()];
                const glm::vec3 towards = glm::vec3(p.x, p.y, p.z) - from;
                const glm::vec3 axis(p.direction_x, p.direction_y, p.direction_z);
                const float cosine = glm::dot(-glm::normalize(towards), axis);
                const float inside =
                    p.kind == CLARAY_POINT_LIGHT ? 1.f : cosine * p.cone_scale + p.cone_offset;  // the cone
                const float share = glm::length(towards) * std::abs(p.inverse_range);            // of the range
                reaches = glm::dot(towards, normal) > 0.f && inside > 0.f && share < 1.f;
                ends_before = inside < -1e-3f * p.cone_scale || share > 1.001f;
            }
            if (reaches) {
                ASSERT_GT(shares[l], 0.f) << "light " << l;
            }
            if (ends_before) {
                ASSERT_EQ(shares[l], 0.f) << "light " << l;
            }
        }
    }
}

TEST(LightTree, PicksWhereLightIs) {
    expect_picks_where_light_is(many(200, 80, 50));
    expect_picks_where_light_is(with_ranges(many(50, 80, 150), 1.f));
    Scene sharp = with_ranges(many(0, 200, 0), 2.5f);
    for (Light& light : sharp.lights) light.inner_angle = light.outer_angle = 0.3f;
    expect_picks_where_light_is(sharp);
}

/// Of many lights, those close to a surface are picked as often as their share of the light demands, though the
/// clusters around them are large.
void expect_close_lights_are_picked(const Scene& scene) {
    const Lights lights = collect_lights(scene, {.most_per_cell = 0});
    const std::size_t size = lights.data.near;
    const Buffer<LightNode> tree(device(), lights.tree);
    const Buffer<LightLeaf> leaves(device(), lights.leaves);
    const Buffer<std::uint32_t> trails(device(), trails_of(lights.tree, size));
    const Buffer<float> probability(device(), size);
    Kernel all = compile_kernel(device(), kernels, "probabilities");
    for (std::size_t close = 100; close < size; close += 50) {
        const PunctualLight& light = lights.punctual[close];
        const glm::vec3 normal = glm::normalize(glm::vec3(1, 2, close % 3));
        const glm::vec3 from = glm::vec3(light.x, light.y, light.z) - 0.005f * normal;
        all.run({size}, tree, leaves, from.x, from.y, from.z, normal.x, normal.y, normal.z, trails, std::uint32_t(size),
                probability);
        const std::vector<float> shares = probability.read();
        double there = 0;  // lights at the same place
        for (std::size_t i = 0; i < size; ++i) {
            const PunctualLight& p = lights.punctual[i];
            if (p.x == light.x && p.y == light.y && p.z == light.z) there += shares[i];
        }
        EXPECT_GT(there, 0.8) << "light " << close;
    }
}

TEST(LightTree, PicksLightsThatAreClose) { expect_close_lights_are_picked(many(0, 100, 900)); }

TEST(LightTree, PicksLightsWithRangesThatAreClose) {
    expect_close_lights_are_picked(with_ranges(many(0, 100, 900), 1.5f));
}

/// Lamps whose dark side faces the point are hardly ever picked.
TEST(LightTree, KnowsWhichSideShines) {
    Scene scene;
    scene.materials = {emitter(1.f)};
    scene.materials[0].cull_back = true;
    for (int i = 0; i < 20; ++i) {  // those at x > 0 shine down
        scene.meshes.push_back(square(0.05f, 1.f));
        for (glm::vec3& p : scene.meshes.back().positions)
            p += glm::vec3(i < 10 ? -0.8f : 0.8f, 0.f, 0.2f * float(i % 10) - 0.9f);
        if (i >= 10)
            for (glm::uvec3& t : scene.meshes.back().triangles) std::swap(t.y, t.z);
    }
    const Lights lights = collect_lights(scene, {.most_per_cell = 0});
    const std::size_t size = lights.data.near;
    ASSERT_EQ(size, 40u);
    const Buffer<std::uint32_t> trails(device(), trails_of(lights.tree, size));
    const Buffer<float> probability(device(), size);
    compile_kernel(device(), kernels, "probabilities")
        .run({size}, Buffer<LightNode>(device(), lights.tree), Buffer<LightLeaf>(device(), lights.leaves), 0.f, 0.f,
             0.f, 0.f, 1.f, 0.f, trails, std::uint32_t(size), probability);
    double dark = 0;
    const std::vector<float> shares = probability.read();
    for (std::size_t i = 0; i < 20; ++i) dark += shares[i];
    EXPECT_LT(dark, 0.05);
}

/// The same light for every way of picking.
TEST(LightTree, ChangesNoImageButItsNoise) {
    struct Arrangement {
        Scene scene;
        double share;  // at most, of the noise of picking by power
    };
    for (const auto& [with, share] : {Arrangement{many(200, 0, 0), 0.8},
                                      {many(0, 30, 40), 0.8},
                                      {many(50, 20, 20), 0.8},
                                      {with_ranges(many(0, 0, 1500), 1.2f), 0.5}}) {  // too many for a grid
        Scene scene = with;
        // Down to the floor, from below all lights: no choice among lights changes the noise of those in view.
        scene.camera = Camera{{0, 0.4f, 1.3f}, {0, 0, 0.9f}, {0, 1, 0}, 40.f};
        double means[2], errors[2];
        for (const bool by_power : {false, true}) {
            RenderConfig config{.width = 24, .height = 24, .spp = 256, .max_depth = 2};
            config.effects.remove = {Effect::light_lists};
            if (by_power) config.effects.remove.add(Effect::many_lights);
            Renderer renderer(device(), scene, config);
            (void)renderer.render();
            const std::vector<glm::vec3> image = renderer.image();
            renderer.restart(1);
            (void)renderer.render();
            const std::vector<glm::vec3> other = renderer.image();
            double squares = 0;
            for (std::size_t p = 0; p < image.size(); ++p) squares += std::pow(image[p].x - other[p].x, 2);
            means[by_power] = mean(image).x;
            errors[by_power] = std::sqrt(squares / 2) / (24 * 24) / means[by_power];
        }
        EXPECT_NEAR(means[0] / means[1], 1, 3 * std::hypot(errors[0], errors[1]) + 1e-4);
        EXPECT_LT(errors[0], share * errors[1]);
    }
}

/// Kernels that know points open no cluster of triangles either.
TEST(LightTree, OfTrianglesIsTheSameInKernelsOfOtherScenes) {
    Scene scene = many(200, 0, 0);
    scene.camera = Camera{{0, 0.4f, 1.3f}, {0, 0, 0.9f}, {0, 1, 0}, 40.f};
    const RenderConfig config{.width = 24, .height = 24, .spp = 8, .max_depth = 4};
    EXPECT_TRUE(same_bits(render_image(scene, config), render_by_own_kernels(scene, config)));
}

/// Sixteen rays at once (lights/light_tree_sixteen.clh), where there are no spots, pick the same lights.
TEST(LightTree, PicksTheSameBitsSixteenAtOnce) {
    for (const Scene& with : {many(16, 0, 0), many(200, 0, 0), many(0, 0, 70), with_ranges(many(0, 0, 70), 1.f)})
        for (const unsigned width : {1u, 13u}) {
            Scene scene = with;
            scene.camera = Camera{{0, 0.4f, 1.3f}, {0, 0.2f, 0}, {0, 1, 0}, 60.f};
            RenderConfig config{.width = width, .height = 17, .spp = 5, .max_depth = 4};
            config.effects.remove = {Effect::light_lists};
            const std::vector<glm::vec3> image = render_image(scene, config);
            config.effects.add = {Effect::spot_lights};
            EXPECT_TRUE(same_bits(image, render_image(scene, config)))
                << width << " pixels wide, " << with.lights.size() << " lights";
        }
}

/// Lights beside an environment and a directional light: the tree has its share of the random numbers.
TEST(LightTree, SharesWithLightsFromFarAway) {
    Scene scene = many(100, 0, 30);
    scene.camera = Camera{{0, 0.4f, 2}, {0, 0, 0}, {0, 1, 0}, 40.f};
    const RenderConfig config{.width = 24, .height = 24, .spp = 256, .max_depth = 1};
    Scene far = scene;
    far.lights.clear();
    for (Material& m : far.materials) m.emission = glm::vec3(0.f);
    Light sun;
    sun.kind = LightKind::directional, sun.direction = {1, -1, 0.2f};
    Texture image;
    image.width = 2, image.height = 1, image.channels = 1, image.format = TexelFormat::float32;
    image.floats = {0.2f, 0.1f};
    far.lights = {sun}, far.environment.images = {image};
    Scene both = scene;
    both.lights.push_back(sun), both.environment = far.environment;
    const double apart = mean(render_image(scene, config)).x + mean(render_image(far, config)).x;
    EXPECT_NEAR(mean(render_image(both, config)).x / apart, 1, 0.005);
}

/// All lights at one place: no plane separates them, and the trails stay within their bits.
TEST(LightTree, HoldsLightsThatCannotBeTold) {
    std::vector<LightBounds> same(5000);
    for (LightBounds& light : same) light.box.grow({1, 2, 3}), light.intensity = 1, light.spread = 3.2f;
    (void)trails_of(build_light_tree(same).nodes, same.size());
    for (std::size_t i = 0; i < same.size(); ++i) same[i].box = {}, same[i].box.grow({std::pow(0.98, double(i)), 0, 0});
    (void)trails_of(build_light_tree(same).nodes, same.size());
}

}  // namespace
}  // namespace claray::test
