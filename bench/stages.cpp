// The time of every kernel of the pipeline, by its name: bench_stages [--device D] [--triangles N] [--side PIXELS]
// [--rounds N] [--queries] [--csv FILE]. Everything runs by the schedule of CPUs and by that of GPUs, whatever the
// device, so that each kernel has a row (tests/docs/house looks for them in bench/results).
#include <cstdio>

#include "bench/support.hpp"
#include "claray/instances.hpp"
#include "claray/shared/texture.h"
#include "host/bvh/bvh_state.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv;
    unsigned triangles = 100'000, side = 256;
    int rounds = 9;
    bool queries = false;
};

using Task = std::function<void()>;

/// A device that builds, traces and renders as CPUs do, or as GPUs do.
Device with_schedule(const std::string& selector, bool of_cpus) {
    const Device device = Device::open(selector);
    device.set_tuning("bvh/serial", "RANGES_PER_UNIT", of_cpus ? 16 : 0);
    device.set_tuning("sort/radix_sort", "ONESWEEP", of_cpus ? 0 : 1);
    for (const char* query : {"trace/closest_hit", "trace/any_hit"}) {
        if (!of_cpus) device.set_tuning(query, "BATCH", 0);  // a batch needs more private memory than GPUs have
        device.set_tuning(query, "RAY_QUEUE", of_cpus ? 0 : 1);
        device.set_tuning(query, "GROUP_SIZE", of_cpus ? 1 : 64);
    }
    device.set_tuning("render/add_light", "WITH_SHADOW_RAYS", of_cpus ? 0 : 1);
    device.set_tuning("render/trace_paths", "MOST_EFFECTS", of_cpus ? 0 : 64);
    device.set_tuning("render/trace_paths", "PATIENCE_MILLISECONDS", 0);
    device.set_tuning("render/finish_paths", "MOST_PATHS_PER_UNIT", 4096);
    device.set_tuning("render/path_guide", "LEAST_GAIN_PERCENT", of_cpus ? 1 : 0);
    return device;
}

std::vector<Task> builds(const Device& device, const std::vector<Mesh>& meshes, Layout layout) {
    std::vector<Task> tasks;
    for (const BuilderTraits& traits : builders)
        tasks.emplace_back([bvh = Bvh::build(device, meshes, {.builder = traits.builder, .layout = layout})]() mutable {
            bvh.rebuild();
            bvh.refit();
            (void)bvh.cost_growth();
            (void)bvh.validate();
        });
    return tasks;
}

/// A store of textures in which no triangle is cut out.
Buffer<std::uint32_t> no_cutouts(const Device& device, std::size_t triangles) {
    constexpr std::size_t header_words = sizeof(TextureStore) / sizeof(std::uint32_t);
    std::vector<std::uint32_t> words(header_words + triangles, CLARAY_NO_MAP);
    words[offsetof(TextureStore, cutouts) / sizeof(std::uint32_t)] = header_words;
    return {device, words};
}

std::vector<Task> queries(const Device& device, const std::vector<Mesh>& meshes, unsigned side, Layout layout) {
    const Bvh bvh = Bvh::build(device, meshes, {.layout = layout, .learns = false});
    const std::vector<Ray> random = measure::random_rays(bounds_of(meshes[0]), std::size_t(side) * side);
    const Buffer<Ray> rays(device, random), few(device, std::span(random).first(64));
    Bvh with_cutouts = Bvh::build(device, meshes, {.layout = layout});
    state_of(with_cutouts).set_cutouts(no_cutouts(device, bvh.triangle_count()));
    Instance instance = make_instance(glm::mat4(1.f), 0);
    InstancedBvh instances = InstancedBvh::build({&bvh, 1}, {&instance, 1});
    const auto all = [=](const auto& structure, const Buffer<Ray>& of, auto hits, const QueryOptions& options) {
        Buffer<std::uint8_t> occluded(device, of.size());
        closest_hit(structure, of, hits, options);
        any_hit(structure, of, occluded, options);
    };
    return {[=] { all(bvh, rays, Buffer<Hit>(device, rays.size()), {}); },
            [=] { all(with_cutouts, rays, Buffer<Hit>(device, rays.size()), {}); },
            [=] { all(bvh, few, Buffer<Hit>(device, few.size()), {.brute_force = true}); },
            [=]() mutable {
                instances.rebuild();
                all(instances, rays, Buffer<InstanceHit>(device, rays.size()), {});
            }};
}

/// All hits of rays, and queries by points, boxes and spheres, on a tree that splits triangles and one that does not.
std::vector<Task> other_queries(const Device& device, const std::vector<Mesh>& meshes, unsigned side, Layout layout) {
    const std::size_t count = std::size_t(side) * side;
    const Buffer<Ray> rays(device, measure::random_rays(bounds_of(meshes[0]), count));
    std::vector<float> numbers(12 * count);
    measure::Pcg random;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = random.uniform() * (i % 4 == 3 ? 0.02f : 1.f);  // radii
    const Buffer<float> points(device, std::span(numbers).first(3 * count)),
        spheres(device, std::span(numbers).first(400)), boxes(device, std::span(numbers).first(600)),
        centers(device, std::span(numbers).first(4 * count));
    const auto ask = [=](const Bvh& bvh) {
        Buffer<NearestPoint> nearest(device, count);
        Buffer<std::uint8_t> answers(device, count);
        Buffer<float> distances(device, count);
        Buffer<Hit> hits(device, 4 * count);
        Buffer<std::uint32_t> counts(device, count);
        inside(bvh, points, answers);
        signed_distance(bvh, points, distances);
        nearest_hits(bvh, rays, 4, hits, counts);
        (void)all_hits(bvh, rays);
        (void)box_overlaps(bvh, boxes);
        (void)sphere_overlaps(bvh, spheres);
        QueryOptions options;
        options.filter = geometry_range(device, 0, 1);
        closest_hit(bvh, rays, hits, options);
        any_hit(bvh, rays, answers, options);
    };
    const Bvh whole = Bvh::build(device, meshes, {.layout = layout, .learns = false});
    const Bvh split = Bvh::build(device, meshes, {.builder = Builder::high, .layout = layout});
    Primitives balls = Primitives::build(device, sphere_kind(), centers, std::uint32_t(centers.size() / 4));
    return {[=] { ask(whole); }, [=] { ask(split); },
            [=]() mutable {
                Buffer<Hit> hits(device, count);
                Buffer<std::uint8_t> answers(device, count);
                balls.rebuild();
                closest_hit(balls, rays, hits);
                any_hit(balls, rays, answers);
            }};
}

/// A scene by stages, by whole paths or with the last paths by one kernel; with an estimate of its error and its AOVs.
Task render(const Device& device, const std::string& name, unsigned side, Layout layout, bool whole_paths,
            unsigned parts = 1, unsigned spp = 16) {
    RenderConfig config{.width = side, .height = side, .spp = spp, .error = 1e-6};
    config.bvh.layout = layout, config.parts = parts;
    auto renderer = std::make_shared<Renderer>(device, *builtin_scene(name), config);
    return [device, renderer, whole_paths] {
        device.set_tuning("render/trace_paths", "MOST_BOUNCES_PERMILLE", whole_paths ? 100'000 : 0);
        renderer->restart(0);
        (void)renderer->render();
        (void)renderer->picture();
        (void)renderer->denoised(DenoiserKind::claray);
        (void)renderer->aovs();
    };
}

/// An image with alpha, and a shadow catcher.
Task with_alpha(const Device& device, unsigned side) {
    Scene scene = *builtin_scene("cornell");
    scene.materials[0].role = MaterialRole::shadow_catcher;
    const RenderConfig config{.width = side, .height = side, .spp = 4, .alpha = true};
    auto renderer = std::make_shared<Renderer>(device, scene, config);
    return [renderer] {
        renderer->restart(0);
        (void)renderer->render();
        (void)renderer->alpha();
    };
}

/// Layers of light.
Task layers(const Device& device, unsigned side, Layout layout) {
    RenderConfig config{.width = side, .height = side, .spp = 16, .lobes = true};
    config.bvh.layout = layout;
    return [renderer = std::make_shared<Renderer>(device, *builtin_scene("crate"), config)] {
        renderer->restart(0);
        (void)renderer->render();
    };
}

/// Deferred shading: sums over tiles, and the G-buffer.
Task deferred(const Device& device, unsigned side) {
    Scene scene = *builtin_scene("spheres");
    for (int i = 0; i < 100; ++i) {
        scene.lights.push_back(
            point_light({0.1f * float(i % 10) - 0.5f, 1.f, 0.1f * float(i / 10) - 0.5f}, glm::vec3(1)));
        scene.lights.back().range = 1.f;
    }
    const RenderConfig config{.width = side, .height = side, .spp = 1, .approximate = {.tile_sum = true}};
    return [renderer = std::make_shared<Renderer>(device, scene, config)] {
        renderer->restart(0);
        (void)renderer->render();
        (void)renderer->gbuffer();
    };
}

/// A light grid of probes, and one of voxels, that are filled anew.
std::vector<Task> light_grids(const Device& device) {
    std::vector<Task> tasks;
    for (const bool voxels : {false, true}) {
        const RenderConfig config{
            .width = 64, .height = 64, .spp = 1, .approximate = {.light_grid = true}, .light_grid = {.voxels = voxels}};
        const Scene scene = *builtin_scene("cornell");
        tasks.push_back([scene, voxels, renderer = std::make_shared<Renderer>(device, scene, config)] {
            renderer->update(scene, {.vertices = true});
            (void)renderer->render();
            if (voxels) (void)renderer->voxels();
        });
    }
    return tasks;
}

Task bake(const Device& device) {
    Scene scene = *builtin_scene("cornell");
    Mesh square{.positions = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, .triangles = {{0, 2, 1}, {0, 3, 2}}};
    square.uvs1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    scene.meshes = {square};
    return [device, scene] { (void)bake_light_map(device, scene, 0, {.width = 64, .height = 64, .spp = 16}); };
}

std::vector<Task> tasks_of(const Device& device, const Options& options, Layout layout) {
    const std::vector<Mesh> meshes = measure::load_meshes("soup:" + std::to_string(options.triangles));
    if (options.queries) return other_queries(device, meshes, options.side, layout);
    std::vector<Task> tasks = builds(device, meshes, layout);
    const std::vector<Task> traces = queries(device, meshes, options.side, layout);
    tasks.insert(tasks.end(), traces.begin(), traces.end());
    const std::vector<Task> others = other_queries(device, meshes, options.side, layout);
    tasks.insert(tasks.end(), others.begin(), others.end());
    for (const bool whole_paths : {true, false})
        for (const char* scene : {"crate", "effect:cut-outs"})
            tasks.push_back(render(device, scene, options.side, layout, whole_paths));
    tasks.push_back(render(device, "crate", options.side, layout, false, 4));
    tasks.push_back(render(device, "cornell", options.side, layout, false, 1, 32));  // enough to guide paths
    tasks.push_back(layers(device, options.side, layout));
    tasks.push_back(deferred(device, options.side));
    tasks.push_back(with_alpha(device, options.side));
    tasks.push_back(bake(device));
    for (const Task& task : light_grids(device)) tasks.push_back(task);
    return tasks;
}

void report(const Options& options, bool of_cpus, measure::Csv& csv) {
    const Device device = with_schedule(options.device, of_cpus);
    const char* const schedule = of_cpus ? "cpu" : "gpu";
    const std::vector<Task> tasks = tasks_of(device, options, of_cpus ? Layout::wide : Layout::binary);
    std::map<std::string, double> longest;  // of all tasks, for each kernel
    for (const measure::Timing& timing : measure::measure_rounds(device, options.rounds, tasks))
        for (const auto& [kernel, milliseconds] : timing.commands)
            longest[kernel] = std::max(longest[kernel], milliseconds);
    for (const auto& [kernel, milliseconds] : longest) {
        std::printf("%-5s %-28s %10.3f ms\n", schedule, kernel.c_str(), milliseconds);
        csv.row(schedule, kernel, milliseconds);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times every kernel of the pipeline");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--triangles", options.triangles, "of the trees [100000]");
    app.add_option("--side", options.side, "pixels along each side of an image [256]");
    app.add_option("--rounds", options.rounds);
    app.add_flag("--queries", options.queries, "only points, lists of hits, overlaps and primitives");
    app.add_option("--csv", options.csv);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.device);
    measure::Csv csv(options.csv, device, "schedule,kernel,milliseconds");
    for (const bool of_cpus : {true, false}) report(options, of_cpus, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_stages: error: %s\n", error.what());
    return 1;
}
