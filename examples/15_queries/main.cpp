// Example 15: queries other than the first hit, about a torus: distances of places, all hits along a ray, triangles in
// boxes, hits that a text leaves out, and shapes whose text the program gives.
#include <claray/primitives/primitives.hpp>
#include <claray/query/all_hits.hpp>
#include <claray/query/overlaps.hpp>
#include <claray/query/points.hpp>
#include <cmath>
#include <cstdio>

namespace {

constexpr unsigned columns = 72, lines = 24;
constexpr float radius = 1.5f, tube = 0.6f;

// A torus around the y axis.
claray::Mesh torus() {
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
            mesh.triangles.emplace_back(p, r0, q);  // counter-clockwise from outside
            mesh.triangles.emplace_back(p, s, r0);
        }
    return mesh;
}

// Places of the plane z = 0, one for each character.
std::vector<glm::vec3> places() {
    std::vector<glm::vec3> points;
    for (unsigned y = 0; y < lines; ++y)
        for (unsigned x = 0; x < columns; ++x)
            points.emplace_back((float(x) + 0.5f) / columns * 6 - 3, 2 - (float(y) + 0.5f) / lines * 4, 0.f);
    return points;
}

void draw(const char* title, const std::vector<char>& characters) {
    std::printf("\n%s\n", title);
    for (unsigned y = 0; y < lines; ++y) std::printf("%.*s\n", int(columns), characters.data() + y * columns);
}

// Digits: tenths of a unit from the surface; letters from 'a' on: the same inside.
void show_distances(const claray::Bvh& bvh) {
    const std::vector<float> distances = claray::signed_distance(bvh, places());
    std::vector<char> characters;
    for (const float d : distances) {
        const int tenths = int(std::min(9.f, std::abs(d) * 10));
        characters.push_back(char((d < 0 ? 'a' : '0') + tenths));
    }
    draw("distances from the surface: digits outside, letters inside", characters);
    const glm::vec3 hole[] = {{0.f, 0.f, 0.f}};
    const claray::NearestPoint nearest = claray::nearest_point(bvh, hole)[0];
    std::printf("from the middle of the hole to (%.2f, %.2f, %.2f): %.2f, outside: %s\n", double(nearest.x),
                double(nearest.y), double(nearest.z), double(nearest.distance),
                claray::inside(bvh, hole)[0] == 0 ? "yes" : "no");
}

// How much material a ray passes: between its first and second hit, its third and fourth, and so on.
void show_all_hits(const claray::Bvh& bvh) {
    const claray::Ray ray{-5.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, INFINITY};  // origin, tmin, direction, tmax
    const claray::HostLists<claray::Hit> hits = claray::all_hits(bvh, std::span(&ray, 1));
    float inside = 0;
    for (std::size_t i = 0; i + 1 < hits.elements.size(); i += 2) inside += hits.elements[i + 1].t - hits.elements[i].t;
    std::printf("\na ray through the ring: %zu hits, %.2f units inside\n", hits.elements.size(), double(inside));

    claray::QueryOptions options;
    options.filter = {"only exits", R"(
static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit) {
    const float3 at = origin + hit->t * direction;
    const float3 axis = data[0] * normalize((float3)(at.x, 0.0f, at.z));  // the nearest place of the tube's axis
    return dot(at - axis, direction) > 0.0f;
})",
                      claray::Buffer<float>(bvh.device(), std::vector<float>{radius})};
    const std::vector<claray::Hit> exit = claray::closest_hit(bvh, std::span(&ray, 1), options);
    std::printf("the first place where it leaves the ring: t = %.2f\n", double(exit[0].t));
}

// Voxels of a grid that the surface passes, and those that are wholly inside.
void show_overlaps(const claray::Bvh& bvh) {
    constexpr int side = 24;
    constexpr float size = 4.5f / side;
    std::vector<claray::Bounds> voxels;
    std::vector<glm::vec3> centers;
    for (int i = 0; i < side * side * side; ++i) {
        const glm::vec3 lo = glm::vec3(i % side, i / side % side, i / side / side) * size - 2.25f;
        voxels.push_back({lo, lo + size});
        centers.push_back(lo + 0.5f * size);
    }
    const claray::HostLists<std::uint32_t> touched = claray::box_overlaps(bvh, voxels);
    const std::vector<std::uint8_t> inside = claray::inside(bvh, centers);
    int surface = 0, solid = 0;
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        const bool empty = touched.offsets[i] == touched.offsets[i + 1];
        surface += !empty, solid += empty && inside[i] != 0;
    }
    const float pi = std::acos(-1.f), volume = float(solid) * size * size * size;
    std::printf("\nof %zu voxels %d touch the surface and %d are inside: at least %.1f of its volume of %.1f\n",
                voxels.size(), surface, solid, double(volume), double(2 * pi * pi * radius * tube * tube));
}

// Paraboloids that open downwards: place of the top, and the radius one unit below it.
claray::PrimitiveKind paraboloids() {
    return {"paraboloids", R"(
static inline PrimitiveBox bounds_of(global const float* data, uint primitive) {
    const float4 top = vload4(primitive, data);
    const PrimitiveBox box = {top.xyz - (float3)(top.w, 1.0f, top.w), top.xyz + (float3)(top.w, 0.0f, top.w)};
    return box;
}
static inline bool take_above(real t, float3 origin, float3 direction, float4 top, float tmin, Hit* hit) {
    const real height = origin.y + t * direction.y - top.y;
    return height >= -1 && height <= 0 && take_hit(t, tmin, hit);
}
static inline bool intersect(global const float* data, uint primitive, float3 origin, float3 direction, float tmin, Hit* hit) {
    const float4 top = vload4(primitive, data);  // x^2 + z^2 = -w^2 y, from the top
    const Vec o = vec_difference(origin, top.xyz), d = to_vec(direction);
    const real w2 = (real)top.w * top.w, a = d.x * d.x + d.z * d.z, c = o.x * o.x + o.z * o.z + w2 * o.y;
    const real b = o.x * d.x + o.z * d.z + w2 * d.y / 2;
    if (a == 0) return take_above(-c / (2 * b), origin, direction, top, tmin, hit);
    if (b * b < a * c) return false;
    real t0, t1;
    solve_quadratic(a, b, c, b * b - a * c, &t0, &t1);
    return take_above(t0, origin, direction, top, tmin, hit) || take_above(t1, origin, direction, top, tmin, hit);
})",
            4};
}

// Seen along -z.
void show_own_shapes(const claray::Device& device) {
    const std::vector<float> data = {-1.5f, 1.f, 0.f, 1.f, 0.5f, 0.2f, -1.f, 1.5f, 1.5f, 1.5f, 1.f, 0.5f};
    const claray::Primitives primitives = claray::Primitives::build(device, paraboloids(), data);
    std::vector<claray::Ray> rays;
    for (const glm::vec3& at : places()) rays.push_back({at.x, at.y, 9.f, 0.f, 0.f, 0.f, -1.f, INFINITY});
    std::vector<char> characters;
    for (const claray::Hit& hit : claray::closest_hit(primitives, rays))
        characters.push_back(hit.primitive == CLARAY_MISS ? '.' : char('A' + hit.primitive));
    draw("three paraboloids of the program's own text", characters);
}

}  // namespace

int main() try {
    const claray::Device device = claray::Device::open();
    const claray::Mesh mesh = torus();
    const claray::Bvh bvh = claray::Bvh::build(device, {&mesh, 1});
    show_distances(bvh);
    show_all_hits(bvh);
    show_overlaps(bvh);
    show_own_shapes(device);
} catch (const claray::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
