#include "host/verify/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace claray::verify {

Mesh soup(std::size_t count, float size, std::uint64_t seed) {
    Random random(seed);
    Mesh mesh;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 center = random.in_cube(1.f);
        for (int corner = 0; corner < 3; ++corner) mesh.positions.push_back(center + random.in_cube(size));
        const auto base = std::uint32_t(3 * i);
        mesh.triangles.emplace_back(base, base + 1, base + 2);
    }
    return mesh;
}

Mesh sphere(int levels, float radius, glm::vec3 center) {
    Mesh mesh;
    const float phi = 1.618034f;
    for (const float a : {-1.f, 1.f})
        for (const float b : {-phi, phi})
            for (const glm::vec3 p : {glm::vec3(0, a, b), glm::vec3(a, b, 0), glm::vec3(b, 0, a)})
                mesh.positions.push_back(glm::normalize(p));
    for (std::uint32_t i = 0; i < 12; ++i)  // faces are the triples of mutual neighbours, at distance 2 / |(1, phi)|
        for (std::uint32_t j = i + 1; j < 12; ++j)
            for (std::uint32_t k = j + 1; k < 12; ++k) {
                const auto near = [&](std::uint32_t a, std::uint32_t b) {
                    return glm::distance(mesh.positions[a], mesh.positions[b]) < 1.2f;
                };
                if (!near(i, j) || !near(j, k) || !near(i, k)) continue;
                const glm::vec3 a = mesh.positions[i], b = mesh.positions[j], c = mesh.positions[k];
                const bool outward = glm::dot(glm::cross(b - a, c - a), a) > 0;
                mesh.triangles.push_back(outward ? glm::uvec3(i, j, k) : glm::uvec3(i, k, j));
            }
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), std::uint32_t(mesh.positions.size()));
            if (fresh) mesh.positions.push_back(glm::normalize(mesh.positions[a] + mesh.positions[b]));
            return at->second;
        };
        std::vector<glm::uvec3> finer;
        for (const glm::uvec3 t : mesh.triangles) {
            const std::uint32_t xy = middle(t.x, t.y), yz = middle(t.y, t.z), zx = middle(t.z, t.x);
            finer.insert(finer.end(), {{t.x, xy, zx}, {xy, t.y, yz}, {zx, yz, t.z}, {xy, yz, zx}});
        }
        mesh.triangles = std::move(finer);
    }
    for (glm::vec3& p : mesh.positions) p = center + radius * p;
    return mesh;
}

Mesh scaled(Mesh mesh, float by) {
    for (glm::vec3& p : mesh.positions) p *= by;
    return mesh;
}

Mesh translated(Mesh mesh, const glm::vec3& by) {
    for (glm::vec3& p : mesh.positions) p += by;
    return mesh;
}

Mesh grid(unsigned n) {
    Mesh mesh;
    for (unsigned y = 0; y <= n; ++y)
        for (unsigned x = 0; x <= n; ++x) mesh.positions.emplace_back(float(x) / float(n), float(y) / float(n), 0.f);
    for (unsigned y = 0; y < n; ++y)
        for (unsigned x = 0; x < n; ++x) {
            const unsigned a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
            mesh.triangles.emplace_back(a, b, d);
            mesh.triangles.emplace_back(a, d, c);
        }
    return mesh;
}

Mesh joined(Mesh a, const Mesh& b) {
    for (const glm::uvec3& t : b.triangles) a.triangles.push_back(t + std::uint32_t(a.positions.size()));
    a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
    return a;
}

Mesh drawn_mesh(std::uint64_t seed) {
    Random random(seed);
    Mesh mesh = soup(1 + random.below(seed % 4 == 0 ? 1500 : 90), random.uniform(0.01f, 1.f), seed);
    const std::size_t count = mesh.positions.size();
    for (std::size_t i = 0; seed % 3 == 0 && i < count; ++i) mesh.positions[i] = glm::floor(mesh.positions[i] * 8.f);
    if (seed % 5 == 0)
        for (glm::vec3& p : mesh.positions) p.y = 0.5f;
    if (seed % 7 == 0) mesh.positions.back() *= 1000.f;
    return seed % 2 ? mesh : joined(mesh, translated(mesh, random.in_cube(0.3f)));
}

glm::mat4 drawn_transform(Random& random) {
    glm::mat4 m(1.f);
    for (int axis = 0; axis < 3; ++axis) m[axis] += glm::vec4(random.in_cube(0.3f), 0.f);
    m[3] = glm::vec4(random.in_cube(1.f), 1.f);
    return m;
}

Ray make_ray(glm::vec3 origin, glm::vec3 direction, float tmin, float tmax) {
    return {origin.x, origin.y, origin.z, tmin, direction.x, direction.y, direction.z, tmax};
}

std::vector<Ray> random_rays(std::size_t count, float radius, float half, std::uint64_t seed) {
    Random random(seed);
    std::vector<Ray> rays;
    rays.reserve(count);
    while (rays.size() < count) {
        const glm::vec3 outwards = random.in_cube(1.f);
        const float length = glm::length(outwards);
        if (length > 1.f || length < 0.1f) continue;
        const glm::vec3 origin = outwards * (radius / length);
        rays.push_back(make_ray(origin, glm::normalize(random.in_cube(half) - origin)));
    }
    return rays;
}

void move_away(Mesh& mesh, float scale) {
    for (glm::vec3& p : mesh.positions) p = scale * p + far_away;
}

void move_away(Mesh& mesh, std::vector<Ray>& rays, float scale) {
    move_away(mesh, scale);
    for (Ray& r : rays)
        r.ox = scale * r.ox + far_away.x, r.oy = scale * r.oy + far_away.y, r.oz = scale * r.oz + far_away.z;
}

}  // namespace claray::verify
