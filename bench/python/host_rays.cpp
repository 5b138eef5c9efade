// The cost of rays in host memory: bench_host_rays SCENE RAYS [--rounds N] [--device D] times closest_hit of a span,
// and a Query into memory that exists, for the rays of a file (claray's Ray, 32 bytes each). Prints two lines: medians
// in milliseconds. bench/python/rays.py compares Python with it.
#include <chrono>
#include <cstdio>

#include "bench/support.hpp"
#include "host/base/file.hpp"

using namespace claray;

namespace {

std::vector<Ray> read_rays(const std::string& path) {
    const std::string bytes = read_file(path, "give a file of rays");
    std::vector<Ray> rays(bytes.size() / sizeof(Ray));
    std::memcpy(rays.data(), bytes.data(), rays.size() * sizeof(Ray));
    return rays;
}

template <class Task>
double median_milliseconds(unsigned rounds, const Task& task) {
    task();
    std::vector<double> times;
    for (unsigned i = 0; i < rounds; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        task();
        times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Times rays in host memory");
    std::string scene, file, selector;
    unsigned rounds = 11;
    Bvh::Config config;
    app.add_option("scene", scene)->required();
    app.add_option("rays", file)->required();
    app.add_option("--rounds", rounds);
    app.add_option("--device", selector);
    measure::add_bvh_options(app, config);
    CLI11_PARSE(app, argc, argv);
    const std::vector<Ray> rays = read_rays(file);
    const Bvh bvh = Bvh::build(Device::open(selector), measure::load_meshes(scene), config);
    std::printf("closest_hit %.3f\n", median_milliseconds(rounds, [&] { (void)closest_hit(bvh, rays); }));
    Query query(bvh, QueryKind::closest);
    std::vector<Hit> hits(rays.size());
    std::printf("query %.3f\n", median_milliseconds(rounds, [&] { query.run(rays, hits); }));
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_host_rays: error: %s\n", error.what());
    return 1;
}
