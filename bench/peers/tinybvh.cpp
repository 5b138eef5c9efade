// claray against tinybvh's OpenCL kernels on one GPU, on the same triangles and rays, taking turns:
// bench_peers_tinybvh [--device D] [--builder B] [--repeat N] [--width W --height H] [--inside] [--kinds primary,...]
// [--peer-options TEXT] [--csv FILE] SCENE... The peer gets what it likes best: three trees by its builders on the host
// (surface area heuristic, spatial splits by 8 and by 32 bins), groups of 64 and of 128 rays, nodes of two children,
// its fastest on an H200, and rays of 32 instead of 64 bytes. claray gets its defaults, and in a second column the
// hints that its renderer gives. Medians of OpenCL event times. The last figure of a row compares the peer's speed for
// a prime number of rays with its speed for a multiple of 128: near 1, unless the driver divides the rays into groups.
#define TINYBVH_IMPLEMENTATION
#include "tiny_bvh.h"
// (its header comes first: it checks macros that others define)
#include <cmath>
#include <cstdio>

#include "bench/peers/rays.hpp"
#include "bench/peers/tinybvh_kernels.hpp"

using namespace claray;

namespace {

struct Options {
    std::string selector, csv_path, folder = CLARAY_TINYBVH_DIR, peer_options;
    Bvh::Config bvh;
    unsigned width = 1920, height = 1080;
    int repeat = 11;
    bool inside = false;
    std::string kinds = "primary,shadow,bounce";
    std::vector<std::string> scenes = {"terrain:1000000"};
};

/// One of its trees on the device.
struct PeerTree {
    std::string name;
    cl::Buffer nodes, indices, corners;
};

template <class T>
cl::Buffer upload(const Device& device, const T* data, std::size_t count) {
    return {device.context(), CL_MEM_READ_ONLY | CL_MEM_COPY_HOST_PTR, count * sizeof(T), const_cast<T*>(data)};
}

std::vector<PeerTree> peer_trees(const Device& device, const std::vector<Mesh>& meshes) {
    std::vector<tinybvh::bvhvec4> corners;
    for (const Mesh& mesh : meshes)
        for (const glm::uvec3& t : mesh.triangles)
            for (int k = 0; k < 3; ++k) {
                const glm::vec3& p = mesh.positions[t[k]];
                corners.emplace_back(p.x, p.y, p.z, 0.f);
            }
    const auto make = [&](const char* name, unsigned bins) {
        tinybvh::BVH tree;
        if (bins) tree.hqbvhbins = bins;
        const auto count = std::uint32_t(corners.size() / 3);
        bins ? tree.BuildHQ(corners.data(), count) : tree.Build(corners.data(), count);
        tinybvh::BVH_GPU form;
        form.ConvertFrom(tree);
        return PeerTree{name, upload(device, form.bvhNode, form.usedNodes), upload(device, tree.primIdx, tree.idxCount),
                        upload(device, corners.data(), corners.size())};
    };
    return {make("SAH", 0), make("SBVH, 8 bins", 8), make("SBVH, 32 bins", 32)};
}

struct Runner {
    std::string name;
    std::function<void()> run;
    std::function<std::size_t()> differences;
    cl::Kernel kernel;  // the peer's
    std::size_t group;
};

/// Rays on which the two disagree: whether there is a hit, or where.
std::size_t differences(const std::vector<Hit>& ours, const std::vector<glm::vec4>& theirs, std::span<const Ray> rays) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        const bool hit = ours[i].primitive != CLARAY_MISS, peer_hit = theirs[i].x < rays[i].tmax;
        count += hit != peer_hit || (hit && std::fabs(ours[i].t - theirs[i].x) > 1e-3f * ours[i].t);
    }
    return count;
}

/// The same for any hit.
std::size_t differences(const std::vector<std::uint8_t>& ours, const std::vector<std::uint8_t>& theirs) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) count += (ours[i] != 0) != (theirs[i] != 0);
    return count;
}

/// Mrays/s of a scene and a kind of ray, and claray's speed over the peer's best, without and with hints.
struct Cell {
    std::string scene, kind;
    double mrays, ratio, ratio_with_hints, prime_over_even;
};

double mrays(std::size_t rays, double milliseconds) { return double(rays) * 1e-3 / milliseconds; }

/// The peer's speed for a prime number of the rays over its speed for a multiple of 128.
double prime_over_even(const Device& device, const cl::Kernel& kernel, std::size_t group, std::size_t rays,
                       int repeat) {
    const std::size_t prime = measure::prime_up_to(std::max<std::size_t>(rays, 2)), even = rays / 128 * 128;
    if (even == 0) return 1;
    const auto start = [&](std::size_t count) {
        return [&, count] { measure::start_tinybvh(device, kernel, count, group); };
    };
    const auto timings = measure::measure_rounds(device, repeat, {start(prime), start(even)});
    return mrays(prime, timings[0].milliseconds()) / mrays(even, timings[1].milliseconds());
}

/// Both ask for the same rays; the results stay on the device until `differences` reads them.
Cell compare_rays(const std::string& scene, const std::string& kind, const std::vector<Ray>& rays, const Bvh& bvh,
                  const std::vector<PeerTree>& trees, const cl::Program& program, const Options& options,
                  measure::Csv& csv) {
    const Device& device = bvh.device();
    const bool any = kind == "shadow";
    const Buffer<Ray> device_rays(device, rays);
    Buffer<Hit> hits(device, any ? 0 : rays.size());
    Buffer<std::uint8_t> occluded(device, any ? rays.size() : 0);
    const auto ours = [&](Coherence coherence) {
        QueryOptions query;
        query.coherence = coherence;
        any ? any_hit(bvh, device_rays, occluded, query) : closest_hit(bvh, device_rays, hits, query);
    };
    const auto none = [] { return std::size_t(0); };
    std::vector<Runner> runners = {{"claray", [&] { ours(Coherence::automatic); }, none, {}, 0},
                                   {"claray with hints",
                                    [&] { ours(kind == "primary" ? Coherence::coherent : Coherence::incoherent); },
                                    none,
                                    {},
                                    0}};
    const Buffer<glm::vec4> peer_hits(device, hits.size());
    const Buffer<std::uint8_t> peer_occluded(device, occluded.size());
    const auto peer_differences = [&] {
        return any ? differences(occluded.read(), peer_occluded.read())
                   : differences(hits.read(), peer_hits.read(), rays);
    };
    for (const PeerTree& tree : trees) {
        cl::Kernel kernel(program, any ? "occlusion" : "closest");
        kernel.setArg(0, tree.nodes), kernel.setArg(1, tree.indices), kernel.setArg(2, tree.corners);
        kernel.setArg(3, device_rays.memory()), kernel.setArg(5, any ? peer_occluded.memory() : peer_hits.memory());
        for (const std::size_t group : {64, 128})
            runners.push_back({tree.name + ", groups of " + std::to_string(group),
                               [&, kernel, group] { measure::start_tinybvh(device, kernel, rays.size(), group); },
                               peer_differences, kernel, group});
    }
    std::vector<std::function<void()>> tasks;
    for (const Runner& runner : runners) tasks.push_back(runner.run);
    std::vector<double> ms;
    for (const measure::Timing& timing : measure::measure_rounds(device, options.repeat, tasks))
        ms.push_back(timing.milliseconds());
    const std::size_t best = std::size_t(std::min_element(ms.begin() + 2, ms.end()) - ms.begin());
    std::printf("  %-8s %8zu rays:", kind.c_str(), rays.size());
    for (std::size_t i = 0; i < runners.size(); ++i) {
        runners[i].run();
        device.finish();
        const std::size_t wrong = runners[i].differences();
        csv.row(scene, kind, '"' + runners[i].name + '"', rays.size(), mrays(rays.size(), ms[i]), ms[best] / ms[i],
                wrong);
        std::printf(" %s %.0f", runners[i].name.c_str(), mrays(rays.size(), ms[i]));
        if (i < 2)
            std::printf(" (%.2f of its best);", ms[best] / ms[i]);
        else
            std::printf(" (%zu differ);", wrong);
    }
    const double check =
        prime_over_even(device, runners[best].kernel, runners[best].group, rays.size(), options.repeat);
    std::printf(" its best for a prime number of rays over a multiple of 128: %.2f\n", check);
    std::fflush(stdout);
    return {scene, kind, mrays(rays.size(), ms[0]), ms[best] / ms[0], ms[best] / ms[1], check};
}

/// As docs/performance.md has it.
void print_table(const std::vector<Cell>& cells) {
    double least = 1, most = 1;
    std::string scene;
    for (const Cell& cell : cells) {
        if (cell.scene != scene) std::printf("%s| %s", scene.empty() ? "\n" : " |\n", cell.scene.c_str());
        scene = cell.scene;
        std::printf(" | %s %.0f (%.2f, %.2f)", cell.kind.c_str(), cell.mrays, cell.ratio, cell.ratio_with_hints);
        least = std::min(least, cell.prime_over_even), most = std::max(most, cell.prime_over_even);
    }
    std::printf(
        " |\nMrays/s (over the peer's best without and with hints); the peer's speed for a prime number of rays over "
        "a multiple of 128: %.2f to %.2f\n",
        least, most);
}

std::vector<Cell> compare_scene(const std::string& name, const Device& device, const cl::Program& program,
                                const Options& options, measure::Csv& csv) {
    Scene scene;
    scene.meshes = measure::load_meshes(name);
    std::printf("%s%s, %zu triangles; Mrays/s\n", name.c_str(), options.inside ? ", inside" : "",
                triangle_count(scene));
    const std::filesystem::path recorded = std::filesystem::path(name).replace_extension(".ray");
    const std::vector<measure::View> views =
        options.inside ? measure::views_from_inside(device, scene) : measure::three_views(name, scene);
    const measure::RaySets sets = std::filesystem::exists(recorded)
                                      ? measure::read_rays(recorded)
                                      : measure::make_rays(device, scene, views, options.width, options.height, true);
    const Bvh bvh = Bvh::build(device, scene.meshes, options.bvh);
    const std::vector<PeerTree> trees = peer_trees(device, scene.meshes);
    const std::string short_name = std::filesystem::path(name).stem().string() + (options.inside ? " inside" : "");
    const std::pair<std::string, const std::vector<Ray>*> kinds[] = {
        {"primary", &sets.primary}, {"shadow", &sets.shadow}, {"bounce", &sets.bounce}};
    std::vector<Cell> cells;
    for (const auto& [kind, rays] : kinds)
        if (options.kinds.find(kind) != std::string::npos && !rays->empty())
            cells.push_back(compare_rays(short_name, kind, *rays, bvh, trees, program, options, csv));
    return cells;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares claray with tinybvh's OpenCL kernels in one process");
    Options options;
    app.add_option("--device", options.selector);
    measure::add_bvh_options(app, options.bvh);
    app.add_option("--repeat", options.repeat);
    app.add_option("--width", options.width, "of each of three views");
    app.add_option("--height", options.height);
    app.add_flag("--inside", options.inside, "views from within, for interiors");
    app.add_option("--kinds", options.kinds, "primary, shadow, bounce, separated by commas");
    app.add_option("--tinybvh", options.folder, "folder of its kernels");
    app.add_option("--peer-options", options.peer_options,
                   "for its compiler; its host adds -cl-nv-opt-level=9 on NVIDIA's devices");
    app.add_option("--csv", options.csv_path);
    app.add_option("scenes", options.scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.selector);
    std::printf("%s, driver %s; medians of %d by OpenCL events\n", device.info().name.c_str(),
                device.info().driver.c_str(), options.repeat);
    const cl::Program program = measure::build_tinybvh(device, options.folder, options.peer_options);
    measure::Csv csv(options.csv_path, device, "scene,kind,who,count,mrays_per_second,over_best_peer,differences");
    std::vector<Cell> cells;
    for (const std::string& name : options.scenes)
        for (Cell& cell : compare_scene(name, device, program, options, csv)) cells.push_back(std::move(cell));
    print_table(cells);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_peers_tinybvh: error: %s\n", error.what());
    return 1;
}
