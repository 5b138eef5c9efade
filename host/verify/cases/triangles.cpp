// Triangles that are thin, tiny, huge, far away, close together or on top of each other.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/bvh/host_tree.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

struct NamedTree {
    std::string name;
    Bvh tree;
};

/// In both layouts, and as a first picture traces it: built by the host, with kernels of their own.
std::vector<NamedTree> trees_of(const Run& run, const Mesh& mesh) {
    std::vector<NamedTree> trees;
    for (const auto& [layout, name] : layouts) trees.push_back({name, build(run, mesh, {.layout = layout})});
    trees.push_back({"first picture", build_by_host(run.device(), std::span(&mesh, 1), {})});
    return trees;
}

}  // namespace

void judge(Run& run, const Mesh& mesh, const std::vector<Ray>& rays, const std::string& what, std::size_t least_hits) {
    const Oracle oracle(std::span(&mesh, 1));
    for (const auto& [name, bvh] : trees_of(run, mesh)) {
        const auto hits = closest_hit(bvh, rays);
        const Oracle::Verdict verdict = oracle.judge(rays, hits);
        const std::string title = (what.empty() ? "" : what + ", ") + name;
        if (verdict.wrong != 0) {
            const Ray& ray = rays[verdict.first_wrong];
            const Hit& hit = hits[verdict.first_wrong];
            run.failure(title + ", " + to_string(verdict.first_fault) + ": " + text_of(ray));
            run.picture(picture_along(ray, mesh, hit.primitive, title + ": " + to_string(verdict.first_fault)));
        }
        run.check("wrong hits, " + title, rays.size(), double(verdict.wrong), 0, "rays");
        if (verdict.hits < least_hits)
            run.check("hits that are missing, " + title, rays.size(), double(least_hits - verdict.hits), 0, "rays");
    }
}

namespace {

void translate(std::vector<Ray>& rays, const glm::vec3& by) {
    for (Ray& r : rays) r.ox += by.x, r.oy += by.y, r.oz += by.z;
}

/// Counts where two lists of hits name different triangles.
void compare_primitives(Run& run, const std::vector<Hit>& found, const std::vector<Hit>& expected,
                        const std::vector<Ray>& rays, Tally& tally, const std::string& what) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (tally.add(found[i].primitive == expected[i].primitive))
            run.failure(what + ": triangle " + std::to_string(int(found[i].primitive)) + " instead of " +
                        std::to_string(int(expected[i].primitive)) + ": " + text_of(rays[i]));
    }
}

void slivers(Run& run) {
    Random random(run.seed() + 25);
    Mesh mesh;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const glm::vec3 a = random.in_cube(1.f), along = random.in_cube(1.f);
        const float thickness = std::exp2(-float(random.below(30)));
        mesh.positions.insert(mesh.positions.end(), {a, a + along, a + 0.5f * along + thickness * random.in_cube(1.f)});
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    std::vector<Ray> rays = random_rays(run.count<std::size_t>(20'000, 1'000'000), 3.f, 1.f, run.seed() + 26);
    for (std::size_t i = 0; i < rays.size(); i += 2) {  // every second one at a sliver, which random rays miss
        const glm::uvec3 t = mesh.triangles[random.below(2000)];
        const float u = random.uniform(), v = random.uniform() * (1 - u);
        const glm::vec3 a = mesh.positions[t.x],
                        target = a + u * (mesh.positions[t.y] - a) + v * (mesh.positions[t.z] - a);
        const glm::vec3 origin(rays[i].ox, rays[i].oy, rays[i].oz);
        rays[i] = make_ray(origin, target - origin);
    }
    judge(run, mesh, rays, "");
    move_away(mesh, rays);
    judge(run, mesh, rays, "at 1e6");
}

void rays_in_planes(Run& run) {
    Mesh mesh = grid(16);
    Random random(run.seed() + 3);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < run.count<std::size_t>(20'000, 1'000'000); ++i) {
        const glm::vec2 from(random.uniform(-1, 2), random.uniform(-1, 2)), to(random.uniform(), random.uniform());
        rays.push_back(make_ray({from.x, from.y, 0.f}, {to.x - from.x, to.y - from.y, i % 2 ? 0.f : -0.f}));
    }
    for (const char* const at : {"", " at 1e6"}) {
        if (*at) move_away(mesh, rays);
        for (const auto& [layout, name] : layouts) {
            Tally hit;
            for (const Hit& h : closest_hit(build(run, mesh, {.layout = layout}), rays))
                hit.add(h.primitive == CLARAY_MISS);
            if (hit.wrong) run.failure("a hit in the plane: " + text_of(rays[hit.first]));
            run.check(std::string("rays in the plane that hit, ") + name + at, hit, "rays");
        }
    }
}

void scales(Run& run) {
    const Mesh mesh = soup(2003, 0.1f, run.seed() + 23);
    const auto rays = random_rays(run.count<std::size_t>(5003, 200'000), 3.f, 1.f, run.seed() + 24);
    for (const auto& [layout, name] : layouts) {
        const auto expected = closest_hit(build(run, mesh, {.layout = layout}), rays);
        Tally changed;
        for (const int power : {-20, -13, -7, 7, 13, 20}) {
            Mesh scaled = mesh;
            for (glm::vec3& p : scaled.positions) p *= std::exp2(float(power));
            std::vector<Ray> scaled_rays = rays;
            for (Ray& r : scaled_rays)
                r.ox = std::ldexp(r.ox, power), r.oy = std::ldexp(r.oy, power), r.oz = std::ldexp(r.oz, power);
            compare_primitives(run, closest_hit(build(run, scaled, {.layout = layout}), scaled_rays), expected,
                               scaled_rays, changed, std::string(name) + ", scaled by 2^" + std::to_string(power));
        }
        run.check(std::string("triangles that scaling changes, ") + name, changed, "rays");
        Tally lengths;
        for (const int power : {-40, -12, 12, 40}) {
            std::vector<Ray> longer = rays;
            for (Ray& r : longer)
                r.dx = std::ldexp(r.dx, power), r.dy = std::ldexp(r.dy, power), r.dz = std::ldexp(r.dz, power);
            const auto found = closest_hit(build(run, mesh, {.layout = layout}), longer);
            for (std::size_t i = 0; i < rays.size(); ++i)
                if (lengths.add(found[i].primitive == expected[i].primitive &&
                                (found[i].primitive == CLARAY_MISS || found[i].t == std::ldexp(expected[i].t, -power))))
                    run.failure(std::string(name) + ", a direction of another length: " + text_of(longer[i]));
        }
        run.check(std::string("hits that longer directions change, ") + name, lengths, "rays");
    }
}

void huge_coordinates(Run& run) {
    for (const glm::vec3 offset : {glm::vec3(1e6f), glm::vec3(148376, 1234, -223423), glm::vec3(3e9f, 1e7f, -5e8f)}) {
        const float size = std::max(1.f, offset.x * 1e-6f);
        const Mesh mesh = translated(soup(1000, 20.f * size, run.seed() + 30), offset);
        auto rays = random_rays(run.count<std::size_t>(10'000, 500'000), 100.f * size, size, run.seed() + 31);
        translate(rays, offset);
        judge(run, mesh, rays, "at " + std::to_string(std::int64_t(offset.x)));
    }
}

/// The scene is small and near the origin, the rays come from far away.
void far_origins(Run& run) {
    const Mesh mesh = soup(1000, 0.2f, run.seed() + 40);
    for (const float distance : {1e4f, 1e7f}) {
        std::vector<Ray> rays = random_rays(run.count<std::size_t>(10'000, 500'000), distance, 1.f, run.seed() + 41);
        Random random(run.seed() + 42);
        for (Ray& r : rays) {  // with directions that are not normalised, which aims better
            const glm::vec3 origin(r.ox, r.oy, r.oz);
            r = make_ray(origin, random.in_cube(1.f) - origin);
        }
        judge(run, mesh, rays, "from " + std::to_string(int(distance)));
    }
}

/// Sheets so close together that float32 distances confuse their order: each ray must hit the first one.
void close_surfaces(Run& run, float at, const std::string& where) {
    Mesh mesh;
    const float step = std::nextafter(at, INFINITY) - at, size = at;  // of a sheet, a quarter
    for (int sheet = 0; sheet < 12; ++sheet) {
        const float z = at + float((7 * sheet) % 12) * step, a = 4 * size;
        const auto base = std::uint32_t(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {{-a, -a, z}, {a, -a, z}, {a, a, z}, {-a, a, z}});
        mesh.triangles.emplace_back(base, base + 1, base + 2);
        mesh.triangles.emplace_back(base, base + 2, base + 3);
    }
    Random random(run.seed() + 50);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < run.count<std::size_t>(20'000, 1'000'000); ++i) {
        const glm::vec3 origin(random.uniform(-3, 3), random.uniform(-3, 3), i % 2 ? 0.f : 3.f);
        const glm::vec3 target(random.uniform(-3, 3), random.uniform(-3, 3), 1.f);
        rays.push_back(make_ray(size * origin, size * (target - origin)));
    }
    // Distances of neighbouring sheets may round to the same float: then the lower triangle, else the nearer one.
    const Oracle oracle(std::span(&mesh, 1));
    const auto expected = oracle.closest_hits(rays);
    for (const auto& [layout, name] : layouts) {
        const auto hits = closest_hit(build(run, mesh, {.layout = layout}), rays);
        Tally wrong;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (wrong.add(hits[i].primitive != CLARAY_MISS && hits[i].t == float(expected[i].t)))
                run.failure(name + where + ", not the first sheet: " + text_of(rays[i]));
        }
        run.check(std::string("rays that hit a sheet behind the first, ") + name + where, wrong, "rays");
    }
}

void close_surfaces(Run& run) {
    close_surfaces(run, 1.f, "");
    close_surfaces(run, 1e6f, " at 1e6");
}

/// Copies of triangles, in any order after the originals, are never reported.
void duplicates(Run& run) {
    Mesh base = soup(200, 0.3f, run.seed() + 27);
    auto rays = random_rays(run.count<std::size_t>(2000, 10'000), 3.f, 1.f, run.seed() + 28);
    const int shuffles = run.count(20, 1000);
    for (const char* const at : {"", " at 1e6"}) {
        if (*at) move_away(base, rays);
        for (const auto& [layout, name] : layouts) {
            const auto expected = closest_hit(build(run, base, {.layout = layout}), rays);
            Random random(run.seed() + 29);
            Tally wrong;
            for (int shuffle = 0; shuffle < shuffles; ++shuffle) {
                Mesh copies = base;
                for (int i = 0; i < 600; ++i) copies.triangles.push_back(base.triangles[random.below(200)]);
                for (std::size_t i = copies.triangles.size() - 1; i > 200; --i)
                    std::swap(copies.triangles[i], copies.triangles[200 + random.below(std::uint32_t(i - 199))]);
                compare_primitives(run, closest_hit(build(run, copies, {.layout = layout}), rays), expected, rays,
                                   wrong, name);
            }
            run.check(std::to_string(shuffles) + " shuffles: copies reported, " + name + at, wrong, "rays");
        }
    }
}

/// Rays include tmax and exclude tmin; invalid rays hit nothing.
void ray_ends(Run& run, const Mesh& mesh, const std::vector<Ray>& rays, const std::string& at) {
    for (const auto& [layout, name] : layouts) {
        const Bvh bvh = build(run, mesh, {.layout = layout});
        const auto hits = closest_hit(bvh, rays);
        std::vector<Ray> ends, begins, no_rays;
        std::vector<Hit> expected;
        const float inf = INFINITY, nan = NAN;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].primitive == CLARAY_MISS) continue;
            ends.push_back(rays[i]), ends.back().tmax = hits[i].t, expected.push_back(hits[i]);
            begins.push_back(rays[i]), begins.back().tmin = hits[i].t;
            Ray none = rays[i];
            float* const field[] = {&none.ox, &none.oz, &none.dy, &none.dx};
            *field[i % 4] = i % 3 == 0 ? nan : i % 3 == 1 ? inf : -inf;
            if (i % 7 == 0) none = rays[i], none.dx = none.dy = none.dz = i % 2 ? 0.f : -0.f;
            no_rays.push_back(none);
        }
        Tally at_end, behind, none;
        compare_primitives(run, closest_hit(bvh, ends), expected, ends, at_end, "tmax at the hit");
        const auto later = closest_hit(bvh, begins);
        for (std::size_t i = 0; i < later.size(); ++i)
            behind.add(later[i].primitive == CLARAY_MISS || later[i].t > begins[i].tmin);
        for (const Hit& hit : closest_hit(bvh, no_rays)) none.add(hit.primitive == CLARAY_MISS);
        if (behind.wrong) run.failure("a hit at tmin: " + text_of(begins[behind.first]));
        if (none.wrong) run.failure("a hit of an invalid ray: " + text_of(no_rays[none.first]));
        run.check("hits at tmax that are lost, " + (name + at), at_end, "rays");
        run.check("hits at or before tmin, " + (name + at), behind, "rays");
        run.check("hits of rays that are not finite or have no direction, " + (name + at), none, "rays");
    }
}

void ray_ends(Run& run) {
    Mesh mesh = soup(1000, 0.3f, run.seed() + 60);
    auto rays = random_rays(run.count<std::size_t>(10'000, 200'000), 3.f, 1.f, run.seed() + 61);
    ray_ends(run, mesh, rays, "");
    move_away(mesh, rays);
    ray_ends(run, mesh, rays, " at 1e6");
}

}  // namespace

Cases triangle_cases() {
    return {
        {{"slivers", "triangles", "Slivers and tiny triangles against exact arithmetic"}, slivers},
        {{"rays-in-planes", "triangles", "Rays in a triangle's plane hit nothing"}, rays_in_planes},
        {{"scales", "triangles", "Scaling by a power of two changes no hit"}, scales},
        {{"huge-coordinates", "triangles", "Scenes far from the origin against exact arithmetic"}, huge_coordinates},
        {{"far-origins", "triangles", "Rays that begin far from the scene against exact arithmetic"}, far_origins},
        {{"close-surfaces", "triangles", "The first of several sheets one rounding apart is hit"}, close_surfaces},
        {{"duplicates", "triangles", "The first in the input of several equal triangles is hit"}, duplicates},
        {{"ray-ends", "triangles", "Rays are open at tmin and closed at tmax; NaN, infinite and zero ones hit nothing"},
         ray_ends},
    };
}

}  // namespace claray::verify
