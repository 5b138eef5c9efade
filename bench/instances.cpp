// A field of instances: bench_instances [--device D] [--instances N,...] [--builder fast|balanced] [--bits 30|63]
// [--layout binary|wide] [--bottom-builder fast|balanced] [--repeat N] [--csv FILE] [SCENE...] times the top level's
// rebuild and refit, and rays. Every scene becomes one bottom level.
#include <cmath>
#include <cstdio>
#include <glm/gtc/matrix_transform.hpp>

#include "bench/support.hpp"
#include "claray/instances.hpp"
#include "host/bvh/bvh_state.hpp"

using namespace claray;

namespace {

struct Options {
    std::string selector;
    Bvh::Config bottom;
    InstancedBvh::Config top;
    std::vector<std::size_t> counts = {1'000, 1'000'000};
    unsigned width = 1920, height = 1080;
    int repeat = 5;
};

/// A square field of unit cells, an instance a cell, turned about the vertical and of different sizes.
std::vector<Instance> field(const Bounds& bounds, std::size_t count) {
    const auto side = std::size_t(std::ceil(std::sqrt(double(count))));
    const glm::vec3 extent = bounds.extent();
    const float fit = 1.f / std::max({extent.x, extent.y, extent.z});
    std::vector<Instance> instances;
    instances.reserve(count);
    std::uint32_t state = 1;
    const auto uniform = [&] { return float((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f; };
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 cell(float(i % side) + 0.4f * uniform(), 0.f, float(i / side) + 0.4f * uniform());
        glm::mat4 m = glm::translate(glm::mat4(1.f), cell);
        m = glm::rotate(m, 6.2831853f * uniform(), glm::vec3(0, 1, 0));
        m = glm::scale(m, glm::vec3(fit * (0.5f + 0.5f * uniform())));
        m = glm::translate(m, glm::vec3(-bounds.center().x, -bounds.lo.y, -bounds.center().z));
        instances.push_back(make_instance(m));
    }
    return instances;
}

/// Over the field from a corner, as a person on a hill would look.
Camera over_field(std::size_t count) {
    const float side = std::ceil(std::sqrt(float(count)));
    Camera camera;
    camera.position = glm::vec3(-0.05f * side, 0.02f * side + 3.f, -0.05f * side);
    camera.target = glm::vec3(0.4f * side, 0.f, 0.4f * side);
    return camera;
}

void report(const Device& device, const std::string& name, std::size_t count, const Options& options,
            measure::Csv& csv) {
    Scene scene;
    scene.meshes = measure::load_meshes(name);
    const Bvh bottom = Bvh::build(device, scene.meshes, options.bottom);
    const std::vector<Instance> instances = field(bounds_of(scene), count);
    InstancedBvh bvh = InstancedBvh::build(std::span(&bottom, 1), instances, options.top);
    const BvhHeader top = state_of(bvh.top()).read_header();
    const Bounds world{{top.lox, top.loy, top.loz}, {top.hix, top.hiy, top.hiz}};

    const std::size_t rays = std::size_t(options.width) * options.height;
    const Buffer<Ray> primary(device, measure::primary_rays(over_field(count), options.width, options.height, false));
    const Buffer<Ray> random(device, measure::random_rays(world, rays));
    Buffer<InstanceHit> hits(device, rays);
    Buffer<std::uint8_t> occluded(device, rays);
    const std::vector<measure::Timing> times =
        measure::measure_rounds(device, options.repeat,
                                {[&] { bvh.refit(); }, [&] { bvh.rebuild(); }, [&] { closest_hit(bvh, primary, hits); },
                                 [&] { closest_hit(bvh, random, hits); }, [&] { any_hit(bvh, random, occluded); }});
    const auto mrays = [&](std::size_t i) { return double(rays) * 1e-3 / times[i].milliseconds(); };
    const double rebuild = times[1].milliseconds(), refit = times[0].milliseconds();
    const InstanceStatistics s = bvh.statistics();
    std::printf(
        "%s: %u instances of %u triangles: top level %.3f ms (with pauses %.3f), %.1f Minstances/s; refit %.3f ms;\n"
        "    primary %.3g, random %.3g, random any hit %.3g Mrays/s; top %.1f MB, bottom %.1f MB; %s\n",
        name.c_str(), s.instances, state_of(bottom).read_header().valid, rebuild, times[1].span(),
        double(s.instances) * 1e-3 / rebuild, refit, mrays(2), mrays(3), mrays(4), double(s.top_bytes) * 1e-6,
        double(s.bottom_bytes) * 1e-6, bvh.validate().ok() ? "valid" : "INVALID");
    for (const auto& [stage, ms] : times[1].commands) std::printf("    %-24s %8.3f ms\n", stage.c_str(), ms);
    csv.row(name, state_of(bottom).read_header().valid, s.instances, options.top.morton_bits, rebuild, refit, mrays(2),
            mrays(3), mrays(4), s.top_bytes, s.bottom_bytes);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times fields of instances");
    Options options;
    std::string csv_path;
    std::vector<std::string> scenes = {"soup:2000"};
    app.add_option("--device", options.selector);
    app.add_option("--instances", options.counts)->delimiter(',');
    app.add_option("--builder", options.top.builder)->transform(CLI::CheckedTransformer(measure::builders));
    app.add_option("--bits", options.top.morton_bits);
    app.add_option("--bottom-builder", options.bottom.builder)->transform(CLI::CheckedTransformer(measure::builders));
    app.add_option("--layout", options.bottom.layout)->transform(CLI::CheckedTransformer(measure::layouts));
    app.add_option("--width", options.width);
    app.add_option("--height", options.height);
    app.add_option("--repeat", options.repeat);
    app.add_option("--csv", csv_path);
    app.add_option("scenes", scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.selector);
    std::printf("%s, driver %s; medians of %d by OpenCL events\n", device.info().name.c_str(),
                device.info().driver.c_str(), options.repeat);
    measure::Csv csv(csv_path, device,
                     "scene,triangles,instances,bits,rebuild_ms,refit_ms,primary_mrays,random_mrays,random_any_mrays,"
                     "top_bytes,bottom_bytes");
    for (const std::string& name : scenes)
        for (const std::size_t count : options.counts) report(device, name, count, options, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_instances: error: %s\n", error.what());
    return 1;
}
