// claray against Embree 3 in one process, on the same triangles and rays, taking turns: bench_peers [--device D]
// [--builder B] [--repeat N] [--width W --height H] [--threads T] [--kinds primary,...] [--quality medium|high]
// [--inside] [--fast-mode] [--embree-tree] [--builds] [--csv FILE] [SCENE...]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <optional>

#include "bench/peers/embree.hpp"
#include "bench/peers/rays.hpp"
#include "host/bvh/host_tree.hpp"

using namespace claray;
using measure::Packets;

namespace {

struct Options {
    std::string selector, csv_path;
    Bvh::Config bvh;
    unsigned width = 640, height = 480, threads = 2;
    int repeat = 9;
    bool builds = false, rays = true, fast_mode = false, cpu_time = false, embree_tree = false, inside = false;
    RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
    std::string kinds = "primary,shadow,bounce,random";
    std::vector<std::string> scenes = {"terrain:1000000"};
};

/// By the wall clock, or on a machine that others use too by the processor time of this process over its threads.
double milliseconds(const Options& options, const std::function<void()>& run) {
    const std::clock_t begin = std::clock();
    const auto start = std::chrono::steady_clock::now();
    run();
    if (options.cpu_time) return double(std::clock() - begin) * 1e3 / CLOCKS_PER_SEC / options.threads;
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Rays on which the two disagree: whether there is a hit, or where.
std::size_t differences(const std::vector<Hit>& ours, const measure::PeerHits& theirs) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        const bool hit = ours[i].primitive != CLARAY_MISS, peer_hit = theirs.primitive[i] != CLARAY_MISS;
        count += hit != peer_hit || (hit && std::fabs(ours[i].t - theirs.t[i]) > 1e-4f * ours[i].t);
    }
    return count;
}
std::size_t differences(const std::vector<std::uint8_t>& ours, const measure::PeerHits& theirs) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) count += (ours[i] != 0) != (theirs.primitive[i] != CLARAY_MISS);
    return count;
}

struct Runner {
    std::string name;
    std::function<double()> run;  // milliseconds
    std::function<std::size_t()> differences;
    std::vector<double> times;
};

/// Rays whose answers are not the same, bit for bit.
std::size_t differences(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(Hit)) != 0;
    return count;
}
std::size_t differences(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
    return count;
}

/// `on_embree_tree` may be empty.
void compare_rays(const std::string& scene, const std::string& kind, const std::vector<Ray>& rays, const Bvh& bvh,
                  const std::optional<Bvh>& on_embree_tree, const measure::EmbreeScene& peer, const Options& options,
                  measure::Csv& csv) {
    const bool any = kind == "shadow", coherent = kind == "primary" || any;
    Buffer<Ray> device_rays(bvh.device(), rays);
    Buffer<Hit> hits(bvh.device(), any ? 0 : rays.size());
    Buffer<std::uint8_t> occluded(bvh.device(), any ? rays.size() : 0);
    const auto trace = [&](const Bvh& tree, Buffer<Hit>& to_hits, Buffer<std::uint8_t>& to_occluded) {
        device_rays.write(
            rays);  // as Embree's rays, which a trace changes, are written anew: both are in the caches alike
        return milliseconds(options, [&] {
            any ? any_hit(tree, device_rays, to_occluded) : closest_hit(tree, device_rays, to_hits);
            tree.device().finish();
        });
    };
    const auto ours = [&] { return trace(bvh, hits, occluded); };
    ours();
    std::vector<Runner> runners = {{"claray", ours, [] { return std::size_t(0); }, {}}};
    Buffer<Hit> other_hits(bvh.device(), any ? 0 : rays.size());
    Buffer<std::uint8_t> other_occluded(bvh.device(), any ? rays.size() : 0);
    if (on_embree_tree)
        runners.push_back({"claray on its tree",
                           [&] { return trace(*on_embree_tree, other_hits, other_occluded); },
                           [&] {
                               return any ? differences(occluded.read(), other_occluded.read())
                                          : differences(hits.read(), other_hits.read());
                           },
                           {}});
    const std::string letter = any ? "o" : "i";
    std::vector<std::pair<std::string, Packets>> forms = {{letter + "1", Packets::one}};
    if (kind != "random") {
        forms.insert(forms.end(), {{letter + "8", Packets::eight}, {letter + "16", Packets::sixteen}});
        if (coherent) forms.emplace_back("NM", Packets::stream);
    }
    std::vector<std::unique_ptr<measure::EmbreeQuery>> queries;
    for (const auto& [form, packets] : forms) {
        queries.push_back(std::make_unique<measure::EmbreeQuery>(peer, rays, packets, any, coherent, options.threads));
        measure::EmbreeQuery* query = queries.back().get();
        runners.push_back({form,
                           [=, &options] { return query->run(options.cpu_time); },
                           [&, query] {
                               return any ? differences(occluded.read(), query->hits())
                                          : differences(hits.read(), query->hits());
                           },
                           {}});
    }
    for (int i = -1; i < options.repeat; ++i)
        for (Runner& runner : runners) {
            const double ms = runner.run();
            if (i >= 0) runner.times.push_back(ms);
        }
    const double our_ms = measure::median(runners[0].times);
    std::printf("  %-8s %8zu rays: claray %6.2f Mrays/s;", kind.c_str(), rays.size(),
                double(rays.size()) * 1e-3 / our_ms);
    for (const Runner& runner : runners) {
        const double ms = measure::median(runner.times);
        const std::size_t wrong = runner.differences();
        csv.row(scene, kind, runner.name, rays.size(), double(rays.size()) * 1e-3 / ms, ms / our_ms, wrong);
        if (runner.name != "claray")
            std::printf(" %s %6.2f (ratio %.2f, %zu differ)", runner.name.c_str(), double(rays.size()) * 1e-3 / ms,
                        ms / our_ms, wrong);
    }
    std::printf("\n");
    std::fflush(stdout);
}

void compare_builds(const std::string& scene, const std::vector<Mesh>& meshes, const Device& device,
                    const Options& options, measure::Csv& csv) {
    std::vector<Bvh> ours;
    std::vector<Runner> runners;
    const std::pair<const char*, Builder> builders[] = {{"claray fast", Builder::fast},
                                                        {"claray balanced", Builder::balanced}};
    for (const auto& [name, builder] : builders) {
        Bvh bvh = Bvh::build(device, meshes, {.builder = builder});
        runners.push_back({name,
                           [bvh, &device, &options]() mutable {
                               return milliseconds(options, [&] {
                                   bvh.rebuild();
                                   device.finish();
                               });
                           },
                           {},
                           {}});
    }
    const std::pair<const char*, RTCBuildQuality> qualities[] = {{"Embree low", RTC_BUILD_QUALITY_LOW},
                                                                 {"Embree medium", RTC_BUILD_QUALITY_MEDIUM},
                                                                 {"Embree high", RTC_BUILD_QUALITY_HIGH}};
    for (const auto& [name, quality] : qualities)
        runners.push_back({name,
                           [&, quality = quality] {
                               return measure::EmbreeScene(meshes, quality, true, options.threads).build_milliseconds();
                           },
                           {},
                           {}});
    for (int i = -1; i < options.repeat; ++i)
        for (Runner& runner : runners) {
            const double ms = runner.run();
            if (i >= 0) runner.times.push_back(ms);
        }
    std::size_t triangles = 0;
    for (const Mesh& mesh : meshes) triangles += mesh.triangles.size();
    for (const Runner& runner : runners) {
        const double ms = measure::median(runner.times);
        std::printf("  build    %-16s %9.2f ms, %6.2f Mtri/s\n", runner.name.c_str(), ms,
                    double(triangles) * 1e-3 / ms);
        csv.row(scene, "build", runner.name, triangles, double(triangles) * 1e-3 / ms,
                ms / measure::median(runners[0].times), 0);
    }
}

void compare_scene(const std::string& name, const Device& device, const Options& options, measure::Csv& csv) {
    Scene scene;
    scene.meshes = measure::load_meshes(name);
    std::printf("%s, %zu triangles\n", name.c_str(), triangle_count(scene));
    const std::string short_name = std::filesystem::path(name).stem().string();
    if (options.builds) compare_builds(short_name, scene.meshes, device, options, csv);
    if (!options.rays) return;
    const std::vector<measure::View> views =
        options.inside ? measure::views_from_inside(device, scene) : measure::three_views(name, scene);
    const measure::RaySets sets = measure::make_rays(device, scene, views, options.width, options.height);
    const Bvh bvh = Bvh::build(device, scene.meshes, options.bvh);
    const measure::EmbreeScene peer(scene.meshes, options.quality, !options.fast_mode, options.threads);
    std::optional<Bvh> on_embree_tree;
    if (options.embree_tree)
        on_embree_tree = bvh_of(device, scene.meshes, measure::embree_tree(scene.meshes, options.quality), options.bvh);
    for (const std::string kind : {"primary", "shadow", "bounce", "random"}) {
        if (options.kinds.find(kind) == std::string::npos) continue;
        const std::vector<Ray>& rays = kind == "primary"  ? sets.primary
                                       : kind == "shadow" ? sets.shadow
                                       : kind == "bounce" ? sets.bounce
                                                          : sets.mixed;
        compare_rays(short_name, kind, rays, bvh, on_embree_tree, peer, options, csv);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares claray with Embree 3 in one process");
    Options options;
    const std::map<std::string, RTCBuildQuality> qualities = {
        {"low", RTC_BUILD_QUALITY_LOW}, {"medium", RTC_BUILD_QUALITY_MEDIUM}, {"high", RTC_BUILD_QUALITY_HIGH}};
    app.add_option("--device", options.selector);
    measure::add_bvh_options(app, options.bvh);
    app.add_option("--repeat", options.repeat);
    app.add_option("--width", options.width);
    app.add_option("--height", options.height);
    app.add_option("--threads", options.threads, "threads of Embree");
    app.add_option("--kinds", options.kinds, "primary, shadow, bounce, random, separated by commas");
    app.add_option("--quality", options.quality, "Embree's tree")->transform(CLI::CheckedTransformer(qualities));
    app.add_flag("--inside", options.inside, "views from within, for interiors");
    app.add_flag("--fast-mode", options.fast_mode, "Embree without its robust mode: not watertight");
    app.add_flag("--cpu-time", options.cpu_time, "rays by processor time: for machines that others use too");
    app.add_flag("--embree-tree", options.embree_tree, "claray's kernels also on a tree by Embree's builder");
    app.add_flag("--builds", options.builds, "time builds too");
    app.add_flag("!--no-rays", options.rays, "builds only");
    app.add_option("--csv", options.csv_path);
    app.add_option("scenes", options.scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.selector);
    std::printf("%s, driver %s, against Embree %s %s, %u threads; medians of %d, by %s\n", device.info().name.c_str(),
                device.info().driver.c_str(), RTC_VERSION_STRING, options.fast_mode ? "fast" : "robust",
                options.threads, options.repeat, options.cpu_time ? "processor time" : "the wall clock");
    measure::Csv csv(options.csv_path, device,
                     "scene,kind,who,count,millions_per_second,claray_is_faster_by,differences");
    for (const std::string& name : options.scenes) compare_scene(name, device, options, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_peers: error: %s\n", error.what());
    return 1;
}
