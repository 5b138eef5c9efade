// Nearest points beside Embree 3's point queries in one process, by turns: bench_peers_points [--device D] [--points N]
// [--repeat N] [--threads T] [--csv FILE] [SCENE...]
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "bench/peers/embree.hpp"
#include "bench/support.hpp"
#include "claray/query/points.hpp"

using namespace claray;

namespace {

struct Options {
    std::string device, csv;
    std::size_t points = 1'000'000;
    unsigned threads = 2;
    int repeat = 5;
    std::vector<std::string> scenes = {"sphere"};
};

/// The triangles of a scene in Embree's order, and the answer to a query.
struct PeerQuery {
    const std::vector<glm::vec3>* corners;
    glm::vec3 point;
    std::uint32_t primitive = CLARAY_MISS;
};

/// Ericson 2004, "Real-Time Collision Detection", section 5.1.5, as in Embree's own example of point queries.
glm::vec3 closest_on_triangle(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
    const float d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const glm::vec3 bp = p - b;
    const float d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const glm::vec3 cp = p - c;
    const float d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    const float scale = 1 / (va + vb + vc);
    return a + vb * scale * ab + vc * scale * ac;
}

bool try_primitive(RTCPointQueryFunctionArguments* arguments) {
    PeerQuery& query = *static_cast<PeerQuery*>(arguments->userPtr);
    const glm::vec3* corner = query.corners->data() + std::size_t(3) * arguments->primID;
    const float distance =
        glm::distance(query.point, closest_on_triangle(query.point, corner[0], corner[1], corner[2]));
    if (distance >= arguments->query->radius) return false;
    arguments->query->radius = distance;
    query.primitive = arguments->primID;
    return true;
}

/// Milliseconds that Embree takes for all points; `distances` receives its answers.
double ask_peer(RTCScene scene, const std::vector<glm::vec3>& corners, const std::vector<glm::vec3>& points,
                unsigned threads, std::vector<float>& distances) {
    constexpr std::size_t chunk = 1024;
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        RTCPointQueryContext context;
        rtcInitPointQueryContext(&context);
        for (std::size_t begin; (begin = next.fetch_add(chunk)) < points.size();)
            for (std::size_t i = begin; i < std::min(begin + chunk, points.size()); ++i) {
                PeerQuery mine{&corners, points[i]};
                RTCPointQuery query{points[i].x, points[i].y, points[i].z, 0.f, INFINITY};
                rtcPointQuery(scene, &query, &context, try_primitive, &mine);
                distances[i] = query.radius;
            }
    };
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> others;
    for (unsigned i = 1; i < threads; ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

struct PointSet {
    const char* name;
    std::vector<glm::vec3> points;
};

/// Random points of the box grown by half, and points near the surface.
std::vector<PointSet> point_sets(const std::vector<glm::vec3>& corners, const Bounds& bounds, std::size_t count) {
    measure::Pcg random;
    std::vector<glm::vec3> anywhere(count), near(count);
    const auto in_box = [&] { return glm::vec3(random.uniform(), random.uniform(), random.uniform()) - 0.5f; };
    const float size = glm::length(bounds.extent());
    for (std::size_t i = 0; i < count; ++i) {
        anywhere[i] = bounds.center() + 1.5f * bounds.extent() * in_box();
        near[i] = corners[random.next() % corners.size()] + 0.01f * size * in_box();
    }
    return {{"anywhere", std::move(anywhere)}, {"near", std::move(near)}};
}

void compare_scene(const std::string& name, const Device& device, const Options& options, measure::Csv& csv) {
    const std::vector<Mesh> meshes = measure::load_meshes(name);
    std::vector<glm::vec3> corners;
    Bounds bounds;
    for (const Mesh& mesh : meshes)
        for (const glm::uvec3& t : mesh.triangles)
            for (int k = 0; k < 3; ++k) corners.push_back(mesh.positions[t[k]]), bounds.grow(corners.back());
    const Bvh bvh = Bvh::build(device, meshes, {.learns = false});
    const measure::EmbreeScene peer(meshes, RTC_BUILD_QUALITY_MEDIUM, true, options.threads);
    std::printf("%s, %zu triangles\n", name.c_str(), corners.size() / 3);
    for (const PointSet& set : point_sets(corners, bounds, options.points)) {
        const std::size_t count = set.points.size();
        const Buffer<float> points(device, std::span(&set.points[0].x, 3 * count));
        Buffer<NearestPoint> nearest(device, count);
        std::vector<float> distances(count);
        std::vector<double> ours, theirs;
        for (int i = -1; i < options.repeat; ++i) {
            const auto start = std::chrono::steady_clock::now();
            nearest_point(bvh, points, nearest);
            device.finish();
            const double ms =
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
            const double peer_ms = ask_peer(peer.handle(), corners, set.points, options.threads, distances);
            if (i >= 0) ours.push_back(ms), theirs.push_back(peer_ms);
        }
        const std::vector<NearestPoint> answers = nearest.read();
        std::size_t differ = 0;
        for (std::size_t i = 0; i < count; ++i)
            differ += std::fabs(answers[i].distance - distances[i]) >
                      1e-5f * distances[i] + 1e-6f * glm::length(bounds.extent());
        const double our_ms = measure::median(ours), peer_ms = measure::median(theirs);
        std::printf("  %-8s %8zu points: claray %8.1f ms, Embree %s %8.1f ms, ratio %.2f, %zu distances differ\n",
                    set.name, count, our_ms, RTC_VERSION_STRING, peer_ms, peer_ms / our_ms, differ);
        csv.row(std::filesystem::path(name).stem().string(), set.name, count, our_ms, peer_ms, peer_ms / our_ms,
                differ);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares nearest points with Embree 3's point queries in one process");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--points", options.points);
    app.add_option("--repeat", options.repeat);
    app.add_option("--threads", options.threads, "threads of Embree");
    app.add_option("--csv", options.csv);
    app.add_option("scenes", options.scenes);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.device);
    measure::Csv csv(options.csv, device,
                     "scene,points,count,milliseconds,embree_milliseconds,claray_is_faster_by,differences");
    for (const std::string& name : options.scenes) compare_scene(name, device, options, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_peers_points: error: %s\n", error.what());
    return 1;
}
