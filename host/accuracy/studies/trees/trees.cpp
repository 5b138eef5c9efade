// Study of kinds of trees: octree, k-d tree and bounding volume hierarchies, under the same rays and tests of
// triangles.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <memory>

#include "host/accuracy/studies/ray_variants.hpp"
#include "host/accuracy/studies/trees/cells.hpp"
#include "host/accuracy/studies/trees/karras.hpp"
#include "host/accuracy/study.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/measure/measure.hpp"
#include "host/measure/rays.hpp"

namespace claray {
namespace {

constexpr unsigned least_tree_rounds = 5, most_host_builds = 3;

/// A tree that is built repeatedly, and its kernel of one ray per item.
struct StudiedTree {
    std::string method;
    std::function<void()> build;              ///< on the device; absent for trees of the host
    std::function<void(bool counted)> trace;  ///< into `hits` and, if counted, `visits`
    std::vector<double> host_builds = {};     ///< seconds
    double listed = 1;                        ///< triangles in leaves over triangles
    std::function<double()> megabytes;
    Buffer<Hit> hits = {};
    Buffer<Visits> visits = {};
    Bvh bvh = {};
};

/// What all trees share.
struct TreeStage {
    const Device& device;
    const Buffer<Ray>& rays;
    TriangleBuffers triangles;
    Bvh reference;  ///< its leaves are the valid triangles

    [[nodiscard]] std::uint32_t count() const { return std::uint32_t(rays.size()); }
    [[nodiscard]] unsigned group() const { return std::max(1u, device.tuning("trace/closest_hit", "GROUP_SIZE")); }
    [[nodiscard]] unsigned rays_per_item() const {
        return std::max(1u, device.tuning("trace/closest_hit", "RAYS_PER_ITEM"));
    }
    [[nodiscard]] Range range() const { return {(count() + rays_per_item() - 1) / rays_per_item(), group()}; }
    [[nodiscard]] Kernel load(const char* file, const char* kernel, Defines defines, bool counted) const {
        defines.emplace_back("CLARAY_COUNT_VISITS", counted ? "1" : "0");
        defines.emplace_back("GROUP_SIZE", std::to_string(group()));
        defines.emplace_back("RAYS_PER_ITEM", std::to_string(rays_per_item()));
        return load_kernel(device, file, kernel, defines);
    }
};

std::unique_ptr<StudiedTree> tree_on(const TreeStage& stage, const char* method) {
    auto tree = std::make_unique<StudiedTree>();
    tree->method = method;
    tree->hits = Buffer<Hit>(stage.device, stage.count()), tree->visits = Buffer<Visits>(stage.device, stage.count());
    return tree;
}

double megabytes_of(std::size_t nodes, std::size_t node_bytes, std::size_t leaves) {
    return 1e-6 * (double(nodes) * double(node_bytes) + double(leaves) * sizeof(LeafTriangle));
}

std::unique_ptr<StudiedTree> bvh_tree(const TreeStage& stage, const char* method, Builder builder) {
    auto tree = tree_on(stage, method);
    StudiedTree* t = tree.get();
    t->bvh = Bvh::build(stage.device, stage.triangles, {.builder = builder, .layout = Layout::binary});
    t->build = [t] { t->bvh.rebuild(); };
    const Kernel kernels[] = {stage.load("accuracy/trace_variant.cl", "trace_variant", {}, false),
                              stage.load("accuracy/trace_variant.cl", "trace_variant", {}, true)};
    t->trace = [t, &stage, plain = kernels[0], counting = kernels[1]](bool counted) {
        Kernel kernel = counted ? counting : plain;
        kernel.run(stage.range(), state_of(t->bvh).header, state_of(t->bvh).nodes, state_of(t->bvh).leaves, stage.rays,
                   stage.count(), t->hits, t->visits);
    };
    const BvhStatistics statistics = t->bvh.statistics();
    t->listed = 1 + double(statistics.references) / std::max(1.0, double(statistics.triangles));
    t->megabytes = [t] {
        const BvhHeader header = state_of(t->bvh).read_header();
        return megabytes_of(header.inner_nodes, sizeof(BvhNode), header.valid);
    };
    return tree;
}

std::unique_ptr<StudiedTree> karras_tree(const TreeStage& stage) {
    auto tree = tree_on(stage, "LBVH, Karras");
    StudiedTree* t = tree.get();
    const unsigned max_leaf = Bvh::Config{}.max_leaf_triangles;
    const auto built =
        std::make_shared<KarrasTree>(stage.device, sort_triangles(stage.device, stage.triangles), max_leaf);
    t->build = [built] { built->build(); };
    const Kernel kernels[] = {stage.load("accuracy/trace_variant.cl", "trace_variant", {}, false),
                              stage.load("accuracy/trace_variant.cl", "trace_variant", {}, true)};
    t->trace = [t, &stage, built, plain = kernels[0], counting = kernels[1]](bool counted) {
        Kernel kernel = counted ? counting : plain;
        kernel.run(stage.range(), built->header(), built->nodes(), built->leaves(), stage.rays, stage.count(), t->hits,
                   t->visits);
    };
    t->megabytes = [built] {
        const BvhHeader header = built->header().read()[0];
        return megabytes_of(header.inner_nodes, sizeof(BvhNode), header.valid);
    };
    return tree;
}

std::unique_ptr<StudiedTree> cell_tree(const TreeStage& stage, const char* method, unsigned split_axes,
                                       CellTree (*build)(std::span<const LeafTriangle>), unsigned rounds,
                                       double most_seconds) {
    auto tree = tree_on(stage, method);
    StudiedTree* t = tree.get();
    const std::vector<LeafTriangle> leaves = state_of(stage.reference).leaves.read();
    const std::size_t valid = state_of(stage.reference).read_header().valid;
    CellTree cells;
    double seconds = 0;
    for (unsigned i = 0; i < std::clamp(rounds, 1u, most_host_builds); ++i) {
        if (i > 0 && most_seconds > 0 && seconds >= most_seconds) break;
        const auto begin = std::chrono::steady_clock::now();
        cells = build(std::span(leaves).first(valid));
        t->host_builds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        seconds += t->host_builds.back();
    }
    t->listed = double(cells.lists.size()) / std::max(1.0, double(valid));
    const unsigned stack = cells.height * ((1u << split_axes) - 1) + 1;
    const Defines defines = {{"SPLIT_AXES", std::to_string(split_axes)}, {"STACK", std::to_string(stack)}};
    const Kernel kernels[] = {stage.load("accuracy/trace_cells.cl", "trace_cells", defines, false),
                              stage.load("accuracy/trace_cells.cl", "trace_cells", defines, true)};
    const Buffer<CellNode> nodes(stage.device, cells.nodes);
    const Buffer<std::uint32_t> lists(stage.device, cells.lists);
    t->trace = [=, &stage, plain = kernels[0], counting = kernels[1]](bool counted) {
        Kernel kernel = counted ? counting : plain;
        kernel.run(stage.range(), state_of(stage.reference).header, nodes, lists, state_of(stage.reference).leaves,
                   stage.rays, stage.count(), t->hits, t->visits);
    };
    const double bytes = 1e-6 * double(nodes.bytes() + lists.bytes()) + megabytes_of(0, 0, valid);
    t->megabytes = [bytes] { return bytes; };
    return tree;
}

/// Times of the commands whose kernels build the hierarchy of a linear BVH, in milliseconds.
double hierarchy_time(const measure::Timing& timing) {
    double sum = 0;
    for (const auto& [name, ms] : timing.commands)
        for (const char* part : {"build_lbvh", "join_lbvh_ranges", "find_splits", "fit_boxes"})
            if (name == part || (name == "build_lbvh_ranges" && std::strcmp(part, "build_lbvh") == 0)) sum += ms;
    return sum;
}

struct TreeTimings {
    measure::Timing build, trace;
};

StudyPoint point_of_tree(StudiedTree& tree, const TreeTimings& timings, const std::vector<Hit>& expected) {
    StudyPoint point;
    point.method = tree.method, point.setting = tree.build ? "device" : "host, one thread";
    point.runs = unsigned(timings.trace.rounds.size());
    point.error = spread_of(timings.trace.rounds, 1e3 / double(tree.hits.size()));
    point.seconds = tree.build ? spread_of(timings.build.spans, 1e-3) : spread_of(tree.host_builds, 1);
    if (!(point.error.median > 0)) {
        point.failure = "was not run";
        return point;
    }
    tree.trace(true);
    double boxes = 0, triangles = 0;
    for (const Visits& v : tree.visits.read()) boxes += v.nodes, triangles += v.triangles;
    const auto rays = double(tree.hits.size());
    const double hierarchy = hierarchy_time(timings.build);
    point.facts = {{"build, ms", 1e3 * point.seconds.median}};
    if (hierarchy > 0) point.facts.emplace_back("hierarchy alone, ms", hierarchy);
    point.facts.insert(point.facts.end(), {{"boxes a ray", boxes / rays},
                                           {"triangles a ray", triangles / rays},
                                           {"lists of a triangle", tree.listed},
                                           {"MB", tree.megabytes()},
                                           {"Mrays/s", 1 / point.error.median}});
    const std::vector<Hit> hits = tree.hits.read();
    std::size_t differ = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) differ += std::memcmp(&hits[i], &expected[i], sizeof(Hit)) != 0;
    if (differ != 0) point.failure = std::to_string(differ) + " hits differ from those of the other trees";
    return point;
}

/// Karras' kernels begin with sorted codes; all before is what Apetrei's build spends outside of its hierarchy.
void add_codes_and_sort(StudyPoint& karras, const StudyPoint& apetrei) {
    if (!karras.failure.empty() || !apetrei.failure.empty()) return;
    const double before = apetrei.seconds.median - 1e-3 * fact_of(apetrei, "hierarchy alone, ms");
    for (double* value : {&karras.seconds.low, &karras.seconds.median, &karras.seconds.high}) *value += before;
    karras.facts[0].second = 1e3 * karras.seconds.median;
}

void compare_with_linear(Study& study, const StudyPoint& linear) {
    for (const StudyPoint& p : study.points) {
        if (!p.failure.empty() || !linear.failure.empty() || p.method.starts_with("LBVH")) continue;
        study.findings.push_back(printed(
            "%s: the linear BVH traces %.0f %% as many rays per second, tests %.2f times as many boxes per ray, and is "
            "built "
            "%.3g times as fast",
            p.method.c_str(), 100 * p.error.median / linear.error.median,
            fact_of(linear, "boxes a ray") / fact_of(p, "boxes a ray"), p.seconds.median / linear.seconds.median));
    }
}

/// Builds and traces all trees in turns. A tree of the host has been built.
std::vector<TreeTimings> time_trees(const Device& device, std::vector<std::unique_ptr<StudiedTree>>& trees,
                                    unsigned rounds, const AccuracyProgress& progress) {
    std::vector<std::function<void()>> tasks;
    double done = 0;
    bool goes_on = true;
    const auto tell = [&](const std::string& what) {
        done += 1.0 / (2.0 * double(trees.size()) * (rounds + 1));
        goes_on = goes_on && (!progress || progress(std::min(done, 1.0), what));
    };
    for (const auto& tree : trees) {
        tasks.emplace_back([&, t = tree.get()] {
            if (goes_on && t->build) t->build(), device.finish();
            tell("building, " + t->method);
        });
        tasks.emplace_back([&, t = tree.get()] {
            if (goes_on) t->trace(false), device.finish();
            tell("tracing, " + t->method);
        });
    }
    const std::vector<measure::Timing> timings = measure::measure_rounds(device, int(rounds), tasks);
    std::vector<TreeTimings> all;
    for (std::size_t i = 0; i < trees.size(); ++i) all.push_back({timings[2 * i], timings[2 * i + 1]});
    return all;
}

}  // namespace

Study study_trees(const Device& device, const Scene& scene, const StudyOptions& options,
                  const AccuracyProgress& progress) {
    Study study;
    study.name = "trees", study.title = "Kinds of trees: time to build, time to trace";
    study.error = "seconds to trace 10^6 rays", study.cost = "seconds to build", study.sweeps = false;
    const std::vector<Mesh> meshes = measure::world_meshes(scene);
    const Buffer<Ray> rays(device, rays_of_scene(device, scene, meshes, options.rays));
    const unsigned rounds = std::max(options.runs, least_tree_rounds);
    const Bvh reference = Bvh::build(device, meshes, {.builder = Builder::fast, .layout = Layout::binary});
    const TreeStage stage{device, rays, reference.triangles(), reference};
    std::vector<std::unique_ptr<StudiedTree>> trees;
    trees.push_back(cell_tree(stage, "octree", 3, build_octree, rounds, options.most_seconds));
    trees.push_back(cell_tree(stage, "k-d tree", 1, build_kd_tree, rounds, options.most_seconds));
    trees.push_back(karras_tree(stage));
    const std::size_t apetrei = trees.size();
    trees.push_back(bvh_tree(stage, "LBVH, Apetrei", Builder::fast));
    trees.push_back(bvh_tree(stage, "H-PLOC", Builder::balanced));
    trees.push_back(bvh_tree(stage, "binned SAH", Builder::binned));
    trees.push_back(bvh_tree(stage, "spatial splits", Builder::high));

    const std::vector<TreeTimings> timings = time_trees(device, trees, rounds, progress);
    trees[apetrei]->trace(false);
    const std::vector<Hit> expected = trees[apetrei]->hits.read();
    for (std::size_t i = 0; i < trees.size(); ++i)
        study.points.push_back(point_of_tree(*trees[i], timings[i], expected));
    add_codes_and_sort(study.points[apetrei - 1], study.points[apetrei]);
    mark_front(study.points);
    study.findings.push_back(told_crossings(study.points));
    compare_with_linear(study, study.points[apetrei]);
    return study;
}

}  // namespace claray
