// What each preset's tree costs and saves: bench_quality [--device D] [--repeat N] [--rays N] [--csv FILE] [SCENE...]
// prints build time, SAH cost, and for primary, shadow and bounce rays the boxes and triangles tested a ray in the
// binary tree and the rays a second in the device's own layout. Hits must be the same bit for bit.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstring>

#include "bench/support.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv;
    int repeat = 3;
    unsigned size = 256;  // rays along each side of a view
    Bvh::Config config;
    std::vector<std::string> builders = {"fast", "balanced", "high"};
    std::vector<std::string> scenes = {"soup:100000", "terrain:1000000"};
};

struct Kind {
    const char* name;
    Buffer<Ray> rays;
    std::vector<Hit> hits;
};

struct Cost {
    double nodes = 0, triangles = 0;
};

Cost count_visits(const Bvh& bvh, const Kind& kind, Buffer<Hit>& hits) {
    QueryOptions options;
    options.visits = Buffer<Visits>(bvh.device(), kind.rays.size());
    closest_hit(bvh, kind.rays, hits, options);
    Cost cost;
    for (const Visits& v : options.visits.read()) cost.nodes += v.nodes, cost.triangles += v.triangles;
    cost.nodes /= double(kind.rays.size()), cost.triangles /= double(kind.rays.size());
    return cost;
}

std::size_t count_differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    std::size_t differences = 0;
    for (std::size_t i = 0; i < a.size(); ++i) differences += std::memcmp(&a[i], &b[i], sizeof(Hit)) != 0;
    return differences;
}

void report(const Device& device, const Options& options, const std::string& name, measure::Csv& csv) {
    Scene scene;
    scene.meshes = measure::load_meshes(name);
    const measure::RaySets rays =
        measure::make_rays(device, scene, measure::three_views(name, scene), options.size, options.size);
    Kind kinds[] = {{"primary", Buffer<Ray>(device, rays.primary), {}},
                    {"shadow", Buffer<Ray>(device, rays.shadow), {}},
                    {"bounce", Buffer<Ray>(device, rays.bounce), {}}};
    for (const auto& [builder_name, builder] : measure::builders) {
        if (std::find(options.builders.begin(), options.builders.end(), builder_name) == options.builders.end())
            continue;
        Bvh::Config config = options.config;
        config.builder = builder;
        Bvh traced = Bvh::build(device, scene.meshes, config);
        const double build_ms = measure::measure(device, options.repeat, [&] { traced.rebuild(); }).at("");
        config.layout = Layout::binary;
        const Bvh binary = Bvh::build(device, scene.meshes, config);
        const BvhStatistics s = binary.statistics();
        std::printf("%s, %s: %u triangles, %u more references, build %.2f ms, SAH %.2f, height %u, %.1f MB\n",
                    name.c_str(), builder_name.c_str(), s.triangles, s.references, build_ms, s.sah_cost, s.height,
                    double(s.bytes) * 1e-6);
        for (Kind& kind : kinds) {
            Buffer<Hit> hits(device, kind.rays.size());
            const Cost cost = count_visits(binary, kind, hits);
            const std::vector<Hit> found = hits.read();
            if (kind.hits.empty()) kind.hits = found;
            const auto ms = measure::measure(device, options.repeat, [&] { closest_hit(traced, kind.rays, hits); });
            const double mrays = double(kind.rays.size()) * 1e-3 / ms.at("closest_hit");
            std::printf("    %-8s %7.2f boxes, %6.2f triangles a ray; %.2f Mrays/s; hits that differ: %zu\n", kind.name,
                        cost.nodes, cost.triangles, mrays, count_differences(found, kind.hits));
            csv.row(name, builder_name, s.triangles, s.references, build_ms, s.sah_cost, s.height, s.bytes, kind.name,
                    cost.nodes, cost.triangles, mrays);
        }
    }
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares the presets' trees");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--repeat", options.repeat);
    app.add_option("--size", options.size, "rays along each side of a view");
    app.add_option("--csv", options.csv);
    app.add_option("--builders", options.builders, "presets to compare")->allow_extra_args(false)->delimiter(',');
    app.add_option("--splits", options.config.split_budget, "further references a triangle");
    app.add_option("--leaf", options.config.max_leaf_triangles, "triangles a leaf may hold");
    app.add_option("scenes", options.scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.device);
    measure::Csv csv(
        options.csv, device,
        "scene,builder,triangles,references,build_ms,sah_cost,height,bytes,kind,boxes,triangles_tested,mrays");
    for (const std::string& scene : options.scenes) report(device, options, scene, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_quality: error: %s\n", error.what());
    return 1;
}
