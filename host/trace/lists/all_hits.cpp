#include "claray/query/all_hits.hpp"

#include "host/trace/lists/filter.hpp"
#include "host/trace/lists/lists.hpp"
#include "host/trace/query_launch.hpp"
#include "host/trace/query_options.hpp"

namespace claray {
namespace {

Kernel load(const Bvh& bvh, const QueryOptions& options, const QueryLaunch& launch) {
    QueryOptions used;
    used.cull_back_faces = options.cull_back_faces, used.closed = options.closed, used.ray_masks = options.ray_masks;
    return load_filtered(bvh.device(), "trace/lists/all_hits.cl", "collect_hits",
                         launch.with(query_defines(triangle_defines(bvh), used)), options.filter);
}

/// Finds hits in lists.
FindLists<Hit> finder(const Bvh& bvh, const Buffer<Ray>& rays, const QueryOptions& options) {
    const QueryLaunch launch(bvh.device());
    return [=, kernel = load(bvh, options, launch)](const Buffer<std::uint32_t>& offsets, const Buffer<Hit>& hits,
                                                    Buffer<std::uint32_t>& counts) mutable {
        kernel.run(launch.range(rays.size()), bvh, rays, std::uint32_t(rays.size()), arg("masks", options.ray_masks),
                   FilterData{options.filter}, arg("offsets", offsets), std::uint32_t(0), hits, arg("counts", counts));
    };
}

}  // namespace

void count_hits(const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint32_t>& counts, const QueryOptions& options) {
    check_sizes(rays.size(), counts.size(), options);
    count_results<Hit>(bvh, std::uint32_t(rays.size()), counts, finder(bvh, rays, options));
}

void nearest_hits(const Bvh& bvh, const Buffer<Ray>& rays, std::uint32_t most, Buffer<Hit>& hits,
                  Buffer<std::uint32_t>& counts, const QueryOptions& options) {
    check_sizes(rays.size(), counts.size(), options);
    if (hits.size() / std::max(1u, most) < rays.size() && most != 0)
        throw Error(ErrorKind::usage, std::to_string(rays.size()) + " rays with " + std::to_string(most) +
                                          " hits each do not fit into " + std::to_string(hits.size()) + " hits");
    if (rays.size() == 0) return;
    const QueryLaunch launch(bvh.device());
    load(bvh, options, launch)
        .run(launch.range(rays.size()), bvh, rays, std::uint32_t(rays.size()), arg("masks", options.ray_masks),
             FilterData{options.filter}, arg("offsets", nullptr), most, hits, arg("counts", counts));
}

Lists<Hit> all_hits(const Bvh& bvh, const Buffer<Ray>& rays, const QueryOptions& options) {
    check_sizes(rays.size(), rays.size(), options);
    return make_lists<Hit>(bvh, std::uint32_t(rays.size()), finder(bvh, rays, options)).lists;
}

std::vector<std::uint32_t> count_hits(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    Buffer<std::uint32_t> counts(bvh.device(), rays.size());
    count_hits(bvh, Buffer<Ray>(bvh.device(), rays), counts, options);
    return counts.read();
}

HostLists<Hit> all_hits(const Bvh& bvh, std::span<const Ray> rays, const QueryOptions& options) {
    return download(all_hits(bvh, Buffer<Ray>(bvh.device(), rays), options));
}

}  // namespace claray
