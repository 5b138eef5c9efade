// How far each stage is from the hardware: bench_roofline [--device D] [--repeat N] [--csv FILE] [SCENE...]
//
// The device's bandwidth (a copy, bytes read and written) and its rate of fused multiply-adds are measured first. For
// each stage follow the bytes that it can't avoid to move, the time that they take at that bandwidth, its floor, and
// the share of the floor in its time. For rays: the bytes of the nodes and triangles that they visit, wherever the
// caches serve them from, and arithmetic against the measured rate.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "bench/support.hpp"
#include "host/measure/rays.hpp"

using namespace claray;

namespace {

const char* const device_source = R"(
kernel void copy(global const float4* from, global float4* to, uint count) {
    const uint i = get_global_id(0);
    if (i < count) to[i] = from[i];
}
kernel void multiply_add(global float* out, float a, float b) {
    float8 x = (float8)(get_global_id(0)), y = x + 1.0f, z = x + 2.0f, w = x + 3.0f;
    for (int i = 0; i < 256; ++i) x = fma(x, a, b), y = fma(y, a, b), z = fma(z, a, b), w = fma(w, a, b);
    const float8 sum = x + y + z + w;
    out[get_global_id(0)] = sum.s0 + sum.s1 + sum.s2 + sum.s3 + sum.s4 + sum.s5 + sum.s6 + sum.s7;
}
)";
constexpr double operations_an_item = 256.0 * 32 * 2;

struct Ceilings {
    double gigabytes_per_second, gigaflops;
};

Ceilings measure_ceilings(const Device& device, int repeat) {
    const auto bytes = std::size_t(std::min<std::uint64_t>(device.info().max_allocation, 1u << 30) / 4);
    const std::size_t vectors = bytes / 16;
    Buffer<float> from(device, vectors * 4), to(device, vectors * 4);
    from.fill(0), to.fill(0);
    Kernel copy = compile_kernel(device, device_source, "copy");
    const double copy_ms = measure::measure(device, repeat, [&] {
                               copy.run({vectors, 256}, from, to, std::uint32_t(vectors));
                           }).at("");
    const bool cpu = device.info().type == DeviceType::cpu;
    const std::size_t items = std::size_t(device.info().compute_units) * (cpu ? 4096 : 32768);
    Buffer<float> out(device, items);
    Kernel multiply_add = compile_kernel(device, device_source, "multiply_add");
    const double fma_ms = measure::measure(device, repeat, [&] {
                              multiply_add.run({items, 64}, out, 0.5f, 1.f);
                          }).at("");
    return {2 * 16e-6 * double(vectors) / copy_ms, operations_an_item * 1e-6 * double(items) / fma_ms};
}

/// Bytes a triangle that a stage of the build must at least read and write on a GPU, with 64-bit keys; nothing where
/// there is no such model. A vertex counts once for every triangle where triangles come in the order of the leaves.
double least_bytes(const std::string& stage, double vertices_a_triangle) {
    const double in_order = 12 + 12 * vertices_a_triangle, gathered = 4 + 12 + 36, leaf = 48, node = 64, code = 8;
    if (stage == "compute_bounds") return in_order;
    if (stage == "compute_morton_codes") return in_order + code;
    if (stage == "count_all_digits") return code;
    if (stage == "sort_digit") return 8 * 2 * (code + 4) - 4;  // the first of eight passes reads no values
    if (stage == "build_lbvh") return gathered + code + leaf + node;
    if (stage == "build_hploc") return gathered + leaf + code + node + 4;
    if (stage == "refit_nodes") return in_order + 2 * leaf + 2 * node;
    return 0;
}

void report_build(const Device& device, const std::string& scene, const std::vector<Mesh>& meshes, Bvh::Config config,
                  const Ceilings& ceilings, int repeat, measure::Csv& csv) {
    Bvh bvh = Bvh::build(device, meshes, config);
    auto stages = measure::measure(device, repeat, [&] { bvh.rebuild(); });
    stages["refit_nodes"] = measure::measure(device, repeat, [&] { bvh.refit(); }).at("refit_nodes");
    const double triangles = double(bvh.triangle_count());
    const double vertices = double(bvh.triangles().positions.size()) / 3;
    const std::string preset = measure::name_of(measure::builders, config.builder);
    for (const auto& [stage, ms] : stages) {
        const double bytes = least_bytes(stage, vertices / triangles);
        if (bytes == 0) continue;
        const double floor = bytes * triangles * 1e-6 / ceilings.gigabytes_per_second;
        std::printf("  %-9s %-22s %4.0f B/tri   floor %8.3f ms   %8.3f ms   %3.0f %%\n", preset.c_str(), stage.c_str(),
                    bytes, floor, ms, 100 * floor / ms);
        csv.row(scene, preset, stage, bytes * triangles, 0, floor, ms, floor / ms);
    }
}

/// Floating-point operations of a box test and of the triangle filter, counted in kernels/trace.
constexpr double box_operations = 6 * 2 + 12, triangle_operations = 75;

void report_rays(const Device& device, const std::string& scene, const std::vector<Mesh>& meshes, Bvh::Config config,
                 const Ceilings& ceilings, int repeat, measure::Csv& csv) {
    config.layout = Layout::binary;
    const Bvh bvh = Bvh::build(device, meshes, config);
    const std::string preset = measure::name_of(measure::builders, config.builder);
    for (measure::DeviceRays& rays : measure::upload_rays(device, scene, meshes, 640, 360)) {
        if (rays.any_hit || rays.rays.size() == 0) continue;
        QueryOptions counting;
        counting.visits = Buffer<Visits>(device, rays.rays.size());
        closest_hit(bvh, rays.rays, rays.hits, counting);
        double boxes = 0, triangles = 0;
        for (const Visits& visits : counting.visits.read()) boxes += visits.nodes, triangles += visits.triangles;
        const double ms = measure::measure(device, repeat, [&] { rays.trace(bvh); }).at("");
        const double bytes = boxes * 32 + triangles * 48 + double(rays.rays.size()) * (sizeof(Ray) + sizeof(Hit));
        const double operations = boxes * box_operations + triangles * triangle_operations;
        const double floor = operations * 1e-6 / ceilings.gigaflops, n = double(rays.rays.size());
        std::printf(
            "  %-9s %-8s %5.1f boxes, %4.1f triangles a ray   %6.0f GB/s   floor %7.3f ms   %7.3f ms   %3.0f %%\n",
            preset.c_str(), rays.name.c_str(), boxes / n, triangles / n, bytes * 1e-6 / ms, floor, ms,
            100 * floor / ms);
        csv.row(scene, preset, rays.name, bytes, operations, floor, ms, floor / ms);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares each stage with the bandwidth and the arithmetic of the device");
    std::string selector, csv_path;
    std::vector<std::string> scenes = {"terrain:1000000"};
    int repeat = 9;
    app.add_option("--device", selector);
    app.add_option("--repeat", repeat);
    app.add_option("--csv", csv_path);
    app.add_option("scenes", scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(selector);
    const Ceilings ceilings = measure_ceilings(device, repeat);
    std::printf("%s: copies %.0f GB/s (read and written), %.0f GFLOP/s of fused multiply-adds\n",
                device.info().name.c_str(), ceilings.gigabytes_per_second, ceilings.gigaflops);
    measure::Csv csv(csv_path, device, "scene,preset,stage,bytes,operations,floor_ms,milliseconds,share");
    for (const std::string& scene : scenes) {
        const std::vector<Mesh> meshes = measure::load_meshes(scene);
        std::printf("%s\n", scene.c_str());
        for (const auto& [name, builder] : measure::builders) {
            Bvh::Config config;
            config.builder = builder;
            report_build(device, scene, meshes, config, ceilings, repeat, csv);
            report_rays(device, scene, meshes, config, ceilings, repeat, csv);
        }
    }
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_roofline: error: %s\n", error.what());
    return 1;
}
