// Studies of rays: errors and speed of tests of triangles and boxes, and of boxes in fewer bits.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "claray/shared/study_nodes.h"
#include "host/accuracy/studies/ray_variants.hpp"
#include "host/accuracy/study.hpp"
#include "host/base/in_parallel.hpp"
#include "host/measure/rays.hpp"
#include "host/verify/oracle.hpp"
#include "host/verify/shapes.hpp"

namespace claray {
namespace {

struct RaySet {
    std::vector<Mesh> meshes;
    std::vector<Ray> rays;
    bool inside = false;     ///< of closed meshes, so that every ray must hit
    bool distances = false;  ///< the study's error is that of the distances
};

struct Faults {
    std::size_t rays = 0, missed = 0, invented = 0, agreeing = 0;
    double worst_ulp = 0;
    [[nodiscard]] Faults operator+(const Faults& f) const {
        return {rays + f.rays, missed + f.missed, invented + f.invented, agreeing + f.agreeing,
                std::max(worst_ulp, f.worst_ulp)};
    }
    [[nodiscard]] double per_million(std::size_t count) const { return rays ? 1e6 * double(count) / double(rays) : 0; }
};

double ulps(float t, double exact) {
    const float nearest = std::fabs(float(exact));
    const double ulp = double(std::nextafter(nearest, std::numeric_limits<float>::infinity())) - double(nearest);
    return std::fabs(double(t) - exact) / ulp;
}

/// The correct hits in float64; doubtful cases are judged by exact arithmetic.
class Truth {
public:
    explicit Truth(const RaySet& set) : set_(set), oracle_(set.meshes), nearest_(oracle_.closest_hits(set.rays)) {}

    /// On all cores: exact arithmetic tests all triangles with a doubtful ray.
    [[nodiscard]] Faults judge(std::span<const Hit> hits, std::size_t begin, std::size_t end) const {
        constexpr std::size_t together = 1024;
        std::vector<Faults> pieces((end - begin + together - 1) / together);
        in_parallel(pieces.size(), [&](std::size_t piece) {
            const std::size_t from = begin + piece * together;
            pieces[piece] = judge_piece(hits, from, std::min(from + together, end));
        });
        return std::accumulate(pieces.begin(), pieces.end(), Faults());
    }

private:
    [[nodiscard]] Faults judge_piece(std::span<const Hit> hits, std::size_t begin, std::size_t end) const {
        Faults faults;
        faults.rays = end - begin;
        for (std::size_t i = begin; i < end; ++i) {
            if (hits[i].primitive == nearest_[i].primitive) {
                if (hits[i].primitive == CLARAY_MISS) continue;
                ++faults.agreeing;
                faults.worst_ulp = std::max(faults.worst_ulp, ulps(hits[i].t, nearest_[i].t));
                continue;
            }
            const verify::Fault fault = fault_of(set_.rays[i], hits[i]);
            faults.invented += fault == verify::Fault::invented;
            faults.missed += fault == verify::Fault::missed || fault == verify::Fault::not_nearest;
        }
        return faults;
    }

    /// Ignores the distance that the hit claims: distances have their own figure.
    [[nodiscard]] verify::Fault fault_of(const Ray& ray, Hit hit) const {
        if (hit.primitive == CLARAY_MISS && set_.inside) return verify::Fault::missed;
        if (hit.primitive != CLARAY_MISS && hit.primitive < oracle_.triangles()) {
            const double exact = oracle_.distance(ray, hit.primitive);
            if (!(exact > double(ray.tmin) && exact <= double(ray.tmax))) return verify::Fault::invented;
            hit.t = float(exact);
        }
        return oracle_.judge(ray, hit);
    }

    const RaySet& set_;
    verify::Oracle oracle_;
    std::vector<verify::OracleHit> nearest_;
};

/// Each triangle test with claray's boxes; all tests of boxes with claray's triangles and with the most common ones.
std::vector<RayVariant> all_variants() {
    const std::pair<const char*, const char*> tests[] = {
        {"claray", "0"}, {"Moeller-Trumbore", "1"}, {"Woop", "2"}, {"Woop-Kahan", "3"}, {"float64", "4"}};
    const std::pair<const char*, const char*> boxes[] = {
        {"padded boxes", "1"}, {"2-ulp boxes", "2"}, {"bare boxes", "3"}, {"fused bare boxes", "4"}};
    std::vector<RayVariant> variants = {{.method = "claray", .setting = "as shipped", .shipped = true}};
    for (const auto& [name, test] : tests) {
        const Defines defines = {{"TRIANGLE_TEST", test}};
        variants.push_back({name, "strict", defines});
        variants.push_back({name, "contracted", {{"TRIANGLE_TEST", test}, {"CONTRACT", "1"}}});
        variants.push_back({name, "fast math", defines, Math::fast});
        if (std::stoi(test) > 1) continue;
        for (const auto& [box_name, box] : boxes)
            variants.push_back({name, box_name, {{"TRIANGLE_TEST", test}, {"BOX_TEST", box}}});
    }
    return variants;
}

StudyPoint point_of_rays(const RayVariant& variant, const TracedVariant& traced, const Truth& truth, bool distances,
                         unsigned parts) {
    StudyPoint point;
    point.method = variant.method, point.setting = variant.setting, point.runs = unsigned(traced.seconds.size());
    if (traced.hits.empty()) {
        point.failure = "was not run";
        return point;
    }
    const std::size_t rays = traced.hits.size();
    std::vector<double> wrong, ulp;
    Faults all;
    for (std::size_t part = 0; part < parts; ++part) {
        const Faults f = truth.judge(traced.hits, rays * part / parts, rays * (part + 1) / parts);
        wrong.push_back(f.per_million(f.missed + f.invented)), ulp.push_back(f.worst_ulp);
        all = all + f;
    }
    point.error = distances ? spread_of(ulp) : spread_of(wrong);
    point.value = point.error.median, point.seconds = spread_of(traced.seconds, 1e6 / double(rays));
    point.facts = {{"missed /10^6", all.per_million(all.missed)},
                   {"false /10^6", all.per_million(all.invented)},
                   {"worst t error, ulp", all.worst_ulp},
                   {"Mrays/s", 1 / point.seconds.median}};
    return point;
}

const StudyPoint* point_named(const Study& study, const std::string& method, const std::string& setting) {
    for (const StudyPoint& p : study.points)
        if (p.method == method && p.setting == setting && p.failure.empty()) return &p;
    return nullptr;
}

void judge_intersection(Study& study) {
    const StudyPoint* shipped = point_named(study, "claray", "as shipped");
    const StudyPoint* robust = point_named(study, "claray", "strict");
    const StudyPoint* textbook = point_named(study, "Moeller-Trumbore", "fused bare boxes");
    if (!shipped || !robust || !textbook) return;
    const auto wrong = [](const StudyPoint& p) { return fact_of(p, "missed /10^6") + fact_of(p, "false /10^6"); };
    study.findings.push_back(
        printed("claray as shipped has wrong hits for %.3g rays of 10^6 and distance errors of at most %.3g ulp",
                wrong(*shipped), fact_of(*shipped, "worst t error, ulp")));
    study.findings.push_back(printed(
        "the textbook's tests (Moeller-Trumbore, fused bare boxes) have wrong hits for %.3g rays of 10^6 and errors of "
        "at most %.3g ulp; claray's tests take %.2f times as long in the same loop",
        wrong(*textbook), fact_of(*textbook, "worst t error, ulp"), robust->seconds.median / textbook->seconds.median));
}

Study study_rays(const Device& device, const RaySet& set, const StudyOptions& options,
                 const AccuracyProgress& progress) {
    Study study;
    study.error = set.distances ? "largest distance error of correct hits, ulp" : "wrong hits per 10^6 rays";
    study.cost = "seconds per 10^6 rays", study.sweeps = false;
    if (set.rays.empty()) {
        study.findings.emplace_back("there are no rays");
        return study;
    }
    const std::vector<RayVariant> variants = all_variants();
    const unsigned rounds = rounds_of(options);
    const std::vector<TracedVariant> traced = trace_variants(device, set.meshes, set.rays, variants, options, progress);
    const Truth truth(set);
    for (std::size_t i = 0; i < variants.size(); ++i)
        study.points.push_back(point_of_rays(variants[i], traced[i], truth, set.distances, rounds));
    mark_front(study.points);
    judge_intersection(study);
    return study;
}

/// From the middle of two closed spheres of 1280 triangles, one of them far from the origin, to edges and vertices.
RaySet hard_rays(std::size_t wanted) {
    constexpr std::size_t share_of_scene_rays = 4;  // most of these rays are doubtful
    constexpr float radius = 100;
    const glm::vec3 centers[] = {glm::vec3(0), glm::vec3(148376, 1234, -223423)};
    RaySet set;
    set.inside = true;
    for (const glm::vec3& center : centers) {
        set.meshes.push_back(verify::sphere(3, radius));
        for (glm::vec3& p : set.meshes.back().positions) p += center;
    }
    verify::Random random(1);
    const std::size_t count = rays_to_judge(share_of_scene_rays * wanted, set.meshes) / share_of_scene_rays;
    for (std::size_t i = 0; i < count; ++i) {
        const Mesh& mesh = set.meshes[i % 2];
        const glm::uvec3 t = mesh.triangles[random.below(std::uint32_t(mesh.triangles.size()))];
        const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y];
        const glm::vec3 target = i / 2 % 2 == 0 ? a : a + random.uniform() * (b - a);
        const glm::vec3 origin = centers[i % 2] + random.in_cube(0.2f * radius);
        set.rays.push_back(verify::make_ray(origin, target - origin));
    }
    return set;
}

std::size_t different(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        count += a[i].primitive != b[i].primitive || a[i].t != b[i].t || a[i].u != b[i].u || a[i].v != b[i].v;
    return count;
}

}  // namespace

Study study_hard_rays(const Device& device, const Scene&, const StudyOptions& options,
                      const AccuracyProgress& progress) {
    Study study = study_rays(device, hard_rays(options.rays), options, progress);
    study.name = "hard-rays", study.title = "Triangle and box tests with rays aimed at edges and vertices";
    return study;
}

Study study_scene_rays(const Device& device, const Scene& scene, const StudyOptions& options,
                       const AccuracyProgress& progress) {
    RaySet set;
    set.distances = true;
    set.meshes = measure::world_meshes(scene);
    set.rays = rays_of_scene(device, scene, set.meshes, rays_to_judge(options.rays, set.meshes));
    Study study = study_rays(device, set, options, progress);
    study.name = "scene-rays", study.title = "Triangle and box tests with rays of the scene";
    return study;
}

Study study_nodes(const Device& device, const Scene& scene, const StudyOptions& options,
                  const AccuracyProgress& progress) {
    Study study;
    study.name = "nodes", study.title = "Boxes with fewer bits";
    study.error = "additional boxes tested, compared with full floats, per ray", study.cost = "seconds per 10^6 rays";
    const std::vector<Mesh> meshes = measure::world_meshes(scene);
    const std::vector<Ray> rays = rays_of_scene(device, scene, meshes, options.rays);
    std::vector<RayVariant> variants;
    for (const unsigned bits : {32u, 16u, 8u})
        variants.push_back({.method = "binary tree",
                            .setting = std::to_string(bits) + " bits a plane",
                            .node_bits = bits,
                            .counts_boxes = true});
    const auto traced = trace_variants(device, meshes, rays, variants, options, progress);
    for (std::size_t i = 0; i < variants.size(); ++i) {
        StudyPoint point;
        point.method = variants[i].method, point.setting = variants[i].setting, point.value = variants[i].node_bits;
        point.runs = unsigned(traced[i].seconds.size());
        if (traced[i].hits.empty()) {
            point.failure = "was not run";
        } else if (const std::size_t wrong = different(traced[i].hits, traced[0].hits); wrong != 0) {
            point.failure = std::to_string(wrong) + " hits differ";
        }
        const double more = traced[i].boxes - traced[0].boxes;
        const unsigned bits = variants[i].node_bits;
        const std::size_t bytes = bits == 32 ? sizeof(BvhNode) : 4 * CLARAY_QUANTIZED_WORDS(bits);
        point.error = {more, more, more}, point.seconds = spread_of(traced[i].seconds, 1e6 / double(rays.size()));
        point.facts = {
            {"bytes a node", double(bytes)}, {"boxes a ray", traced[i].boxes}, {"Mrays/s", 1 / point.seconds.median}};
        study.points.push_back(point);
        if (point.failure.empty() && i > 0 && traced[0].boxes > 0)
            study.findings.push_back(printed("%s: the same hits, %.3g times the boxes, ", point.setting.c_str(),
                                             traced[i].boxes / traced[0].boxes) +
                                     told_time_against(point.seconds, study.points[0].seconds));
    }
    mark_front(study.points);
    return study;
}

}  // namespace claray
