// Triangle meshes of surfaces that are given by functions.
#pragma once

#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>
#include <vector>

#include "paint.hpp"

inline constexpr float pi = glm::pi<float>();

struct Shape {
    std::vector<vec3> positions, normals;
    std::vector<vec2> uvs;
    std::vector<std::uint32_t> indices;
};

using Surface = std::function<vec3(float u, float v)>;

/// At the poles of a sphere every other triangle has no area.
inline void add_triangle(Shape& shape, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto apart = [&](std::uint32_t i, std::uint32_t j) {
        return glm::distance(shape.positions[i], shape.positions[j]) > 1e-6f;
    };
    if (apart(a, b) && apart(b, c) && apart(c, a)) shape.indices.insert(shape.indices.end(), {a, b, c});
}

/// A surface over the unit square in nu x nv quads; its front is where dP/du x dP/dv points.
inline void add_surface(Shape& shape, int nu, int nv, vec2 repeats, const Surface& point) {
    const auto first = std::uint32_t(shape.positions.size());
    for (int j = 0; j <= nv; ++j)
        for (int i = 0; i <= nu; ++i) {
            const float u = float(i) / float(nu), v = float(j) / float(nv);
            const float a = glm::clamp(u, 1e-3f, 1.f - 1e-3f),
                        b = glm::clamp(v, 1e-3f, 1.f - 1e-3f);  // poles have none
            const vec3 du = point(a + 1e-3f, b) - point(a - 1e-3f, b), dv = point(a, b + 1e-3f) - point(a, b - 1e-3f);
            shape.positions.push_back(point(u, v));
            shape.normals.push_back(glm::normalize(glm::cross(du, dv)));
            shape.uvs.push_back(vec2(u, v) * repeats);
        }
    const auto row = std::uint32_t(nu) + 1;
    for (std::uint32_t j = 0; j < std::uint32_t(nv); ++j)
        for (std::uint32_t i = 0; i < std::uint32_t(nu); ++i) {
            const std::uint32_t k = first + j * row + i;
            add_triangle(shape, k, k + 1, k + row + 1);
            add_triangle(shape, k, k + row + 1, k + row);
        }
}

inline Shape surface(int nu, int nv, vec2 repeats, const Surface& point) {
    Shape shape;
    add_surface(shape, nu, nv, repeats, point);
    return shape;
}

/// A parallelogram; its front is where a x b points, and v runs against b, so that images stand upright along b.
inline void add_quad(Shape& shape, vec3 corner, vec3 a, vec3 b, vec2 repeats) {
    const auto first = std::uint32_t(shape.positions.size());
    for (int i = 0; i < 4; ++i) {
        const vec2 p(i & 1, i >> 1);
        shape.positions.push_back(corner + p.x * a + p.y * b);
        shape.normals.push_back(glm::normalize(glm::cross(a, b)));
        shape.uvs.push_back(vec2(p.x, 1.f - p.y) * repeats);
    }
    for (const std::uint32_t k : {0, 1, 3, 0, 3, 2}) shape.indices.push_back(first + k);
}

inline Shape quad(vec3 corner, vec3 a, vec3 b, vec2 repeats) {
    Shape shape;
    add_quad(shape, corner, a, b, repeats);
    return shape;
}

inline void add_box(Shape& shape, vec3 lo, vec3 hi) {
    const vec3 d = hi - lo, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    add_quad(shape, lo + z, x, y, {d.x, d.y});
    add_quad(shape, lo + x, -x, y, {d.x, d.y});
    add_quad(shape, lo + x + z, -z, y, {d.z, d.y});
    add_quad(shape, lo, z, y, {d.z, d.y});
    add_quad(shape, lo + y + z, x, -z, {d.x, d.z});
    add_quad(shape, lo, x, z, {d.x, d.z});
}

inline Shape sphere(int n, vec2 repeats) {
    return surface(2 * n, n, repeats, [](float u, float v) {
        return vec3(std::sin(pi * v) * std::sin(2 * pi * u), std::cos(pi * (1.f - v)),
                    std::sin(pi * v) * std::cos(2 * pi * u));
    });
}

inline Shape torus(int n, float thickness, vec2 repeats) {
    return surface(2 * n, n, repeats, [=](float u, float v) {
        const float ring = 1.f + thickness * std::cos(2 * pi * v);
        return vec3(ring * std::sin(2 * pi * u), thickness * std::sin(2 * pi * v), ring * std::cos(2 * pi * u));
    });
}

/// What a profile of radii over height makes when it turns about the y axis.
inline Shape lathe(int around, int along, vec2 repeats, const std::function<vec2(float v)>& profile) {
    return surface(around, along, repeats, [&](float u, float v) {
        const vec2 p = profile(v);  // radius and height
        return vec3(p.x * std::sin(2 * pi * u), p.y, p.x * std::cos(2 * pi * u));
    });
}

/// Leaves as quads, turned at random, in a ball.
inline Shape crown(int leaves) {
    Shape shape;
    for (int i = 0; i < leaves; ++i) {
        const auto random = [&](int k) { return hash(i, k); };
        const float z = 2.f * random(0) - 1.f, angle = 2 * pi * random(1), radius = std::cbrt(0.2f + 0.8f * random(2));
        const float flat = std::sqrt(1.f - z * z);
        const vec3 center = radius * vec3(flat * std::cos(angle), 0.8f * z, flat * std::sin(angle));
        const float turn = 2 * pi * random(3), tilt = 0.5f * pi * (random(4) - 0.5f), size = 0.1f + 0.08f * random(5);
        const vec3 a(std::cos(turn), 0.f, std::sin(turn));
        const vec3 b(-std::sin(turn) * std::sin(tilt), std::cos(tilt), std::cos(turn) * std::sin(tilt));
        add_quad(shape, center - 0.5f * size * (a + b), size * a, size * b, {1, 1});
    }
    return shape;
}
