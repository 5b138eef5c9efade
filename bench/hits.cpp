// Are all hits right? bench_hits [--device D] [--builder B] [--rays N] [--csv FILE] [SCENE...] compares N primary and N
// random rays with the float64 brute force of tests/oracle, and counts closest and any hits that differ. Exits 1 if any
// does.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/support.hpp"
#include "tests/oracle/brute_force.hpp"

using namespace claray;

int main(int argc, char** argv) try {
    CLI::App app("Compares hits with a float64 brute force");
    std::string selector, csv_path;
    std::vector<std::string> scenes = {"soup:10000"};
    std::size_t count = 1'000'000;
    Bvh::Config config;
    app.add_option("--device", selector);
    measure::add_bvh_options(app, config);
    app.add_option("--rays", count);
    app.add_option("--csv", csv_path);
    app.add_option("scenes", scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(selector);
    std::printf("%s, driver %s\n", device.info().name.c_str(), device.info().driver.c_str());
    measure::Csv csv(csv_path, device, "scene,rays,kind,layout,hits,ties,wrong,worst_t_ulp");
    std::size_t wrong = 0;
    for (const std::string& name : scenes) {
        Scene scene;
        scene.meshes = measure::load_meshes(name);
        const Bounds bounds = bounds_of(scene);
        const test::Oracle oracle(scene.meshes);
        const auto side = unsigned(std::ceil(std::sqrt(double(count)) / 8)) * 8;
        std::vector<Ray> primary = measure::primary_rays(automatic_camera(bounds), side, side, false);
        primary.resize(std::min(primary.size(), count));
        for (const auto& [kind, rays] :
             {std::pair("primary", std::move(primary)), std::pair("random", measure::random_rays(bounds, count))}) {
            const auto expected = oracle.closest_hits(rays);
            for (const Layout layout : {Layout::binary, Layout::wide}) {
                config.layout = layout;
                const Bvh bvh = Bvh::build(device, scene.meshes, config);
                test::HitComparison c = test::compare(closest_hit(bvh, rays), expected);
                const std::vector<std::uint8_t> occluded = any_hit(bvh, rays);
                std::size_t wrong_any = 0;
                for (std::size_t i = 0; i < rays.size(); ++i)
                    wrong_any += (occluded[i] != 0) != (expected[i].primitive != CLARAY_MISS);
                std::printf(
                    "%s, %s, %s: %zu rays, %zu hits, %zu ties, %zu wrong, %zu any hits wrong; t within %.3f ulp\n",
                    name.c_str(), kind, layout == Layout::binary ? "binary" : "wide", c.rays, c.hits, c.ties, c.wrong,
                    wrong_any, c.worst_t_ulp);
                c.wrong += wrong_any;
                csv.row(name, c.rays, kind, layout == Layout::binary ? "binary" : "wide", c.hits, c.ties, c.wrong,
                        c.worst_t_ulp);
                wrong += c.wrong;
            }
        }
    }
    csv.write();
    return wrong == 0 ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_hits: error: %s\n", error.what());
    return 1;
}
