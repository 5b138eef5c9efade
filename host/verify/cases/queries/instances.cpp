// Instances, still and moving, against all triangles in the world in float64.
#include "host/verify/cases/cases.hpp"
#include "host/verify/oracles/instance_oracle.hpp"
#include "host/verify/placements.hpp"

namespace claray::verify {
namespace {

std::vector<Bvh> bottoms_of(const Run& run, const std::vector<Mesh>& meshes, Layout layout) {
    std::vector<Bvh> bottoms;
    for (const Mesh& mesh : meshes) bottoms.push_back(build(run, mesh, {.layout = layout}));
    return bottoms;
}

std::vector<Mesh> bottom_meshes(const Run& run) { return {soup(60, 0.5f, run.seed() + 3), sphere(1)}; }

/// The rays whose closest or any hits are wrong.
struct Found {
    Tally closest, any;
};

/// Compares closest hits with the oracle, and any hits with these.
void judge(Run& run, const InstancedBvh& bvh, const InstanceOracle& oracle, const std::vector<Ray>& rays,
           const QueryOptions& options, const std::string& what, Found& found) {
    const auto hits = closest_hit(bvh, rays, options);
    const InstanceComparison c = oracle.compare(rays, hits);
    if (c.wrong) run.failure(what + ", a wrong hit: " + text_of(rays[c.first_wrong]));
    if (c.hits < rays.size() / 500 || c.marginal > rays.size() / 500 + 3) run.failure(what + ": too few clear hits");
    found.closest.add(c.hits >= rays.size() / 500 && c.marginal <= rays.size() / 500 + 3);
    found.closest.tried += rays.size(), found.closest.wrong += c.wrong;
    const auto occluded = any_hit(bvh, rays, options);
    for (std::size_t i = 0; i < rays.size(); ++i)
        if (found.any.add((occluded[i] != 0) == (hits[i].primitive != CLARAY_MISS)))
            run.failure(what + ", a wrong any hit: " + text_of(rays[i]));
}

void report(Run& run, const Found& found, const std::string& layout) {
    run.check("wrong closest hits, " + layout, found.closest, "rays");
    run.check("wrong any hits, " + layout, found.any, "rays");
}

QueryOptions with_or_without_tree(const Run& run, bool without, std::vector<float> times = {}) {
    QueryOptions options;
    options.brute_force = without;
    if (!times.empty()) options.ray_times = Buffer<float>(run.device(), times);
    return options;
}

/// Built, then moved and refitted, then rebuilt.
void instances(Run& run) {
    const std::vector<Mesh> meshes = bottom_meshes(run);
    const auto rays = random_rays(run.count<std::size_t>(1500, 100'000), 8.f, 2.f, run.seed() + 5);
    for (const auto& [layout, layout_name] : layouts) {
        Found found;
        for (const std::size_t count : {1u, 2u, 3u, 101u})
            for (const auto& [builder, builder_name, note, codes, splits] : builders) {
                if (count != 101 && builder != Builder::fast) continue;
                auto placed = random_instances(count, 2, 2.f, count < 10 ? 1.f : 0.3f, run.seed() + count);
                InstancedBvh bvh = InstancedBvh::build(bottoms_of(run, meshes, layout), placed, {.builder = builder});
                const std::string what = std::to_string(count) + " instances, " + builder_name + ", " + layout_name;
                judge(run, bvh, InstanceOracle(meshes, placed), rays, {}, what, found);
                placed = moved(placed, 1.f, run.seed() + 7);
                Buffer<Instance>(bvh.instances()).write(placed);
                const InstanceOracle oracle(meshes, placed);
                for (const bool refits : {true, false}) {
                    refits ? bvh.refit() : bvh.rebuild();
                    judge(run, bvh, oracle, rays, with_or_without_tree(run, !refits && builder == Builder::fast),
                          what + (refits ? ", refitted" : ", rebuilt"), found);
                }
            }
        report(run, found, layout_name);
    }
}

/// At several times of the motion, each for all rays.
void moving_instances(Run& run) {
    const std::vector<Mesh> meshes = bottom_meshes(run);
    const auto rays = random_rays(run.count<std::size_t>(1500, 100'000), 8.f, 2.f, run.seed() + 6);
    for (const auto& [layout, layout_name] : layouts) {
        Found found;
        for (const std::size_t count : {1u, 3u, 101u}) {
            const auto begins = random_instances(count, 2, 2.f, count < 10 ? 1.f : 0.3f, run.seed() + count + 10);
            const auto ends = (count == 3 ? moved_in_part : moved)(begins, 1.5f, run.seed() + count + 11);
            const InstancedBvh bvh = InstancedBvh::build(bottoms_of(run, meshes, layout), begins, ends, {});
            for (const float time : {0.f, 0.3f, 0.7182818f, 1.f}) {
                const std::string what =
                    std::to_string(count) + " instances, " + layout_name + ", time " + std::to_string(time);
                judge(run, bvh, InstanceOracle(meshes, begins, ends, time), rays,
                      with_or_without_tree(run, time == 0.3f, std::vector<float>(rays.size(), time)), what, found);
            }
        }
        report(run, found, layout_name);
    }
}

}  // namespace

Cases instance_cases() {
    return {
        {{"instances", "queries", "Hits of instances, built, refitted and rebuilt, against float64"}, instances},
        {{"moving-instances", "queries", "Hits of moving instances at several times against float64"},
         moving_instances},
    };
}

}  // namespace claray::verify
