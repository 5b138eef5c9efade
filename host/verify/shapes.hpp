// Small meshes and rays to verify and test with, the same on every machine.
#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/types.h"

namespace claray::verify {

/// Uniform floats of 24 bits, made without std::uniform_real_distribution, which differs between libraries.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    float uniform() { return float(engine_() >> 40) * 0x1p-24f; }
    float uniform(float lo, float hi) { return lo + (hi - lo) * uniform(); }
    glm::vec3 in_cube(float half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    std::uint32_t below(std::uint32_t n) { return std::uint32_t(engine_() % n); }

private:
    std::mt19937_64 engine_;
};

/// `count` triangles of about `size` in the cube of half side 1.
Mesh soup(std::size_t count, float size, std::uint64_t seed);
/// A closed sphere of 20 * 4^levels triangles, shared vertices, outward faces counterclockwise.
Mesh sphere(int levels, float radius = 1.f, glm::vec3 center = glm::vec3(0.f));
/// An n x n grid of 2 n^2 triangles in the unit square z = 0.
Mesh grid(unsigned n);
/// All that is a length becomes `by` times as long.
Mesh scaled(Mesh mesh, float by);
/// The mesh elsewhere.
Mesh translated(Mesh mesh, const glm::vec3& by);

/// The triangles of both.
Mesh joined(Mesh a, const Mesh& b);
/// Of any size: few triangles, many equal ones, flat ones, some far away.
Mesh drawn_mesh(std::uint64_t seed);
/// Stretched, sheared and placed in the cube of half side 1. Only + - * made it.
glm::mat4 drawn_transform(Random& random);

Ray make_ray(glm::vec3 origin, glm::vec3 direction, float tmin = 0.f,
             float tmax = std::numeric_limits<float>::infinity());
/// Rays from a sphere of `radius` towards random points of the cube of half side `half`.
std::vector<Ray> random_rays(std::size_t count, float radius, float half, std::uint64_t seed);

/// The place to which scenes are moved to test huge coordinates. Floats there are multiples of 1/16.
inline const glm::vec3 far_away(1e6f, -1e6f, 1e6f);

/// Scales by `scale` and moves to `far_away`.
void move_away(Mesh& mesh, float scale = 1024.f);
void move_away(Mesh& mesh, std::vector<Ray>& rays, float scale = 1024.f);

}  // namespace claray::verify
