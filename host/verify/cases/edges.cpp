// Rays through shared edges and vertices: exactly one triangle must claim each ray.
#include <algorithm>
#include <cmath>

#include "claray/program.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/verify/cases/cases.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Counts the triangles that claim each ray.
std::vector<std::uint32_t> claims_of(const Bvh& bvh, const Buffer<Ray>& rays) {
    const auto count = std::uint32_t(rays.size());
    const Buffer<std::uint32_t> claims(bvh.device(), count);
    load_kernel(bvh.device(), "verify/count_claims.cl", "count_claims")
        .run({count, 64}, state_of(bvh).header, state_of(bvh).nodes, state_of(bvh).leaves, rays, count, claims);
    return claims.read();
}

void report(Run& run, const Tally& tally, const std::string& what, const std::vector<Ray>& rays, const Mesh& mesh,
            std::uint64_t first) {
    if (tally.wrong == 0) return;
    const Ray& ray = rays[tally.first - first];
    run.failure(what + ": " + text_of(ray));
    run.picture(picture_along(ray, mesh, CLARAY_MISS, what));
}

/// From the inside of a closed mesh every ray must hit, and every ray must be claimed by one triangle.
void aim_at(Run& run, bool along_edges) {
    const std::uint64_t total = run.count<std::uint64_t>(150'000, 10'000'000), batch = 500'000;
    const float radius = 100.f;
    for (const glm::vec3 offset : {glm::vec3(0), glm::vec3(148376, 1234, -223423), glm::vec3(1e6f)}) {
        const Mesh mesh = translated(sphere(3, radius), offset);
        const std::string at = " at " + std::to_string(int(offset.x));
        const Bvh binary = build(run, mesh, {.layout = Layout::binary}),
                  wide = build(run, mesh, {.layout = Layout::wide});
        Kernel aim = load_kernel(run.device(), "verify/edge_rays.cl", "edge_rays");
        Tally missed[2], not_any[2], twice, aimed;
        for (std::uint64_t begin = 0; begin < total; begin += batch) {
            const auto count = std::uint32_t(std::min(batch, total - begin));
            const Buffer<Ray> rays(run.device(), count);
            aim.run({count, 64}, count, std::uint32_t(begin), std::uint32_t(run.seed()), std::uint32_t(along_edges),
                    offset.x, offset.y, offset.z, 0.2f * radius, std::uint32_t(mesh.triangles.size()),
                    binary.triangles().positions, binary.triangles().indices, rays);
            std::vector<Ray> host;
            for (int l = 0; l < 2; ++l) {
                const Bvh& bvh = l ? wide : binary;
                Buffer<Hit> hits(run.device(), count);
                Buffer<std::uint8_t> occluded(run.device(), count);
                closest_hit(bvh, rays, hits);
                any_hit(bvh, rays, occluded);
                const std::uint64_t before[2] = {missed[l].wrong, not_any[l].wrong};
                for (const Hit& hit : hits.read()) {
                    missed[l].add(hit.primitive != CLARAY_MISS);
                    if (offset == glm::vec3(0)) aimed.add(std::min({hit.u, hit.v, 1 - hit.u - hit.v}) < 1e-4f);
                }
                for (const std::uint8_t any : occluded.read()) not_any[l].add(any == 1);
                if (host.empty() && missed[l].wrong + not_any[l].wrong > before[0] + before[1]) host = rays.read();
                const std::string layout = std::string(", ") + layouts[l].name + at;
                if (before[0] == 0) report(run, missed[l], "a closest hit leaks" + layout, host, mesh, begin);
                if (before[1] == 0) report(run, not_any[l], "an any hit leaks" + layout, host, mesh, begin);
            }
            const bool first = twice.wrong == 0;
            for (const std::uint32_t claims : claims_of(binary, rays)) twice.add(claims == 1);
            if (first && twice.wrong != 0) report(run, twice, "not one claim" + at, rays.read(), mesh, begin);
        }
        for (int l = 0; l < 2; ++l) {
            run.check(std::string("closest hits that leak, ") + layouts[l].name + at, missed[l], "rays");
            run.check(std::string("any hits that leak, ") + layouts[l].name + at, not_any[l], "rays");
        }
        run.check("rays not claimed once" + at, twice, "rays");
        if (offset == glm::vec3(0)) run.check("rays that hit no edge" + at, aimed, "rays");
    }
}

/// A fan of triangles around a point, with varying radii, on a saddle so flat that it does not hide itself.
Mesh random_fan(std::uint32_t triangles, Random& random) {
    Mesh mesh;
    const glm::vec3 middle = random.in_cube(0.01f);
    mesh.positions.push_back(middle);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const double angle = 2 * 3.14159265358979 * i / triangles;
        const float radius = random.uniform(1.f, 1.2f);
        const float slope = 0.05f * float(std::cos(2 * angle)) + 0.1f / float(triangles) * random.uniform(-1.f, 1.f);
        mesh.positions.push_back(middle + radius * glm::vec3(float(std::cos(angle)), float(std::sin(angle)), slope));
        mesh.triangles.emplace_back(0, 1 + i, 1 + (i + 1) % triangles);
    }
    return mesh;
}

/// Rays from above through the middle of the fan, half of them at its spokes. Some of those aim at its centre, where
/// all triangles are decided exactly: fewer for larger fans.
std::vector<Ray> fan_rays(const Mesh& mesh, std::size_t count, Random& random) {
    std::vector<Ray> rays;
    const auto spokes = std::uint32_t(mesh.positions.size() - 1), every = std::max(16u, spokes / 64 * 2);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 origin(random.uniform(-0.4f, 0.4f), random.uniform(-0.4f, 0.4f), 3.f);
        glm::vec3 target(random.uniform(-0.3f, 0.3f), random.uniform(-0.3f, 0.3f), 0.f);
        if (i % 2 == 0) {
            const float along = i % every == 0 ? 0.f : random.uniform(0.f, 0.4f);
            target = mesh.positions[0] + along * (mesh.positions[1 + random.below(spokes)] - mesh.positions[0]);
        }
        rays.push_back(make_ray(origin, target - origin));
    }
    return rays;
}

/// A sphere whose vertices were moved in and out, by less than an edge: every ray from near its centre leaves it once.
Mesh random_closed_mesh(int levels, Random& random) {
    Mesh mesh = sphere(levels);
    const float most = std::ldexp(0.2f, -levels);
    for (glm::vec3& p : mesh.positions) p *= 1 + random.uniform(-most, most);
    return mesh;
}

struct Outcome {
    Tally missed, twice;
    void check(Run& run) const {
        run.check("rays that leak", missed, "rays");
        run.check("rays not claimed once", twice, "rays");
    }
};

/// Traces by both layouts, and counts claims.
void trace_closed(Run& run, const Mesh& mesh, const std::vector<Ray>& rays, Outcome& outcome, const std::string& what) {
    const Buffer<Ray> device_rays(run.device(), rays);
    const std::uint64_t first[2] = {outcome.missed.tried, outcome.twice.tried};
    const bool fresh[2] = {outcome.missed.wrong == 0, outcome.twice.wrong == 0};
    for (const auto& [layout, name] : layouts) {
        const Bvh bvh = build(run, mesh, {.layout = layout});
        Buffer<Hit> hits(run.device(), rays.size());
        closest_hit(bvh, device_rays, hits);
        for (const Hit& hit : hits.read()) outcome.missed.add(hit.primitive != CLARAY_MISS);
        if (layout != Layout::binary) continue;
        for (const std::uint32_t claims : claims_of(bvh, device_rays)) outcome.twice.add(claims == 1);
    }
    if (fresh[0] && outcome.missed.wrong != 0) {
        Tally tally = outcome.missed;
        tally.first = first[0] + (tally.first - first[0]) % rays.size();
        report(run, tally, "leaks through " + what, rays, mesh, first[0]);
    }
    if (fresh[1]) report(run, outcome.twice, "not claimed once by " + what, rays, mesh, first[1]);
}

void trace_here_and_away(Run& run, Mesh& mesh, std::vector<Ray>& rays, Outcome& outcome, const std::string& what) {
    trace_closed(run, mesh, rays, outcome, what);
    move_away(mesh, rays);
    trace_closed(run, mesh, rays, outcome, what + " at 1e6");
}

void edges(Run& run) { aim_at(run, true); }
void vertices(Run& run) { aim_at(run, false); }

void fans(Run& run) {
    Outcome outcome;
    const int seeds = run.count(2, 10);
    for (int seed = 0; seed < seeds; ++seed)
        for (const std::uint32_t triangles : {4u, 7u, 64u, 1000u, 8192u, 65'536u}) {
            if (!run.full() && triangles > 10'000) continue;
            Random random(1000 * run.seed() + std::uint64_t(seed));
            Mesh mesh = random_fan(triangles, random);
            auto rays = fan_rays(mesh, run.count<std::size_t>(4096, 65'536), random);
            const std::string what = "a fan of " + std::to_string(triangles);
            trace_here_and_away(run, mesh, rays, outcome, what);
        }
    outcome.check(run);
}

void closed_meshes(Run& run) {
    Outcome outcome;
    const int seeds = run.count(2, 10);
    for (int seed = 0; seed < seeds; ++seed)
        for (const int levels : {0, 1, 2, 4, 6}) {
            if (!run.full() && levels > 4) continue;
            Random random(2000 * run.seed() + std::uint64_t(seed));
            Mesh mesh = random_closed_mesh(levels, random);
            std::vector<Ray> rays;
            for (std::size_t i = 0; i < run.count<std::size_t>(8192, 65'536); ++i) {
                const glm::uvec3 t = mesh.triangles[random.below(std::uint32_t(mesh.triangles.size()))];
                const float share = i % 2 ? random.uniform() : 0.f;
                const glm::vec3 origin = random.in_cube(0.02f);
                rays.push_back(make_ray(
                    origin, mesh.positions[t.x] + share * (mesh.positions[t.y] - mesh.positions[t.x]) - origin));
            }
            const std::string what = "a closed mesh of " + std::to_string(mesh.triangles.size());
            trace_here_and_away(run, mesh, rays, outcome, what);
        }
    outcome.check(run);
}

/// Small integer coordinates make rays meet edges and vertices exactly: the determinants are true zeros.
void integer_edges(Run& run) {
    Mesh mesh = grid(8);
    for (glm::vec3& p : mesh.positions) p = glm::round(p * 8.f);
    const Bvh bvh = build(run, mesh, {.layout = Layout::binary});
    std::vector<Ray> rays;
    for (int y = 1; y < 16; ++y)
        for (int x = 1; x < 16; ++x)
            for (int dx = -3; dx <= 3; ++dx)
                for (int dy = -3; dy <= 3; ++dy)
                    for (const float side : {1.f, -1.f}) {
                        const glm::vec3 target(float(x) * 0.5f, float(y) * 0.5f, 0);
                        const glm::vec3 direction(float(dx), float(dy), -8.f * side);
                        rays.push_back(make_ray(target - 4.f * direction, direction));
                    }
    Tally claimed;
    for (const std::uint32_t claims : claims_of(bvh, Buffer<Ray>(run.device(), rays))) claimed.add(claims == 1);
    report(run, claimed, "not claimed once", rays, mesh, 0);
    run.check("rays not claimed once", claimed, "rays");
}

}  // namespace

Cases edge_cases() {
    return {
        {{"edges", "triangles", "Rays through edges from inside a closed mesh hit exactly one triangle"}, edges},
        {{"vertices", "triangles", "Rays through vertices from inside a closed mesh hit exactly one triangle"},
         vertices},
        {{"integer-edges", "triangles", "Rays through edges and vertices with determinants of exactly 0"},
         integer_edges},
        {{"fans", "triangles", "Fans of 4 to 65,536 triangles have exactly one hit everywhere"}, fans},
        {{"closed-meshes", "triangles", "Rays leave random closed meshes exactly once"}, closed_meshes},
    };
}

}  // namespace claray::verify
