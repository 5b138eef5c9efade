// Study of nodes: boxes in fewer bits.
#include <algorithm>

#include "claray/shared/quantized_node.h"
#include "host/accuracy/studies/ray_variants.hpp"
#include "host/accuracy/study.hpp"
#include "host/measure/rays.hpp"

namespace claray {
namespace {

std::size_t different(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        count += a[i].primitive != b[i].primitive || a[i].t != b[i].t || a[i].u != b[i].u || a[i].v != b[i].v;
    return count;
}

}  // namespace

Study study_nodes(const Device& device, const Scene& scene, const StudyOptions& options,
                  const AccuracyProgress& progress) {
    Study study;
    study.name = "nodes", study.title = "Boxes with fewer bits";
    study.error = "additional boxes tested, compared with full floats, per ray", study.cost = "seconds per 10^6 rays";
    const std::vector<Mesh> meshes = measure::world_meshes(scene);
    const std::vector<Ray> rays = rays_of_scene(device, scene, meshes, options.rays);
    std::vector<RayVariant> variants;
    for (const unsigned bits : {32u, 16u, 8u})
        variants.push_back(
            {.method = "binary tree", .setting = std::to_string(bits) + " bits a plane", .node_bits = bits});
    const auto traced = trace_variants(device, meshes, rays, variants, std::max(options.runs, 1u), progress);
    for (std::size_t i = 0; i < variants.size(); ++i) {
        StudyPoint point;
        point.method = variants[i].method, point.setting = variants[i].setting, point.value = variants[i].node_bits;
        point.runs = unsigned(traced[i].seconds.size());
        if (traced[i].hits.empty()) {
            point.failure = "was not run";
        } else if (const std::size_t wrong = different(traced[i].hits, traced[0].hits); wrong != 0) {
            point.failure = std::to_string(wrong) + " hits differ";
        }
        std::vector<double> seconds;
        for (const double s : traced[i].seconds) seconds.push_back(s * 1e6 / double(rays.size()));
        const double more = traced[i].boxes - traced[0].boxes;
        const unsigned bits = variants[i].node_bits;
        const std::size_t bytes = bits == 32 ? sizeof(BvhNode) : 4 * CLARAY_QUANTIZED_WORDS(bits);
        point.error = {more, more, more}, point.seconds = spread_of(seconds);
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
