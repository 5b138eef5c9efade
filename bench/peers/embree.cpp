#include "bench/peers/embree.hpp"

#include <pmmintrin.h>
#include <xmmintrin.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <limits>
#include <thread>

#include "claray/error.hpp"

namespace claray::measure {
namespace {

constexpr std::size_t chunk = 1024;  // rays that a thread takes at a time

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

template <int N>
struct PacketTypes;
template <>
struct PacketTypes<8> {
    using RayHit = RTCRayHit8;
    using Ray = RTCRay8;
};
template <>
struct PacketTypes<16> {
    using RayHit = RTCRayHit16;
    using Ray = RTCRay16;
};

template <class Packet>
void fill_lane(Packet& to, std::size_t lane, const Ray& from) {
    to.org_x[lane] = from.ox, to.org_y[lane] = from.oy, to.org_z[lane] = from.oz, to.tnear[lane] = from.tmin;
    to.dir_x[lane] = from.dx, to.dir_y[lane] = from.dy, to.dir_z[lane] = from.dz, to.tfar[lane] = from.tmax;
    to.time[lane] = 0, to.mask[lane] = ~0u, to.id[lane] = unsigned(lane), to.flags[lane] = 0;
}
void fill(RTCRay& to, const Ray& from) {
    to.org_x = from.ox, to.org_y = from.oy, to.org_z = from.oz, to.tnear = from.tmin;
    to.dir_x = from.dx, to.dir_y = from.dy, to.dir_z = from.dz, to.tfar = from.tmax;
    to.time = 0, to.mask = ~0u, to.id = 0, to.flags = 0;
}

alignas(64) const int all_valid[16] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};

}  // namespace

EmbreeScene::EmbreeScene(std::span<const Mesh> meshes, RTCBuildQuality quality, bool robust, unsigned threads)
    : device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())) {
    if (device_ == nullptr) throw Error(ErrorKind::device, "Embree gives no device");
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (const Mesh& mesh : meshes) {
        const glm::uvec3 base{std::uint32_t(positions.size())};
        positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
        for (const glm::uvec3& triangle : mesh.triangles) triangles.push_back(base + triangle);
    }
    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, quality);
    rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                             positions.size());
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                            triangles.size());
    std::copy(positions.begin(), positions.end(), static_cast<glm::vec3*>(vertices));
    std::copy(triangles.begin(), triangles.end(), static_cast<glm::uvec3*>(indices));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene_);
    build_ms_ = milliseconds_since(start);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
        throw Error(ErrorKind::device, "Embree reports error " + std::to_string(error));
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

struct EmbreeQuery::Arrays {
    std::vector<RTCRayHit> one;
    std::vector<RTCRay> any_one;
    std::vector<RTCRayHit8> eight;
    std::vector<RTCRay8> any_eight;
    std::vector<RTCRayHit16> sixteen;
    std::vector<RTCRay16> any_sixteen;
    std::vector<int> valid;  // of the last packet
};

EmbreeQuery::EmbreeQuery(const EmbreeScene& scene, std::span<const Ray> rays, Packets packets, bool any, bool coherent,
                         unsigned threads)
    : scene_(scene.handle()),
      rays_(rays),
      packets_(packets),
      any_(any),
      coherent_(coherent),
      threads_(threads),
      arrays_(std::make_unique<Arrays>()) {
    reset();
}
EmbreeQuery::~EmbreeQuery() = default;

void EmbreeQuery::reset() {
    const auto reset_packets = [&](auto& hits, auto& shadows, std::size_t width) {
        const std::size_t packets = (rays_.size() + width - 1) / width;
        any_ ? shadows.resize(packets) : hits.resize(packets);
        for (std::size_t i = 0; i < packets * width; ++i) {
            Ray ray = i < rays_.size() ? rays_[i] : rays_.back();
            if (i >= rays_.size()) ray.tmin = 1, ray.tmax = 0;  // an empty range: the lane is idle
            if (any_) {
                fill_lane(shadows[i / width], i % width, ray);
            } else {
                fill_lane(hits[i / width].ray, i % width, ray);
                hits[i / width].hit.geomID[i % width] = RTC_INVALID_GEOMETRY_ID;
                hits[i / width].hit.instID[0][i % width] = RTC_INVALID_GEOMETRY_ID;
            }
        }
    };
    if (packets_ == Packets::eight) return reset_packets(arrays_->eight, arrays_->any_eight, 8);
    if (packets_ != Packets::one) return reset_packets(arrays_->sixteen, arrays_->any_sixteen, 16);
    any_ ? arrays_->any_one.resize(rays_.size()) : arrays_->one.resize(rays_.size());
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        if (any_) {
            fill(arrays_->any_one[i], rays_[i]);
        } else {
            fill(arrays_->one[i].ray, rays_[i]);
            arrays_->one[i].hit.geomID = arrays_->one[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        }
    }
}

void EmbreeQuery::trace(std::size_t begin, std::size_t end) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (coherent_) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    Arrays& a = *arrays_;
    const std::size_t first16 = begin / 16, last16 = (end + 15) / 16;
    switch (packets_) {
        case Packets::one:
            for (std::size_t i = begin; i < end; ++i)
                any_ ? rtcOccluded1(scene_, &context, &a.any_one[i]) : rtcIntersect1(scene_, &context, &a.one[i]);
            break;
        case Packets::eight:
            for (std::size_t i = begin / 8; i < (end + 7) / 8; ++i)
                any_ ? rtcOccluded8(all_valid, scene_, &context, &a.any_eight[i])
                     : rtcIntersect8(all_valid, scene_, &context, &a.eight[i]);
            break;
        case Packets::sixteen:
            for (std::size_t i = first16; i < last16; ++i)
                any_ ? rtcOccluded16(all_valid, scene_, &context, &a.any_sixteen[i])
                     : rtcIntersect16(all_valid, scene_, &context, &a.sixteen[i]);
            break;
        case Packets::stream:
            for (std::size_t i = first16; i < last16; i += 4) {
                const auto count = unsigned(std::min<std::size_t>(4, last16 - i));
                if (any_)
                    rtcOccludedNM(scene_, &context, reinterpret_cast<RTCRayN*>(&a.any_sixteen[i]), 16, count,
                                  sizeof(RTCRay16));
                else
                    rtcIntersectNM(scene_, &context, reinterpret_cast<RTCRayHitN*>(&a.sixteen[i]), 16, count,
                                   sizeof(RTCRayHit16));
            }
            break;
    }
}

double EmbreeQuery::run(bool cpu_time) {
    reset();
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);  // as Embree recommends
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
        for (std::size_t begin; (begin = next.fetch_add(chunk)) < rays_.size();)
            trace(begin, std::min(rays_.size(), begin + chunk));
    };
    const std::clock_t begin = std::clock();
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < threads_; ++i) threads.emplace_back(work);
    for (std::thread& thread : threads) thread.join();
    if (cpu_time) return double(std::clock() - begin) * 1e3 / CLOCKS_PER_SEC / threads_;
    return milliseconds_since(start);
}

PeerHits EmbreeQuery::hits() const {
    PeerHits found;
    found.t.resize(rays_.size());
    found.primitive.resize(rays_.size());
    const auto set = [&](std::size_t i, float t, bool hit, unsigned primitive) {
        found.t[i] = hit ? t : std::numeric_limits<float>::infinity();
        found.primitive[i] = hit ? primitive : CLARAY_MISS;
    };
    const auto set_lane = [&](std::size_t i, const auto& hits, const auto& shadows, std::size_t width) {
        const std::size_t lane = i % width;
        if (any_)
            set(i, shadows[i / width].tfar[lane], shadows[i / width].tfar[lane] < 0, 0);
        else
            set(i, hits[i / width].ray.tfar[lane], hits[i / width].hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID,
                hits[i / width].hit.primID[lane]);
    };
    const Arrays& a = *arrays_;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        if (packets_ == Packets::eight)
            set_lane(i, a.eight, a.any_eight, 8);
        else if (packets_ != Packets::one)
            set_lane(i, a.sixteen, a.any_sixteen, 16);
        else if (any_)
            set(i, a.any_one[i].tfar, a.any_one[i].tfar < 0, 0);
        else
            set(i, a.one[i].ray.tfar, a.one[i].hit.geomID != RTC_INVALID_GEOMETRY_ID, a.one[i].hit.primID);
    }
    return found;
}

}  // namespace claray::measure
