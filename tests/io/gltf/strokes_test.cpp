// Points and lines as spheres and tubes: measured by what they enclose.
#include "host/io/strokes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace claray {
namespace {

/// Volume that a closed surface encloses, by the divergence theorem; positive where its fronts are outside.
double volume(const Mesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

/// Normals of length 1 on the side of the fronts, one material a triangle.
void expect_sound(const Mesh& mesh) {
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.materials.size(), mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const glm::dvec3 front = glm::normalize(glm::cross(b - a, c - a));
        for (int k = 0; k < 3; ++k) {
            ASSERT_NEAR(glm::length(mesh.normals[t[k]]), 1, 1e-5);
            ASSERT_GT(glm::dot(front, glm::dvec3(mesh.normals[t[k]])), 0.9);
        }
    }
}

Strokes one(glm::vec3 a, glm::vec3 b) {
    Strokes strokes;
    strokes.positions = {a, b};
    strokes.triangles = {a == b ? glm::uvec3(0, 0, 0) : glm::uvec3(0, 1, 1)};
    strokes.materials = {5};
    return strokes;
}

TEST(Strokes, APointIsASphere) {
    const Mesh ball = solid_strokes(one({3, 4, 5}, {3, 4, 5}), 0.5f);
    expect_sound(ball);
    for (std::size_t i = 0; i < ball.positions.size(); ++i)
        EXPECT_NEAR(glm::distance(ball.positions[i], glm::vec3(3, 4, 5)), 0.5, 1e-6);
    EXPECT_NEAR(volume(ball) / (4 * std::numbers::pi / 3 * 0.125), 1, 0.06);
    EXPECT_EQ(ball.materials[0], 5u);
}

/// In directions with each axis as the largest, and one along an axis.
TEST(Strokes, ASegmentIsATubeWithASphereAtEachEnd) {
    for (const glm::vec3 along : {glm::vec3(2, 0, 0), glm::vec3(0.1f, -3, 1), glm::vec3(0.5f, 0.5f, 4)}) {
        const Mesh solid = solid_strokes(one({0, 0, 0}, along), 0.25f);
        expect_sound(solid);
        const double length = double(glm::length(along));
        // Spheres count whole, and the tube, which has no ends, in full: its ends' planes go through their centres.
        const double expected = std::numbers::pi * 0.0625 * length + 2 * 4 * std::numbers::pi / 3 * 0.015625;
        const glm::vec3 middle = 0.5f * along;
        Mesh centered = solid;
        for (glm::vec3& p : centered.positions) p -= middle;
        // About its middle, a tube without ends gives two thirds of its volume.
        const double tube = std::numbers::pi * 0.0625 * length / 3;
        EXPECT_NEAR(volume(centered) / (expected - tube), 1, 0.06);
        for (const glm::vec3& p : solid.positions) {
            const float t = glm::clamp(glm::dot(p, along) / glm::dot(along, along), 0.f, 1.f);
            EXPECT_LE(glm::distance(p, t * along), 0.25 + 1e-5);
        }
    }
}

TEST(Strokes, SharedPlacesHaveOneSphere) {
    Strokes strokes;
    strokes.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {1, 1, 0}};  // a corner that is there twice
    strokes.triangles = {{0, 1, 1}, {2, 3, 3}};
    strokes.materials = {0, 0};
    const std::size_t ball = solid_strokes(one({}, {}), 1.f).triangles.size();
    const std::size_t tube = solid_strokes(one({}, {1, 0, 0}), 1.f).triangles.size() - 2 * ball;
    EXPECT_EQ(solid_strokes(strokes, 0.1f).triangles.size(), 3 * ball + 2 * tube);
}

TEST(Strokes, KeepColoursAndCoordinates) {
    Strokes strokes = one({0, 0, 0}, {1, 0, 0});
    strokes.colors = {{1, 0, 0, 1}, {0, 0, 1, 0.5f}};
    strokes.uvs = {{0.25f, 0.5f}, {0.75f, 1.f}};
    strokes.uvs1 = {{0.1f, 0.2f}, {0.3f, 0.4f}};
    strokes.mask = 6;
    const Mesh solid = solid_strokes(strokes, 0.1f);
    ASSERT_EQ(solid.colors.size(), solid.positions.size());
    ASSERT_EQ(solid.uvs.size(), solid.positions.size());
    ASSERT_EQ(solid.uvs1.size(), solid.positions.size());
    EXPECT_EQ(solid.mask, 6u);
    for (std::size_t i = 0; i < solid.positions.size(); ++i) {
        const std::size_t end = solid.positions[i].x > 0.5f;
        EXPECT_EQ(solid.colors[i], strokes.colors[end]);
        EXPECT_EQ(solid.uvs[i], strokes.uvs[end]);
        EXPECT_EQ(solid.uvs1[i], strokes.uvs1[end]);
    }
}

TEST(Strokes, ManyAreCoarserAndThinner) {
    Strokes many;
    for (std::uint32_t i = 0; i < 40'000; ++i) {
        many.positions.emplace_back(float(i % 200), float(i / 200), 0.f);
        many.triangles.emplace_back(i, i, i);
    }
    many.materials.assign(40'000, 0);
    EXPECT_EQ(solid_strokes(many, 0.1f).triangles.size(), 40'000u * 20);
    for (std::uint32_t i = 0; i < 40'000; ++i) many.triangles[i] = {i, i + 1 - 2 * (i % 2), i + 1 - 2 * (i % 2)};
    EXPECT_EQ(solid_strokes(many, 0.1f).triangles.size(), 40'000u * (20 + 2 * 8)) << "tubes";
    Bounds bounds;
    bounds.grow({0, 0, 0}), bounds.grow({3, 4, 0});
    EXPECT_FLOAT_EQ(stroke_radius(bounds, 7), 5.f / 400);
    EXPECT_FLOAT_EQ(stroke_radius(bounds, 1'000'000), 5.f / 2000);
    EXPECT_EQ(stroke_radius(Bounds(), 7), 1.f);
    Bounds point;
    point.grow({1, 1, 1});
    EXPECT_EQ(stroke_radius(point, 1), 1.f);
}

}  // namespace
}  // namespace claray
