// Trees whose triangles move: every builder, layout and size of group, against exact arithmetic on the moved mesh.
#include <cmath>

#include "host/verify/cases/cases.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {
namespace {

/// Meshes with the triangles of the first one, which the tree is built over.
struct Motion {
    const char* name;
    Mesh mesh;
    bool is_sound = true;  // all of its triangles are in boxes
};

std::vector<Motion> motions(const Mesh& start) {
    std::vector<Motion> all = {
        {"turned and bent", start}, {"shrunk to a point", start, false}, {"with NaN", start, false}};
    for (glm::vec3& p : all[0].mesh.positions) p = glm::vec3(p.y, -p.x, p.z) + 0.3f * glm::sin(5.f * p);
    for (glm::vec3& p : all[1].mesh.positions) p = glm::vec3(0.25f, -0.5f, 0.125f);
    for (std::size_t i = 0; i < all[2].mesh.positions.size(); i += 7) all[2].mesh.positions[i][int(i % 3)] = NAN;
    all.push_back({"as it was", start});
    return all;
}

void move_to(const Bvh& bvh, const Mesh& mesh) {
    Buffer<float> positions = bvh.triangles().positions;
    positions.write(std::span(&mesh.positions[0].x, 3 * mesh.positions.size()));
}

/// Judges the hits of a refitted tree, and whether its boxes contain their triangles.
void judge_refit(Run& run, const Bvh& bvh, const Motion& motion, const Oracle& oracle, const std::vector<Ray>& rays,
                 const std::string& tree, Tally& wrong) {
    const std::string what = tree + ", " + motion.name;
    const bool sound = !motion.is_sound || bvh.validate().ok();
    if (wrong.add(sound)) run.failure(what + ": boxes do not contain their triangles");
    const auto hits = closest_hit(bvh, rays);
    const Oracle::Verdict verdict = oracle.judge(rays, hits);
    if (verdict.wrong && wrong.wrong == 0)
        run.failure(what + ", " + to_string(verdict.first_fault) + ": " + text_of(rays[verdict.first_wrong]));
    wrong.tried += rays.size(), wrong.wrong += verdict.wrong;
}

void refit_from(Run& run, const Mesh& start, const std::vector<Ray>& rays, unsigned group, Tally& wrong) {
    const ScopedTuning groups(run.device(), "bvh/refit", "GROUP_SIZE", group);
    const std::vector<Motion> all = motions(start);
    std::vector<Oracle> oracles;
    for (const Motion& motion : all) oracles.emplace_back(std::span(&motion.mesh, 1));
    for (const auto& [layout, layout_name] : layouts)
        for (const BuilderTraits& builder : builders) {
            Bvh bvh = build(run, start, {.builder = builder.builder, .layout = layout});
            for (std::size_t i = 0; i < all.size(); ++i) {
                move_to(bvh, all[i].mesh);
                bvh.refit();
                judge_refit(run, bvh, all[i], oracles[i], rays, std::string(builder.name) + ", " + layout_name, wrong);
            }
        }
}

/// Refits must find the hits of the moved triangles, from one triangle on.
void refits(Run& run) {
    const auto rays = random_rays(run.count<std::size_t>(1500, 100'000), 4.f, 1.f, run.seed() + 81);
    for (const unsigned group : {1u, 32u, 256u}) {
        Tally wrong;
        for (const std::size_t count : {std::size_t(1), std::size_t(3), run.count<std::size_t>(1500, 20'000)})
            refit_from(run, soup(count, 0.2f, run.seed() + count), rays, group, wrong);
        run.check("wrong hits and trees, groups of " + std::to_string(group), wrong, "rays and trees");
    }
}

/// The cost of a tree depends on ratios of areas only, and a twist makes it worse.
void refit_costs(Run& run) {
    const Mesh start = soup(run.count<std::size_t>(2000, 100'000), 0.05f, run.seed() + 82);
    double worst = 0;
    Tally grows;
    for (const BuilderTraits& builder : builders) {
        Bvh bvh = build(run, start, {.builder = builder.builder, .split_budget = 0});
        for (const float scale : {1.f, 0.125f, 64.f}) {
            Mesh scaled = start;
            for (glm::vec3& p : scaled.positions) p *= scale;
            move_to(bvh, scaled);
            bvh.refit();
            worst = std::max(worst, std::abs(bvh.cost_growth() - 1));
        }
        Mesh twisted = start;
        for (glm::vec3& p : twisted.positions) p.x += 3 * std::sin(40 * p.z), p.y += 3 * std::cos(40 * p.z);
        move_to(bvh, twisted);
        bvh.refit();
        grows.add(bvh.cost_growth() > 1.5);
    }
    run.check("growth of the cost of scaled trees off 1", 3 * std::size(builders), worst, 1e-5, "");
    run.check("trees whose cost a twist does not raise", grows, "trees");
}

}  // namespace

Cases refit_cases() {
    return {
        {{"refits", "trees", "Hits after a refit, with motion, collapse and NaN, against exact arithmetic"}, refits},
        {{"refit-costs", "trees", "Growth of a tree's cost: none by scaling, much by a twist"}, refit_costs},
    };
}

}  // namespace claray::verify
