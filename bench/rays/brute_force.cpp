// What the tree saves: bench_brute_force [--device D] [--size N] [--csv FILE] [SCENE] traces N x N primary rays with
// the tree and, in slices that keep each dispatch short, against every triangle; the hits must be the same.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/support.hpp"

using namespace claray;

namespace {

constexpr double slice_tests = 2e9;  // ray-triangle tests a dispatch: some 50 ms on a large GPU

struct Timed {
    std::vector<Hit> hits;
    double milliseconds = 0;
};

Timed trace(const Bvh& bvh, const std::vector<Ray>& rays, std::size_t slice, bool brute_force) {
    QueryOptions options;
    options.brute_force = brute_force;
    Timed timed;
    const char* kernel = brute_force ? "brute_force_closest_hit" : "closest_hit";
    for (std::size_t begin = 0; begin < rays.size(); begin += slice) {
        const auto part = std::span(rays).subspan(begin, std::min(slice, rays.size() - begin));
        bvh.device().profiler().reset();
        const std::vector<Hit> hits = closest_hit(bvh, part, options);
        timed.milliseconds += bvh.device().profiler().milliseconds(kernel);
        timed.hits.insert(timed.hits.end(), hits.begin(), hits.end());
    }
    return timed;
}

bool same(const Hit& a, const Hit& b) { return a.t == b.t && a.primitive == b.primitive && a.u == b.u && a.v == b.v; }

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares the tree with testing every triangle");
    std::string selector, csv_path, name = "soup:10000";
    unsigned size = 256;
    app.add_option("--device", selector);
    app.add_option("--size", size, "rays along each side of the image");
    app.add_option("--csv", csv_path);
    app.add_option("scene", name);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(selector);
    Scene scene;
    scene.meshes = measure::load_meshes(name);
    const Bvh bvh = Bvh::build(device, scene.meshes, {.learns = false});
    const std::vector<Ray> rays = measure::primary_rays(automatic_camera(bounds_of(scene)), size, size, false);
    const double tests = double(rays.size()) * double(bvh.triangle_count());
    (void)trace(bvh, rays, rays.size(), false);  // warm-up
    const Timed tree = trace(bvh, rays, rays.size(), false);
    const auto slice =
        std::max<std::size_t>(1, std::size_t(slice_tests / double(std::max<std::size_t>(1, bvh.triangle_count()))));
    const Timed all = trace(bvh, rays, slice, true);
    std::size_t differences = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) differences += !same(tree.hits[i], all.hits[i]);
    std::printf("%s on %s: %zu rays, %zu triangles\n", name.c_str(), device.info().name.c_str(), rays.size(),
                bvh.triangle_count());
    std::printf("  every triangle  %10.2f ms  %.3g tests, %.1f Gtests/s\n", all.milliseconds, tests,
                tests * 1e-6 / all.milliseconds);
    std::printf("  with the tree   %10.2f ms  %.0f times faster, %.1f Mrays/s\n", tree.milliseconds,
                all.milliseconds / tree.milliseconds, double(rays.size()) * 1e-3 / tree.milliseconds);
    std::printf("  hits that differ: %zu\n", differences);
    measure::Csv csv(csv_path, device, "scene,rays,triangles,brute_force_ms,tree_ms,differences");
    csv.row(name, rays.size(), bvh.triangle_count(), all.milliseconds, tree.milliseconds, differences);
    csv.write();
    return differences == 0 ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_brute_force: error: %s\n", error.what());
    return 1;
}
