// Example 2: trace rays. Builds an acceleration structure over a torus, sends a ray through every character of the
// terminal, and draws what they hit.
#include <claray/query.hpp>
#include <cmath>
#include <cstdio>

namespace {

constexpr unsigned columns = 72, lines = 30;

// A torus around the y axis: 2 x 96 x 48 triangles.
claray::Mesh torus(float radius, float tube) {
    constexpr unsigned around = 96, across = 48;
    const float turn = 2 * std::acos(-1.f);
    claray::Mesh mesh;
    for (unsigned i = 0; i < around; ++i)
        for (unsigned j = 0; j < across; ++j) {
            const float a = turn * float(i) / around, b = turn * float(j) / across;
            const float r = radius + tube * std::cos(b);
            mesh.positions.emplace_back(r * std::cos(a), tube * std::sin(b), r * std::sin(a));
            const unsigned i1 = (i + 1) % around, j1 = (j + 1) % across;
            const unsigned p = i * across + j, q = i1 * across + j, r0 = i1 * across + j1, s = i * across + j1;
            mesh.triangles.emplace_back(p, q, r0);
            mesh.triangles.emplace_back(p, r0, s);
        }
    return mesh;
}

// Looks at the origin, from above.
std::vector<claray::Ray> camera_rays() {
    const glm::vec3 eye(0.f, 3.f, 4.f), forward = glm::normalize(-eye), right(1.f, 0.f, 0.f);
    const glm::vec3 up = glm::cross(right, forward);
    std::vector<claray::Ray> rays;
    for (unsigned y = 0; y < lines; ++y)
        for (unsigned x = 0; x < columns; ++x) {
            const float u = (float(x) + 0.5f) / columns * 2 - 1, v = 1 - (float(y) + 0.5f) / lines * 2;
            const glm::vec3 d = forward + 0.5f * u * right + 0.42f * v * up;
            rays.push_back({eye.x, eye.y, eye.z, 0.f, d.x, d.y, d.z, INFINITY});  // origin, tmin, direction, tmax
        }
    return rays;
}

// Light from the upper left, in characters from dark to bright.
char shade(const claray::Mesh& mesh, const claray::Hit& hit) {
    if (hit.primitive == CLARAY_MISS) return ' ';
    const glm::uvec3 t = mesh.triangles[hit.primitive];
    const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
    const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
    const float light = std::abs(glm::dot(normal, glm::normalize(glm::vec3(-1.f, 2.f, 1.f))));
    return ".:-=+*#%@"[int(light * 8.99f)];
}

}  // namespace

int main() try {
    const claray::Device device = claray::Device::open();
    const claray::Mesh mesh = torus(1.5f, 0.6f);
    const claray::Bvh bvh = claray::Bvh::build(device, {&mesh, 1});
    const claray::BvhStatistics statistics = bvh.statistics();
    std::printf("%u triangles, a tree of height %u, SAH cost %.1f\n", statistics.triangles, statistics.height,
                statistics.sah_cost);

    const std::vector<claray::Ray> rays = camera_rays();
    const std::vector<claray::Hit> hits = claray::closest_hit(bvh, rays);
    for (unsigned y = 0; y < lines; ++y) {
        for (unsigned x = 0; x < columns; ++x) std::putchar(shade(mesh, hits[y * columns + x]));
        std::putchar('\n');
    }

    // any_hit stops at whatever it meets first: all that a shadow needs.
    const std::vector<std::uint8_t> occluded = claray::any_hit(bvh, rays);
    std::size_t hit_count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool hit = hits[i].primitive != CLARAY_MISS;
        if (hit != (occluded[i] != 0)) throw claray::Error(claray::ErrorKind::device, "the two queries disagree");
        hit_count += hit;
    }
    std::printf("%zu of %zu rays hit the torus\n", hit_count, rays.size());
    return hit_count > 0 ? 0 : 1;
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
