// Shapes of scene files: areas, fronts and coordinates; pbrt's equal-area square.
#include "host/io/world/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>

#include "host/io/world/octahedral.hpp"

namespace claray {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// Twice the volume's third: positive where fronts are outside of the origin.
double outward(const Mesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles)
        sum += glm::dot(glm::dvec3(mesh.positions[t.x]),
                        glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z])));
    return sum / 6;
}

TEST(WorldShapes, HaveTheirAreasAndFrontsOutside) {
    EXPECT_NEAR(area_of(sphere_part(turn, 0, turn / 2)), 2 * turn, 0.01);
    EXPECT_NEAR(outward(sphere_part(turn, 0, turn / 2)), 2 * turn / 3, 0.01);
    EXPECT_NEAR(area_of(sphere_for_lamps()), 2 * turn, 1e-4);
    EXPECT_NEAR(area_of(disc_part(0.5, turn)), 0.75 * turn / 2, 0.002);
    EXPECT_NEAR(area_of(tube_part(turn / 2)), turn / 2, 0.002);
    EXPECT_NEAR(area_of(cube()), 24, 1e-6);
    EXPECT_NEAR(outward(cube()), 8, 1e-6);
    for (const glm::vec3& n : square().normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
}

TEST(WorldShapes, KeepTheirFrontsWhereATransformMirrors) {
    Mesh mesh = cube();
    transform(mesh, glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 2, 1)));
    EXPECT_NEAR(outward(mesh), 16, 1e-5);
    turn_round(mesh);
    EXPECT_NEAR(outward(mesh), -16, 1e-5);
    face_normals(mesh);  // the normals were turned, too
    EXPECT_NEAR(outward(mesh), -16, 1e-5);
}

TEST(WorldShapes, AreSmoothedOverEqualPlaces) {
    Mesh mesh = cube();
    mesh.normals.clear();
    add_smooth_normals(mesh);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        EXPECT_NEAR(glm::length(mesh.normals[i] - mesh.positions[i] / std::sqrt(3.f)), 0, 1e-5);
}

TEST(Octahedral, MapsEqualSolidAnglesToEqualAreas) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    constexpr int side = 8, count = 200'000;
    std::vector<int> cells(side * side);
    for (int i = 0; i < count; ++i) {
        const glm::dvec2 place =
            octahedral_place(glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))));
        ++cells[std::size_t(std::min(int(place.y * side), side - 1) * side + std::min(int(place.x * side), side - 1))];
    }
    for (const int cell : cells)
        EXPECT_NEAR(cell, count / double(side * side), 6 * std::sqrt(count / double(side * side)));
    EXPECT_NEAR(glm::distance(octahedral_place({0, 0, 1}), glm::dvec2(0.5)), 0, 1e-12);
    EXPECT_NEAR(octahedral_place({1, 0, 0}).x, 1, 1e-12);
    EXPECT_NEAR(octahedral_place({0, 1, 0}).y, 1, 1e-12);
}

TEST(Octahedral, IsContinuousAcrossTheBorderOfTheSquare) {
    Texture image;
    image.width = image.height = 16, image.channels = 3, image.format = TexelFormat::float32;
    for (unsigned y = 0; y < 16; ++y)
        for (unsigned x = 0; x < 16; ++x)
            for (const double value : {x / 16.0, y / 16.0, 1.0}) image.floats.push_back(float(value));
    for (double angle = 0.1; angle < turn; angle += 0.3) {
        // Neighbours near -z, where the corners of the square meet.
        const glm::dvec3 a = glm::normalize(glm::dvec3(1e-9, 0.3 * std::cos(angle), -1)),
                         b = glm::normalize(glm::dvec3(-1e-9, 0.3 * std::cos(angle), -1));
        EXPECT_NEAR(octahedral_color(image, a).y, octahedral_color(image, b).y, 1e-4);
    }
}

}  // namespace
}  // namespace claray
