// Embree 3 as a peer: the same triangles and rays, by its single rays, packets and streams, on as many threads as asked
// for.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/shared/types.h"
#include "host/bvh/host_tree.hpp"

namespace claray::measure {

/// How rays are handed to Embree: one by one, in packets, or as a stream of packets of 16.
enum class Packets { one = 1, eight = 8, sixteen = 16, stream = 0 };

/// What a query found, in the terms of claray's hits.
struct PeerHits {
    std::vector<float> t;                  // infinite on a miss
    std::vector<std::uint32_t> primitive;  // CLARAY_MISS on a miss; of an any-hit query only whether it is that
};

class EmbreeScene {
public:
    EmbreeScene(std::span<const Mesh> meshes, RTCBuildQuality quality, bool robust, unsigned threads);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    [[nodiscard]] RTCScene handle() const { return scene_; }
    /// Milliseconds that rtcCommitScene took.
    [[nodiscard]] double build_milliseconds() const { return build_ms_; }

private:
    RTCDevice device_;
    RTCScene scene_;
    double build_ms_ = 0;
};

/// A binary tree by Embree's builder, one triangle a leaf, as claray's own builders make them.
[[nodiscard]] HostTree embree_tree(std::span<const Mesh> meshes, RTCBuildQuality quality);

/// Rays laid out as Embree takes them; `run` resets them outside the time that it returns.
class EmbreeQuery {
public:
    EmbreeQuery(const EmbreeScene& scene, std::span<const Ray> rays, Packets packets, bool any, bool coherent,
                unsigned threads);
    ~EmbreeQuery();
    /// Milliseconds of one trace of all rays, by the wall clock or the process' processor time over its threads.
    double run(bool cpu_time);
    [[nodiscard]] PeerHits hits() const;

private:
    struct Arrays;
    void reset();
    void trace(std::size_t begin, std::size_t end);
    RTCScene scene_;
    std::span<const Ray> rays_;
    Packets packets_;
    bool any_, coherent_;
    unsigned threads_;
    std::unique_ptr<Arrays> arrays_;
};

}  // namespace claray::measure
