// Queries: the closest hit of each ray, and whether a ray hits anything.
#pragma once

#include <span>
#include <vector>

#include "claray/bvh.hpp"
#include "claray/query/filter.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Whether neighbouring rays in an array have similar directions, as camera rays do. Affects speed only.
enum class Coherence {
    automatic,  ///< decided by a sample of the rays; on GPUs, any-hit rays count as incoherent
    coherent,
    incoherent
};

struct QueryOptions {
    bool cull_back_faces = false;  ///< only triangles whose vertices appear counter-clockwise are hit
    /// Rays that only touch a surface, at its border or at an edge seen from the side, hit it. A ray through an edge
    /// may then hit either of its triangles; otherwise it hits exactly one, or none if it only touches.
    bool closed = false;
    bool brute_force = false;  ///< tests every triangle, without the tree: same hits, for comparison
    Coherence coherence = Coherence::automatic;
    Buffer<std::uint32_t> ray_masks = {};  ///< one per ray; empty: every ray sees every mesh
    Buffer<float> ray_times = {};          ///< one per ray, 0 to 1, for an InstancedBvh with motion; empty: time 0
    Buffer<Visits> visits = {};            ///< if allocated: receives the cost of each ray
    /// Only for a Bvh, and not with `brute_force` or `visits`. Hits count only if the filter accepts them. Rays are
    /// then traced one by one.
    HitFilter filter = {};
};

/// Finds the closest hit of every ray. Asynchronous, except on CPUs for 65,536 rays or more without a coherence hint:
/// there some of the rays are read and traced first. Hits are equal bit for bit in all layouts: among equal distances
/// the lowest primitive index wins. `hits` must hold at least as many elements as `rays`. If `count` (one element on
/// the device) is given, only the first min(*count, rays.size()) rays are traced.
void closest_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits, const QueryOptions& options = {},
                 const Buffer<std::uint32_t>& count = {});
/// Writes 1 for every ray that hits anything, else 0. Asynchronous as closest_hit.
void any_hit(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, const QueryOptions& options = {},
             const Buffer<std::uint32_t>& count = {});

/// As above, for rays in host memory: uploads, traces, downloads. Blocks.
[[nodiscard]] std::vector<Hit> closest_hit(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options = {});
[[nodiscard]] std::vector<std::uint8_t> any_hit(const Bvh& bvh, std::span<const Ray> rays,
                                                const QueryOptions& options = {});

class InstancedBvh;
struct InstanceHit;

enum class QueryKind { closest, any };

/// A query that is made once and run often. Making it loads its kernels; a run only enqueues commands. The options hold
/// for all runs. A handle: copies share the query.
class Query {
public:
    /// Queries run on the queue of the structure's device, or on `queue`, which Device::with_new_queue made of it. The
    /// constructor then waits once for the structure; after a rebuild or refit pass an event to `run`. Throws
    /// ErrorKind::usage if `queue` has another context.
    Query(const Bvh& bvh, QueryKind kind, const QueryOptions& options = {});
    Query(const Bvh& bvh, QueryKind kind, const QueryOptions& options, const Device& queue);
    Query(const InstancedBvh& bvh, QueryKind kind, const QueryOptions& options = {});
    Query(const InstancedBvh& bvh, QueryKind kind, const QueryOptions& options, const Device& queue);

    /// Enqueues the query after all of `wait_for`, and returns the event of the query's end. Asynchronous as
    /// closest_hit: give QueryOptions::coherence so that nothing is waited for. The buffers must be alive until the
    /// event is complete. `count`: see closest_hit. Throws ErrorKind::usage, before anything is enqueued, for buffers
    /// that are too small or of another context, and for results of another kind than the query's. QueryKind::closest
    /// has Hit and InstanceHit, QueryKind::any has bytes.
    cl::Event run(const Buffer<Ray>& rays, Buffer<Hit>& hits, std::span<const cl::Event> wait_for = {},
                  const Buffer<std::uint32_t>& count = {});
    cl::Event run(const Buffer<Ray>& rays, Buffer<InstanceHit>& hits, std::span<const cl::Event> wait_for = {},
                  const Buffer<std::uint32_t>& count = {});
    cl::Event run(const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded, std::span<const cl::Event> wait_for = {},
                  const Buffer<std::uint32_t>& count = {});

    /// As above, for rays and results in host memory, which CPUs use in place. Blocks. Throws ErrorKind::usage if the
    /// arrays differ in size.
    void run(std::span<const Ray> rays, std::span<Hit> hits);
    void run(std::span<const Ray> rays, std::span<InstanceHit> hits);
    void run(std::span<const Ray> rays, std::span<std::uint8_t> occluded);

    [[nodiscard]] const Device& device() const;

    struct State;  ///< not for users

private:
    std::shared_ptr<State> state_;
};

}  // namespace claray
#pragma GCC visibility pop
