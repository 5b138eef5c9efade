// Round curves beside Embree 3's in one process, by turns: bench_peers_curves [--strands hair | fur | grass | curls]
// [--device D] [--triangles N] [--every N] [--width W --height H] [--repeat N] [--threads T] [--explain N] [--csv
// FILE]. The curves are B-splines: the strands of the scene hair:N with a control point at every third place along a
// strand, or as many segments that stand on a ball (fur), bend over a field (grass) or wind around falling lines
// (curls).
#include <embree3/rtcore.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <thread>

#include "bench/peers/curve_differences.hpp"
#include "bench/support.hpp"
#include "claray/primitives/curves.hpp"

using namespace claray;
using measure::Strands;

namespace {

struct Options {
    std::string device, csv, strands = "hair";
    std::size_t triangles = 500'000;
    std::uint32_t every = 3;
    unsigned width = 640, height = 480, threads = 2;
    int repeat = 5;
    std::size_t explain = 0;
    Bvh::Config bvh{.builder = Builder::binned};
};

/// The centre lines of the ribbons of a mesh of hair: the middles between neighbouring vertices, which lie on the left
/// and on the right by turns. Triangles of one strand follow each other.
Strands strands_of(const Mesh& hair, std::uint32_t every) {
    Strands strands;
    std::vector<glm::vec4> centers;
    const auto finish = [&] {
        const auto first = std::uint32_t(strands.points.size());
        for (std::size_t i = 0; i < centers.size(); i += every) strands.points.push_back(centers[i]);
        for (std::uint32_t i = first; i + 4 <= strands.points.size(); ++i) strands.segments.push_back(i);
        centers.clear();
    };
    std::uint32_t last = 0;
    for (const glm::uvec3& t : hair.triangles) {
        const std::uint32_t newest = std::max({t.x, t.y, t.z}), oldest = std::min({t.x, t.y, t.z});
        if (oldest > last) finish();
        const glm::vec3 a = hair.positions[newest - 1], b = hair.positions[newest];
        const glm::vec3 along = hair.positions[newest] - hair.positions[newest - 2], side = b - a;
        const float width = glm::length(side - glm::dot(side, along) / glm::dot(along, along) * along);
        centers.emplace_back(0.5f * (a + b), 0.5f * width);
        last = newest;
    }
    finish();
    return strands;
}

/// Strands of `size` control points each, that `place` puts at t from 0 to 1 of strand i.
template <class Place>
Strands grow(std::size_t segments, std::uint32_t size, float radius, const Place& place) {
    Strands strands;
    for (std::size_t i = 0; i < segments / (size - 3); ++i) {
        const auto first = std::uint32_t(strands.points.size());
        for (std::uint32_t k = 0; k < size; ++k) {
            const float t = float(k) / float(size - 1);
            strands.points.emplace_back(place(i, t), radius * (1.1f - t));
        }
        for (std::uint32_t k = 0; k + 3 < size; ++k) strands.segments.push_back(first + k);
    }
    return strands;
}

/// Numbers from -1 to 1 that belong to a strand.
glm::vec3 random_of(std::size_t strand, unsigned salt) {
    std::mt19937 random(unsigned(2 * strand) + salt);
    std::uniform_real_distribution<float> number(-1, 1);
    const float x = number(random), y = number(random);
    return {x, y, number(random)};
}

Strands grow(const std::string& kind, std::size_t segments) {
    const float thin = 0.5f / std::sqrt(float(segments));
    if (kind == "fur")
        return grow(segments, 6, thin, [](std::size_t i, float t) {
            const glm::vec3 root = glm::normalize(random_of(i, 0)), lean = random_of(i, 1);
            return root + t * 0.15f * (root + t * (0.4f * lean + glm::vec3(0, -0.8f, 0.3f)));
        });
    if (kind == "grass")
        return grow(segments, 5, 2 * thin, [](std::size_t i, float t) {
            const glm::vec3 at = random_of(i, 0), lean = random_of(i, 1);
            return glm::vec3(at.x + 0.1f * t * t * lean.x, t * (0.15f + 0.05f * lean.y), at.z + 0.1f * t * t * lean.z);
        });
    if (kind == "curls")
        return grow(segments, 40, thin, [](std::size_t i, float t) {
            const glm::vec3 at = random_of(i, 0), form = random_of(i, 1);
            const float angle = (25 + 10 * form.x) * t + 6 * form.y, wide = 0.03f + 0.02f * form.z;
            return glm::vec3(at.x + wide * std::cos(angle), 0.4f * at.y - 1.5f * t, at.z + wide * std::sin(angle));
        });
    throw Error(ErrorKind::usage, "there are no strands '" + kind + "'", "use hair, fur, grass or curls");
}

/// A ribbon along each segment.
Mesh ribbons_of(const Strands& strands) {
    Mesh mesh;
    for (const std::uint32_t segment : strands.segments) {
        const glm::vec4 a = strands.points[segment + 1], b = strands.points[segment + 2];
        const glm::vec3 along = b - a, side = glm::normalize(glm::cross(along, glm::vec3(0.3f, 0.2f, 1)));
        const auto base = std::uint32_t(mesh.positions.size());
        for (const glm::vec4& end : {a, b})
            for (const float sign : {-1.f, 1.f}) mesh.positions.push_back(glm::vec3(end) + sign * end.w * side);
        mesh.triangles.emplace_back(base, base + 1, base + 2);
        mesh.triangles.emplace_back(base + 1, base + 3, base + 2);
    }
    return mesh;
}

class EmbreeCurves {
public:
    EmbreeCurves(const Strands& strands, unsigned threads)
        : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())), scene_(rtcNewScene(device_)) {
        if (device_ == nullptr) throw Error(ErrorKind::device, "Embree gives no device");
        rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
        RTCGeometry curves = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
        rtcSetSharedGeometryBuffer(curves, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, strands.points.data(), 0,
                                   sizeof(glm::vec4), strands.points.size());
        rtcSetSharedGeometryBuffer(curves, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, strands.segments.data(), 0,
                                   sizeof(std::uint32_t), strands.segments.size());
        rtcCommitGeometry(curves);
        rtcAttachGeometry(scene_, curves);
        rtcReleaseGeometry(curves);
        rtcCommitScene(scene_);
    }
    ~EmbreeCurves() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeCurves(const EmbreeCurves&) = delete;
    EmbreeCurves& operator=(const EmbreeCurves&) = delete;

    /// Milliseconds for all rays; `distances` receives the answers.
    double trace(const std::vector<Ray>& rays, unsigned threads, std::vector<float>& distances) const {
        constexpr std::size_t chunk = 1024;
        std::atomic<std::size_t> next = 0;
        const auto work = [&] {
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            for (std::size_t begin; (begin = next.fetch_add(chunk)) < rays.size();)
                for (std::size_t i = begin; i < std::min(begin + chunk, rays.size()); ++i) {
                    const Ray& r = rays[i];
                    RTCRayHit hit{};
                    hit.ray.org_x = r.ox, hit.ray.org_y = r.oy, hit.ray.org_z = r.oz, hit.ray.tnear = r.tmin;
                    hit.ray.dir_x = r.dx, hit.ray.dir_y = r.dy, hit.ray.dir_z = r.dz, hit.ray.tfar = r.tmax;
                    hit.ray.mask = ~0u, hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
                    rtcIntersect1(scene_, &context, &hit);
                    distances[i] = hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : hit.ray.tfar;
                }
        };
        const auto start = std::chrono::steady_clock::now();
        std::vector<std::thread> others;
        for (unsigned i = 1; i < threads; ++i) others.emplace_back(work);
        work();
        for (std::thread& other : others) other.join();
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    }
    [[nodiscard]] long long bytes() const { return bytes_; }

private:
    static bool count_bytes(void* sum, ssize_t bytes, bool) {
        *static_cast<std::atomic<long long>*>(sum) += bytes;
        return true;
    }
    std::atomic<long long> bytes_ = 0;
    RTCDevice device_;
    RTCScene scene_;
};

/// Bytes of a structure and of what it was built from.
double megabytes(const Bvh& bvh, std::uint64_t input) { return double(bvh.statistics().bytes + input) * 1e-6; }

/// From a point just before each hit of a curve, a ray into a random direction of the half towards where the ray came
/// from.
std::vector<Ray> bounces(const std::vector<Ray>& rays, const Primitives& curves) {
    const std::vector<Hit> hits = closest_hit(curves, rays);
    measure::Pcg random;
    std::vector<Ray> bounced;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].primitive == CLARAY_MISS) continue;
        const glm::vec3 d(rays[i].dx, rays[i].dy, rays[i].dz), back = -glm::normalize(d);
        const glm::vec3 at = glm::vec3(rays[i].ox, rays[i].oy, rays[i].oz) + hits[i].t * d + 0.001f * back;
        glm::vec3 to;
        do to = 2.f * glm::vec3(random.uniform(), random.uniform(), random.uniform()) - 1.f;
        while (glm::dot(to, to) > 1 || glm::dot(to, to) < 1e-3f);
        if (glm::dot(to, back) < 0) to = -to;
        to = glm::normalize(to);
        bounced.push_back({at.x, at.y, at.z, 0.f, to.x, to.y, to.z, 1e30f});
    }
    return bounced;
}

/// Of rays whose hits differ, says of at most `most`, taken at equal steps, why.
void print_reasons(const Strands& strands, const std::vector<Ray>& rays, const std::vector<float>& claray,
                   const std::vector<float>& embree, std::size_t most) {
    std::vector<std::size_t> differing;
    for (std::size_t i = 0; i < rays.size(); ++i)
        if (measure::differ(claray[i], embree[i])) differing.push_back(i);
    const std::size_t count = std::min(most, differing.size());
    std::vector<Ray> of_rays(count);
    std::vector<float> of_claray(count), of_embree(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = differing[i * differing.size() / count];
        of_rays[i] = rays[at], of_claray[i] = claray[at], of_embree[i] = embree[at];
    }
    const measure::Differences why = measure::explain(strands, of_rays, of_claray, of_embree);
    std::printf(
        "  of %zu that differ: %zu begin inside a curve, %zu meet the end of a strand, %zu are near each other\n",
        count, why.begin_inside, why.at_ends, why.near);
    const auto print = [](const char* name, const measure::Right& right) {
        std::printf("    %-7s right by float64: %zu claray, %zu Embree, %zu both, %zu neither\n", name, right.claray,
                    right.embree, right.both, right.neither);
    };
    print("graze:", why.graze), print("others:", why.others);
}

void compare(const char* kind, const std::vector<Ray>& rays, const Primitives& ours, const EmbreeCurves& peer,
             const Bvh& ribbons, const Strands& strands, const Options& options, measure::Csv& csv) {
    const Device& device = ours.device();
    const Buffer<Ray> on_device(device, rays);
    Buffer<Hit> hits(device, rays.size()), of_ribbons(device, rays.size());
    std::vector<float> distances(rays.size());
    std::vector<double> mine, theirs, triangles;
    QueryOptions how;
    if (kind == std::string("bounce")) how.coherence = Coherence::incoherent;
    const auto time = [&](const auto& run) {
        const auto start = std::chrono::steady_clock::now();
        run();
        device.finish();
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    };
    for (int i = -1; i < options.repeat; ++i) {
        const double a = time([&] { closest_hit(ours, on_device, hits, how); });
        const double b = peer.trace(rays, options.threads, distances);
        const double c = time([&] { closest_hit(ribbons, on_device, of_ribbons); });
        if (i >= 0) mine.push_back(a), theirs.push_back(b), triangles.push_back(c);
    }
    const std::vector<Hit> found = hits.read();
    std::vector<float> own(rays.size());
    std::size_t differ = 0, hit = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool here = found[i].primitive != CLARAY_MISS;
        own[i] = here ? found[i].t : INFINITY;
        hit += here, differ += measure::differ(own[i], distances[i]);
    }
    const double a = measure::median(mine), b = measure::median(theirs), c = measure::median(triangles);
    std::printf(
        "  %-8s %8zu rays, %zu hit: claray %8.1f ms, Embree %s %8.1f ms, ratio %.2f, %zu differ; triangles %.1f ms\n",
        kind, rays.size(), hit, a, RTC_VERSION_STRING, b, b / a, differ, c);
    if (options.explain != 0) print_reasons(strands, rays, own, distances, options.explain);
    csv.row(options.strands, kind, rays.size(), a, b, b / a, differ, c);
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app("Compares round curves with Embree 3's");
    Options options;
    app.add_option("--device", options.device);
    app.add_option("--strands", options.strands, "hair, fur, grass or curls");
    app.add_option("--triangles", options.triangles,
                   "of the scene of hair; other strands have a segment for each four");
    app.add_option("--every", options.every, "places along a strand per control point");
    app.add_option("--width", options.width);
    app.add_option("--height", options.height);
    app.add_option("--repeat", options.repeat);
    app.add_option("--threads", options.threads, "threads of Embree");
    app.add_option("--explain", options.explain, "of so many rays that differ, say why, by float64");
    measure::add_bvh_options(app, options.bvh);
    app.add_option("--csv", options.csv);
    CLI11_PARSE(app, argc, argv);
    const Device device = Device::open(options.device);
    const std::string name = options.strands + ":" + std::to_string(options.triangles);
    Scene scene;
    Strands strands;
    if (options.strands == "hair") {
        scene.meshes = measure::load_meshes(name);
        strands = strands_of(scene.meshes[0], options.every);
    } else {
        strands = grow(options.strands, options.triangles / 4);
        scene.meshes.push_back(ribbons_of(strands));
    }
    const Bvh ribbons = Bvh::build(device, scene.meshes, {.learns = false});
    const Primitives curves =
        build_curves(device, strands.points, strands.segments, CurveBasis::bspline, CurveShape::round, options.bvh);
    const EmbreeCurves peer(strands, options.threads);
    const std::uint64_t mesh_bytes = 12 * (scene.meshes[0].positions.size() + scene.meshes[0].triangles.size());
    std::printf("%s: %zu triangles, %.1f MB; %zu segments, %.1f MB; Embree's %.1f MB\n", name.c_str(),
                scene.meshes[0].triangles.size(), megabytes(ribbons, mesh_bytes), strands.segments.size(),
                megabytes(curves.bvh(), curves.data().bytes() + 48 * strands.segments.size()),
                double(peer.bytes()) * 1e-6);
    std::vector<Ray> primary;
    for (const measure::View& view : measure::three_views(name, scene)) {
        const std::vector<Ray> rays = measure::primary_rays(view.camera, options.width, options.height, false);
        primary.insert(primary.end(), rays.begin(), rays.end());
    }
    measure::Csv csv(
        options.csv, device,
        "scene,kind,rays,milliseconds,embree_milliseconds,claray_is_faster_by,differences,triangles_milliseconds");
    compare("primary", primary, curves, peer, ribbons, strands, options, csv);
    compare("bounce", bounces(primary, curves), curves, peer, ribbons, strands, options, csv);
    csv.write();
} catch (const std::exception& error) {
    std::fprintf(stderr, "bench_peers_curves: error: %s\n", error.what());
    return 1;
}
