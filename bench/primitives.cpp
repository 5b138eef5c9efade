// Spheres as claray's own kind of primitive and as the text of a user: bench_primitives [--device D] [--spheres N]
// [--rays N]
// [--rounds N] [--csv FILE]
#include <cmath>
#include <cstdio>

#include "bench/support.hpp"

using namespace claray;

namespace {

/// As a program would write it, in float32.
constexpr const char* users_text = R"(
static inline PrimitiveBox bounds_of(global const float* data, uint primitive) {
    const float4 s = vload4(primitive, data);
    const PrimitiveBox box = {s.xyz - 1.00001f * s.w, s.xyz + 1.00001f * s.w};
    return box;
}
static inline bool intersect(global const float* data, uint primitive, float3 origin, float3 direction, float tmin, Hit* hit) {
    const float4 s = vload4(primitive, data);
    const float3 from = origin - s.xyz;
    const float a = dot(direction, direction), b = dot(from, direction), c = dot(from, from) - s.w * s.w, d = b * b - a * c;
    if (d < 0.0f) return false;
    const float root = sqrt(d);
    return take_hit((-b - root) / a, tmin, hit) || take_hit((root - b) / a, tmin, hit);
})";

struct Options {
    std::string device, csv;
    std::size_t spheres = 1'000'000, rays = 1'000'000;
    int rounds = 7;
};

void run(const Options& options) {
    const Device device = Device::open(options.device);
    measure::Pcg random;
    std::vector<float> data(4 * options.spheres);
    const float size = 0.5f / std::cbrt(float(options.spheres));
    Bounds bounds;
    for (std::size_t i = 0; i < data.size(); i += 4) {
        for (int k = 0; k < 3; ++k) data[i + k] = random.uniform();
        data[i + 3] = size * (0.5f + random.uniform());
    }
    bounds.grow(glm::vec3(0)), bounds.grow(glm::vec3(1));
    const Buffer<float> on_device(device, data);
    const auto count = std::uint32_t(options.spheres);
    const Primitives own = Primitives::build(device, sphere_kind(), on_device, count),
                     users = Primitives::build(device, {"users", users_text, 4}, on_device, count);
    const Buffer<Ray> rays(device, measure::random_rays(bounds, options.rays));
    Buffer<Hit> own_hits(device, options.rays), users_hits(device, options.rays);
    const auto timings = measure::measure_rounds(
        device, options.rounds,
        {[&] { closest_hit(own, rays, own_hits); }, [&] { closest_hit(users, rays, users_hits); }});
    const std::vector<Hit> a = own_hits.read(), b = users_hits.read();
    std::size_t hits = 0, differ = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        hits += a[i].primitive != CLARAY_MISS;
        differ += a[i].primitive != b[i].primitive;
    }
    const double own_ms = timings[0].milliseconds(), users_ms = timings[1].milliseconds();
    std::printf(
        "%zu spheres, %zu rays, %zu hit: claray's kind %.2f ms, user's text %.2f ms, ratio %.3f, %zu hits differ\n",
        options.spheres, options.rays, hits, own_ms, users_ms, users_ms / own_ms, differ);
    measure::Csv csv(options.csv, device, "spheres,rays,milliseconds,users_milliseconds,differences");
    csv.row(options.spheres, options.rays, own_ms, users_ms, differ);
    csv.write();
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times spheres as claray's own kind of primitive and as a user's");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--spheres", options.spheres);
    app.add_option("--rays", options.rays);
    app.add_option("--rounds", options.rounds);
    app.add_option("--csv", options.csv);
    CLI11_PARSE(app, argc, argv);
    run(options);
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_primitives: error: %s\n", error.what());
    return 1;
}
