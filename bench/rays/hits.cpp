// Are all hits right? bench_hits [--device D] [--builder B] [--rays N] [--csv FILE] [SCENE...] compares N primary and N
// random rays with a float64 oracle that skips triangles by padded boxes, and counts closest and any hits that differ.
// Of these rays --brute-force M, evenly spread, are compared with the oracle that tests all triangles. Exits 1 if any
// differs.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/support.hpp"
#include "host/verify/boxed_oracle.hpp"
#include "tests/oracle/brute_force.hpp"

using namespace claray;

namespace {

/// Compares `count` rays, evenly spread, with all triangles; returns how many of the boxed oracle's answers are wrong.
std::size_t check_boxes(const test::Oracle& oracle, const std::vector<Ray>& rays,
                        const std::vector<test::OracleHit>& boxed, std::size_t count) {
    std::vector<Ray> some;
    std::vector<std::size_t> which;
    for (std::size_t k = 0; k < std::min(count, rays.size()); ++k) {
        which.push_back(k * rays.size() / std::min(count, rays.size()));
        some.push_back(rays[which.back()]);
    }
    const std::vector<test::OracleHit> all = oracle.closest_hits(some);
    std::size_t wrong = 0;
    for (std::size_t k = 0; k < some.size(); ++k) {
        const test::OracleHit& hit = boxed[which[k]];
        const bool is_hit = hit.primitive != CLARAY_MISS;
        wrong += is_hit != (all[k].primitive != CLARAY_MISS) || (is_hit && hit.t != all[k].t);
    }
    return wrong;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares hits with a float64 oracle");
    std::string selector, csv_path;
    std::vector<std::string> scenes = {"soup:10000"};
    std::size_t count = 1'000'000, brute_force = 1'000;
    Bvh::Config config;
    app.add_option("--device", selector);
    measure::add_bvh_options(app, config);
    app.add_option("--rays", count);
    app.add_option("--brute-force", brute_force, "rays of each kind that are also tested against all triangles");
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
        const verify::BoxedOracle boxed(scene.meshes);
        const auto side = unsigned(std::ceil(std::sqrt(double(count)) / 8)) * 8;
        std::vector<Ray> primary = measure::primary_rays(automatic_camera(bounds), side, side, false);
        primary.resize(std::min(primary.size(), count));
        for (const auto& [kind, rays] :
             {std::pair("primary", std::move(primary)), std::pair("random", measure::random_rays(bounds, count))}) {
            const auto expected = boxed.closest_hits(rays);
            const std::size_t wrong_boxes = check_boxes(oracle, rays, expected, brute_force);
            std::printf("%s, %s: of %zu rays tested against all triangles %zu have another answer by boxes\n",
                        name.c_str(), kind, std::min(brute_force, rays.size()), wrong_boxes);
            wrong += wrong_boxes;
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
