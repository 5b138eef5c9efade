// Study of trees: time to build against time to trace, and refitting after motion.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "host/accuracy/studies/ray_variants.hpp"
#include "host/accuracy/study.hpp"
#include "host/measure/measure.hpp"
#include "host/measure/rays.hpp"

namespace claray {
namespace {

/// With fewer rounds, quartiles are too often apart by chance.
constexpr unsigned least_rounds = 5;

/// A tree that is built repeatedly, and the rays to trace.
struct Candidate {
    std::string method, setting;
    double value = 0;
    std::function<void()> make;
    Bvh bvh;
    const Buffer<Ray>* rays = nullptr;
};

/// Moves vertices by a smooth wave of the scene's length. The amplitude is the fraction `share` of that length.
std::vector<Mesh> moved(std::vector<Mesh> meshes, const Bounds& bounds, float share) {
    const glm::vec3 extent = bounds.extent();
    const float size = std::max({extent.x, extent.y, extent.z, 1e-30f});
    for (Mesh& mesh : meshes)
        for (glm::vec3& p : mesh.positions) {
            const glm::vec3 at = (p - bounds.center()) * (6.2831853f / size);
            p += share * size * glm::vec3(std::sin(at.y + at.z), std::sin(at.z + at.x), std::sin(at.x + at.y));
        }
    return meshes;
}

/// Positions of all meshes, as TriangleBuffers hold them.
std::vector<float> positions_of(const std::vector<Mesh>& meshes) {
    std::vector<float> all;
    for (const Mesh& mesh : meshes)
        for (const glm::vec3& p : mesh.positions) all.insert(all.end(), {p.x, p.y, p.z});
    return all;
}

StudyPoint point_of_build(const Candidate& candidate, const measure::Timing& made, const measure::Timing& traced) {
    StudyPoint point;
    point.method = candidate.method, point.setting = candidate.setting, point.value = candidate.value;
    point.runs = unsigned(made.spans.size());
    point.error = spread_of(traced.spans, 1e3 / double(candidate.rays->size()));
    point.seconds = spread_of(made.spans, 1e-3);
    if (!(point.error.median > 0)) {
        point.failure = "was not run";
        return point;
    }
    const BvhStatistics statistics = candidate.bvh.statistics();
    point.facts = {{"build, ms", 1e3 * point.seconds.median},
                   {"SAH cost", statistics.sah_cost},
                   {"MB", 1e-6 * double(statistics.bytes)},
                   {"Mrays/s", 1 / point.error.median}};
    return point;
}

bool has_moved(const StudyPoint& p) { return p.method == "refit" || p.method == "rebuild"; }

/// Compares trees of the same triangles only: their points are neighbours.
void mark_fronts(std::vector<StudyPoint>& points) {
    for (auto begin = points.begin(); begin != points.end();) {
        const auto end = std::find_if(begin, points.end(), [&](const StudyPoint& p) {
            return has_moved(p) != has_moved(*begin) || (has_moved(p) && p.setting != begin->setting);
        });
        std::vector<StudyPoint> same(begin, end);
        mark_front(same);
        begin = std::copy(same.begin(), same.end(), begin);
    }
}

/// Times of three numbers of rays, with the build.
void tabulate(Study& study) {
    for (const double millions : {0.01, 1.0, 100.0}) {
        std::string text = printed("%g million rays, including the build:", millions);
        bool some = false;
        for (const StudyPoint& p : study.points)
            if (p.failure.empty() && p.setting == "63 bits") {
                text += printed("%s %s %.4g s", some ? "," : "", p.method.c_str(),
                                p.seconds.median + millions * p.error.median);
                some = true;
            }
        if (some) study.findings.push_back(text);
    }
}

void judge_refits(Study& study) {
    for (std::size_t i = 0; i + 1 < study.points.size(); ++i) {
        const StudyPoint &refit = study.points[i], &rebuild = study.points[i + 1];
        if (refit.method != "refit" || !refit.failure.empty() || !rebuild.failure.empty()) continue;
        std::string text = refit.setting + ": compared with a rebuild, a refit is done " +
                           told_time_against(refit.seconds, rebuild.seconds) + ", and rays are traced " +
                           told_time_against(refit.error, rebuild.error);
        const double saved = rebuild.seconds.median - refit.seconds.median,
                     lost = refit.error.median - rebuild.error.median;
        if (saved > 0 && lost > 0 && !overlap(refit.error, rebuild.error))
            text += printed("; a rebuild pays off from %.3g million rays on", saved / lost);
        study.findings.push_back(text);
    }
}

/// Builds and traces in alternating runs: two timings per candidate.
std::vector<measure::Timing> time_candidates(const Device& device, std::vector<Candidate>& candidates, unsigned rounds,
                                             const AccuracyProgress& progress) {
    std::vector<std::function<void()>> tasks;
    double done = 0;
    bool goes_on = true;
    const auto tell = [&](const Candidate& c, const char* what) {
        done += 1.0 / (2.0 * double(candidates.size()) * (rounds + 1));
        goes_on = goes_on && (!progress || progress(std::min(done, 1.0), what + (" " + c.method)));
    };
    for (Candidate& c : candidates) {
        auto hits = std::make_shared<Buffer<Hit>>(device, c.rays->size());
        tasks.emplace_back([&] {
            if (goes_on) c.make(), device.finish(), tell(c, "building,");
        });
        tasks.emplace_back([&, hits] {
            if (goes_on) closest_hit(c.bvh, *c.rays, *hits), device.finish(), tell(c, "tracing,");
        });
    }
    return measure::measure_rounds(device, int(rounds), tasks);
}

}  // namespace

Study study_builds(const Device& device, const Scene& scene, const StudyOptions& options,
                   const AccuracyProgress& progress) {
    Study study;
    study.name = "builds", study.title = "Trees: time to build, time to trace";
    study.error = "seconds to trace 10^6 rays", study.cost = "seconds to build", study.sweeps = false;
    const std::vector<Mesh> meshes = measure::world_meshes(scene);
    const Bounds bounds = bounds_of(scene);
    const Buffer<Ray> rays(device, rays_of_scene(device, scene, meshes, options.rays));
    std::vector<Candidate> candidates;
    candidates.reserve(2 * std::size(builders) + 6);  // tasks keep references to them
    const Bvh triangles = Bvh::build(device, meshes);
    for (const auto& [builder, name, note, codes, splits] : builders)
        for (const unsigned bits : {30u, 63u}) {
            Candidate& c =
                candidates.emplace_back(Candidate{name, printed("%u bits", bits), double(bits), {}, {}, &rays});
            c.make = [&c, &device, &triangles, config = Bvh::Config{.builder = builder, .morton_bits = bits}] {
                c.bvh = Bvh::build(device, triangles.triangles(), config);
            };
        }
    std::vector<Buffer<Ray>> moved_rays;
    moved_rays.reserve(3);
    for (const float share : {0.01f, 0.05f, 0.2f}) {
        const std::vector<Mesh> now = moved(meshes, bounds, share);
        moved_rays.emplace_back(device, rays_of_scene(device, scene, now, options.rays));
        for (const bool refit : {true, false}) {
            Candidate& c = candidates.emplace_back(Candidate{refit ? "refit" : "rebuild",
                                                             printed("moved %g %%", 100.0 * double(share)),
                                                             share,
                                                             {},
                                                             {},
                                                             &moved_rays.back()});
            c.bvh = Bvh::build(device, meshes, {.builder = Builder::balanced});
            Buffer<float> positions = c.bvh.triangles().positions;
            positions.write(positions_of(now));
            c.make = [&c, refit] { refit ? c.bvh.refit() : c.bvh.rebuild(); };
        }
    }
    for (Candidate& c : candidates) c.make();

    const std::vector<measure::Timing> timings =
        time_candidates(device, candidates, std::max(options.runs, least_rounds), progress);
    for (std::size_t i = 0; i < candidates.size(); ++i)
        study.points.push_back(point_of_build(candidates[i], timings[2 * i], timings[2 * i + 1]));
    mark_fronts(study.points);
    std::vector<StudyPoint> unmoved;
    std::copy_if(study.points.begin(), study.points.end(), std::back_inserter(unmoved),
                 [](const StudyPoint& p) { return !has_moved(p); });
    study.findings.push_back(told_crossings(unmoved));
    tabulate(study);
    judge_refits(study);
    return study;
}

}  // namespace claray
