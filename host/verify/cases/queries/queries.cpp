// Queries beyond the closest hit: all hits, filters, overlaps, nearest points, insides. Every triangle is tested on the
// host, exactly or in 80-bit arithmetic.
#include "claray/query/all_hits.hpp"

#include <algorithm>
#include <cmath>

#include "claray/query/overlaps.hpp"
#include "claray/query/points.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/exact.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/oracles/nearest_oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Large triangles among small ones, which `high` splits, so that lists name some of them twice at first.
Mesh ball_with_dust(std::size_t dust_count, std::uint64_t seed) {
    Mesh mesh = sphere(1);
    const Mesh dust = soup(dust_count, 0.1f, seed);
    const auto first = std::uint32_t(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), dust.positions.begin(), dust.positions.end());
    for (const glm::uvec3& t : dust.triangles) mesh.triangles.push_back(t + first);
    return mesh;
}

/// Trees of a mesh that lists must not depend on.
struct NamedTree {
    Bvh bvh;
    std::string name;
};

std::vector<NamedTree> trees_of(const Run& run, const Mesh& mesh) {
    std::vector<NamedTree> trees;
    for (const auto& [layout, name] : layouts)
        for (const Builder builder : {Builder::fast, Builder::high})
            trees.push_back({build(run, mesh, {.builder = builder, .layout = layout}),
                             std::string(name) + ", " + traits_of(builder).name});
    return trees;
}

/// A triangle that a ray meets, or may meet: a ray through a border may be either.
struct Crossing {
    float t;
    std::uint32_t primitive;
    bool certain;
};

/// All of a ray, by exact arithmetic, in the order of lists.
std::vector<Crossing> crossings_of(const Mesh& mesh, const Oracle& oracle, const Ray& ray) {
    std::vector<Crossing> all;
    for (std::uint32_t p = 0; p < mesh.triangles.size(); ++p) {
        const glm::uvec3 t = mesh.triangles[p];
        const Place place = place_of(ray, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
        if (place == Place::outside) continue;
        const auto distance = float(oracle.distance(ray, p));
        if (distance > ray.tmin && distance <= ray.tmax) all.push_back({distance, p, place == Place::inside});
    }
    std::sort(all.begin(), all.end(), [](const Crossing& a, const Crossing& b) {
        return a.t < b.t || (a.t == b.t && a.primitive < b.primitive);
    });
    return all;
}

template <class T>
std::span<const T> list_of(const HostLists<T>& lists, std::size_t i) {
    return std::span(lists.elements).subspan(lists.offsets[i], lists.offsets[i + 1] - lists.offsets[i]);
}

/// Whether the hits are the certain crossings in their order, with others that are possible among them.
bool are(const std::vector<Crossing>& all, std::span<const Hit> hits) {
    std::size_t k = 0;
    for (const Crossing& c : all) {
        const bool listed =
            k < hits.size() && hits[k].primitive == c.primitive && std::abs(hits[k].t - c.t) <= 1.2e-7f * std::abs(c.t);
        if (!listed && c.certain) return false;
        k += listed;
    }
    return k == hits.size();
}

std::vector<Ray> rays_with_ends(const Run& run, std::size_t count) {
    auto rays = random_rays(count, 3.f, 1.f, run.seed() + 91);
    Random random(run.seed() + 92);
    for (std::size_t i = 0; i < rays.size(); i += 3)
        rays[i].tmin = random.uniform(0.f, 3.f), rays[i].tmax = rays[i].tmin + random.uniform(0.f, 3.f);
    return rays;
}

std::vector<std::vector<Crossing>> crossings_of(const Mesh& mesh, const std::vector<Ray>& rays) {
    const Oracle oracle(std::span(&mesh, 1));
    std::vector<std::vector<Crossing>> all;
    for (const Ray& ray : rays) all.push_back(crossings_of(mesh, oracle, ray));
    return all;
}

void judge_nearest(Run& run, const NamedTree& tree, const std::vector<Ray>& rays, const HostLists<Hit>& lists,
                   std::uint32_t most, Tally& wrong) {
    const Buffer<Ray> on_device(run.device(), rays);
    Buffer<Hit> hits(run.device(), most * rays.size());
    Buffer<std::uint32_t> counts(run.device(), rays.size());
    nearest_hits(tree.bvh, on_device, most, hits, counts);
    const auto nearest = hits.read();
    const auto numbers = counts.read();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::span<const Hit> all = list_of(lists, i);
        bool right = numbers[i] == std::min<std::size_t>(most, all.size());
        for (std::size_t k = 0; right && k < numbers[i]; ++k)
            right = nearest[i * most + k].primitive == all[k].primitive && nearest[i * most + k].t == all[k].t;
        if (wrong.add(right)) run.failure(tree.name + ", not the nearest hits: " + text_of(rays[i]));
    }
}

void all_hits(Run& run) {
    const Mesh mesh = ball_with_dust(400, run.seed() + 90);
    const auto rays = rays_with_ends(run, run.count<std::size_t>(500, 20'000));
    const auto expected = crossings_of(mesh, rays);
    Tally lists, counts, nearest;
    for (const NamedTree& tree : trees_of(run, mesh)) {
        const HostLists<Hit> found = claray::all_hits(tree.bvh, rays);
        const auto numbers = count_hits(tree.bvh, rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (lists.add(are(expected[i], list_of(found, i))))
                run.failure(tree.name + ", a wrong list: " + text_of(rays[i]));
            if (counts.add(numbers[i] == list_of(found, i).size()))
                run.failure(tree.name + ", a wrong number: " + text_of(rays[i]));
        }
        for (const std::uint32_t most : {1u, 3u}) judge_nearest(run, tree, rays, found, most, nearest);
    }
    run.check("lists of hits that are wrong", lists, "rays");
    run.check("numbers of hits that are wrong", counts, "rays");
    run.check("nearest hits that are wrong", nearest, "rays");
}

/// A filter by the number of the triangle, which the host applies to the exact lists.
void filters(Run& run) {
    const Mesh mesh = ball_with_dust(400, run.seed() + 93);
    const auto rays = rays_with_ends(run, run.count<std::size_t>(500, 20'000));
    auto expected = crossings_of(mesh, rays);
    for (auto& all : expected) std::erase_if(all, [](const Crossing& c) { return c.primitive % 3 != 1; });
    QueryOptions options;
    options.filter = {"thirds",
                      "static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const "
                      "Hit* hit) { return hit->primitive % (uint)data[0] == 1; }",
                      Buffer<float>(run.device(), std::vector<float>{3})};
    Tally lists, closest, any;
    for (const NamedTree& tree : trees_of(run, mesh)) {
        const HostLists<Hit> found = claray::all_hits(tree.bvh, rays, options);
        const auto hits = closest_hit(tree.bvh, rays, options);
        const auto occluded = any_hit(tree.bvh, rays, options);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const std::span<const Hit> list = list_of(found, i);
            lists.add(are(expected[i], list));
            const bool first = list.empty() ? hits[i].primitive == CLARAY_MISS && hits[i].t == rays[i].tmax
                                            : hits[i].primitive == list[0].primitive && hits[i].t == list[0].t;
            if (closest.add(first)) run.failure(tree.name + ", not the first that is accepted: " + text_of(rays[i]));
            any.add((occluded[i] != 0) == !list.empty());
        }
    }
    run.check("lists of accepted hits that are wrong", lists, "rays");
    run.check("closest accepted hits that are wrong", closest, "rays");
    run.check("any accepted hits that are wrong", any, "rays");
}

std::vector<std::uint32_t> where(std::size_t count, const std::function<bool(std::size_t)>& holds) {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < count; ++i)
        if (holds(i)) found.push_back(i);
    return found;
}

void shape_overlaps(Run& run) {
    const Mesh mesh = ball_with_dust(800, run.seed() + 94);
    const NearestOracle oracle(mesh);
    Random random(run.seed() + 95);
    std::vector<Bounds> boxes(run.count(200u, 5000u));
    std::vector<Sphere> spheres(boxes.size());
    for (Bounds& box : boxes) {
        box.lo = random.in_cube(1.2f);
        box.hi = box.lo + random.uniform() * glm::abs(random.in_cube(1));
    }
    for (Sphere& ball : spheres) ball = {random.in_cube(1.2f), 0.5f * random.uniform()};
    std::vector<std::vector<std::uint32_t>> in_boxes, in_spheres;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        in_boxes.push_back(where(mesh.triangles.size(), [&](auto p) { return overlaps(mesh, p, boxes[i]); }));
        in_spheres.push_back(where(mesh.triangles.size(),
                                   [&](auto p) { return oracle.distance(spheres[i].center, p) <= spheres[i].radius; }));
    }
    Tally wrong_boxes, wrong_spheres, counts;
    for (const NamedTree& tree : trees_of(run, mesh)) {
        const auto of_boxes = box_overlaps(tree.bvh, boxes), of_spheres = sphere_overlaps(tree.bvh, spheres);
        Buffer<std::uint32_t> numbers(run.device(), boxes.size());
        count_box_overlaps(tree.bvh, Buffer<float>(run.device(), std::span(&boxes[0].lo.x, 6 * boxes.size())), numbers);
        const auto found = numbers.read();
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            wrong_boxes.add(std::ranges::equal(list_of(of_boxes, i), in_boxes[i]));
            wrong_spheres.add(std::ranges::equal(list_of(of_spheres, i), in_spheres[i]));
            counts.add(found[i] == in_boxes[i].size());
        }
        if (wrong_boxes.wrong + wrong_spheres.wrong + counts.wrong) run.failure(tree.name + ": wrong overlaps");
    }
    run.check("boxes with wrong overlaps", wrong_boxes, "boxes");
    run.check("spheres with wrong overlaps", wrong_spheres, "spheres");
    run.check("boxes with a wrong number of overlaps", counts, "boxes");
}

/// So many points that they are sorted first.
void nearest_points(Run& run) {
    Mesh mesh = soup(run.count<std::size_t>(300, 2000), 0.2f, run.seed() + 96);
    Random random(run.seed() + 97);
    std::vector<glm::vec3> points;
    for (std::size_t i = 0; i < run.count<std::size_t>(4500, 50'000); ++i) points.push_back(random.in_cube(2.f));
    for (const char* const at : {"", " at 1e6"}) {
        if (*at) {
            move_away(mesh);
            for (glm::vec3& p : points) p = 1024.f * p + far_away;
            points.resize(500);
        }
        const NearestOracle oracle(mesh);
        for (const auto& [layout, name] : layouts) {
            const Bvh bvh = build(run, mesh, {.layout = layout});
            Tally wrong;
            for (const float reach : {INFINITY, *at ? 200.f : 0.2f}) {
                PointOptions options;
                options.reach = reach;
                const auto found = nearest_point(bvh, points, options);
                for (std::size_t i = 0; i < points.size(); i += 3) {
                    const char* const fault = oracle.judge(points[i], found[i], reach);
                    if (wrong.add(*fault == 0)) run.failure(name + (at + (": " + std::string(fault))));
                }
            }
            run.check("wrong nearest points, " + (name + std::string(at)), wrong, "points");
        }
    }
}

/// A ray along +z from a point meets an odd number of triangles where the point is inside, by exact arithmetic.
bool is_inside(const Mesh& mesh, const Oracle& oracle, const glm::vec3& point) {
    return crossings_of(mesh, oracle, make_ray(point, {0, 0, 1})).size() % 2 != 0;
}

/// A triangle above the origin that is not much higher: a float of its height is a multiple of 2^-53 there.
void add_leaf_above_origin(Mesh& mesh, Random& random) {
    for (;;) {
        glm::vec3 a = random.in_cube(1.f), b = random.in_cube(1.f), c = random.in_cube(1.f);
        const glm::dvec3 share(glm::dvec2(b).x * c.y - double(b.y) * c.x, double(c.x) * a.y - double(c.y) * a.x,
                               double(a.x) * b.y - double(a.y) * b.x);
        const double all = share.x + share.y + share.z;
        if (std::min({share.x / all, share.y / all, share.z / all}) < 0.1) continue;
        c.z = float(-(share.x * a.z + share.y * b.z) / share.z);
        const double height = (share.x * a.z + share.y * b.z + share.z * c.z) / all;
        if (std::abs(height) > 0x1p-30 || std::abs(c.z) > 1) continue;
        const auto first = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {a, b, c});
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        return;
    }
}

/// Points beside planes, so near that products of float64 do not tell the side: exact sums do.
void sides_in_doubt(Run& run) {
    Random random(run.seed() + 97);
    Mesh mesh;
    for (int i = 0; i < 200; ++i) add_leaf_above_origin(mesh, random);
    const auto is_above = [&](const glm::vec3& point, const glm::uvec3& t) {
        const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
        const Ray up = make_ray(point, {0, 0, 1});
        return place_of(up, a, b, c) == Place::inside && side_of_plane(point, a, b, c) == side_of(up, a, b);
    };
    std::vector<glm::vec3> points;
    for (const glm::uvec3& t : mesh.triangles)
        for (std::size_t k = 0; k < run.count<std::size_t>(4, 100); ++k) {
            // Differences from the triangles' floats fit float64.
            const auto place = [](std::int32_t steps) { return float(steps) * 0x1p-53f; };
            const auto any = [&] { return std::int32_t(random.below(1u << 25)) - (1 << 24); };
            const float x = place(any()), y = place(any());
            std::int32_t low = -(1 << 24), high = 1 << 24;  // the plane is between them
            while (high - low > 1) {
                const std::int32_t middle = low + (high - low) / 2;
                (is_above({x, y, place(middle)}, t) ? low : high) = middle;
            }
            for (const std::int32_t z : {low, high}) points.emplace_back(x, y, place(z));
        }
    Tally wrong;
    for (const auto& [layout, name] : layouts) {
        const auto found = inside(build(run, mesh, {.layout = layout}), points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::size_t above = 0;
            for (const glm::uvec3& t : mesh.triangles) above += is_above(points[i], t);
            if (wrong.add((found[i] != 0) == (above % 2 != 0))) run.failure(std::string(name) + " beside a plane");
        }
    }
    run.check("wrong sides of planes as near as floats are", wrong, "points");
}

void insides(Run& run) {
    sides_in_doubt(run);
    Random random(run.seed() + 98);
    std::vector<glm::vec3> points;
    for (std::size_t i = 0; i < run.count<std::size_t>(600, 20'000); ++i) points.push_back(random.in_cube(1.2f));
    const Mesh mesh = ball_with_dust(300, run.seed() + 99);  // not closed: the answer is the parity
    const Oracle oracle(std::span(&mesh, 1));
    const NearestOracle nearest(mesh);
    Tally wrong, wrong_signs;
    for (const NamedTree& tree : trees_of(run, mesh)) {
        const auto found = inside(tree.bvh, points);
        const auto distances = signed_distance(tree.bvh, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const bool expected = is_inside(mesh, oracle, points[i]);
            if (wrong.add((found[i] != 0) == expected)) run.failure(tree.name + ", point " + std::to_string(i));
            long double least = INFINITY;
            for (std::size_t p = 0; p < mesh.triangles.size(); ++p)
                least = std::min(least, nearest.distance(points[i], p));
            wrong_signs.add(std::abs(distances[i] - (expected ? -least : least)) <= 1e-7L * least);
        }
    }
    run.check("points on the wrong side", wrong, "points");
    run.check("wrong signed distances", wrong_signs, "points");
    // A sphere without some of its triangles: most rays tell its inside still.
    Mesh open = sphere(3);
    for (std::size_t i = 0; i < 25; ++i) open.triangles.erase(open.triangles.begin() + std::ptrdiff_t(31 * i));
    Tally votes, closed;
    for (const auto& [layout, name] : layouts) {
        const Bvh bvh = build(run, open, {.layout = layout});
        PointOptions options;
        options.vote = true;
        const auto found = inside(bvh, points, options);
        closed.add(!is_closed(bvh) && is_closed(build(run, sphere(3), {.layout = layout})));
        for (std::size_t i = 0; i < points.size(); ++i)
            if (const float r = glm::length(points[i]); r < 0.7f || r > 1.01f) votes.add((found[i] != 0) == (r < 1));
    }
    run.check("points on the wrong side by votes", votes, "points");
    run.check("meshes wrongly called closed or open", closed, "meshes");
}

}  // namespace

Cases query_cases() {
    return {
        {{"all-hits", "queries", "Lists, numbers and the nearest of all hits against exact arithmetic"}, all_hits},
        {{"filters", "queries", "Hits that a filter accepts against exact arithmetic"}, filters},
        {{"overlaps", "queries", "Triangles that overlap boxes and spheres against 80-bit arithmetic"}, shape_overlaps},
        {{"nearest-points", "queries", "Nearest points of surfaces against 80-bit arithmetic"}, nearest_points},
        {{"insides", "queries", "Points inside by exact parities, and their signed distances"}, insides},
    };
}

}  // namespace claray::verify
