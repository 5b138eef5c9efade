#include "host/trace/query_options.hpp"

#include "host/bvh/bvh_state.hpp"

namespace claray {

Defines triangle_defines(const Bvh& bvh) {
    require_triangles(bvh, "a query of triangles");
    return bvh.defines();
}

Defines query_defines(Defines defines, const QueryOptions& options) {
    if (options.cull_back_faces) defines.emplace_back("CULL_BACK_FACES", "1");
    if (options.closed) defines.emplace_back("CLARAY_CLOSED_TRIANGLES", "1");
    if (options.ray_masks.allocated()) defines.emplace_back("CLARAY_RAY_MASKS", "1");
    if (options.visits.allocated()) defines.emplace_back("CLARAY_COUNT_VISITS", "1");
    return defines;
}

Defines solid_defines(const Bvh& bvh) {
    Defines defines = triangle_defines(bvh);
    std::erase_if(defines, [](const auto& define) { return define.first == "CLARAY_CUTOUTS"; });
    return defines;
}

void check_sizes(std::size_t rays, std::size_t results, const QueryOptions& options) {
    if (rays > 4'000'000'000)  // the ticket of kernels/trace/queue/ray_queue.clh exceeds the last ray and must not wrap
        throw Error(ErrorKind::usage, std::to_string(rays) + " rays are too many for one query",
                    "trace at most 4e9 rays at a time");
    const bool short_masks = options.ray_masks.allocated() && options.ray_masks.size() < rays;
    const bool short_times = options.ray_times.allocated() && options.ray_times.size() < rays;
    const bool short_visits = options.visits.allocated() && options.visits.size() < rays;
    if (results < rays || short_masks || short_times || short_visits)
        throw Error(ErrorKind::usage, "a query of " + std::to_string(rays) + " rays needs the same number of " +
                                          (results < rays ? "results"
                                           : short_masks  ? "ray masks"
                                           : short_times  ? "ray times"
                                                          : "visits"));
}

}  // namespace claray
