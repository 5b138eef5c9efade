#include "host/trace/lists/filter.hpp"

#include <bit>

#include "host/trace/query_launch.hpp"
#include "host/trace/query_options.hpp"

namespace claray {
namespace {

template <class Result>
void run_accepted(const Device& queue, const Bvh& bvh, const std::string& function, const Buffer<Ray>& rays,
                  const Buffer<Result>& results, const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    if (options.brute_force || options.visits.allocated())
        throw Error(ErrorKind::usage, "a query with a filter supports neither brute force nor visits");
    if (rays.size() == 0) return;
    const QueryLaunch launch(queue);
    load_filtered(queue, "trace/lists/filtered_hits.cl", function,
                  launch.with(query_defines(triangle_defines(bvh), options)), options.filter)
        .run(launch.range(rays.size()), bvh, rays, std::uint32_t(rays.size()), arg("count", count),
             arg("masks", options.ray_masks), FilterData{options.filter}, results);
}

}  // namespace

Kernel load_filtered(const Device& device, const std::string& file, const std::string& function, const Defines& defines,
                     const HitFilter& filter) {
    if (filter.source.empty()) return load_kernel(device, file, function, defines);
    return compile_kernel(device,
                          "#include \"claray/shared/types.h\"\n#include \"compute/portable.clh\"\n#define HIT_FILTER "
                          "1\n#line 1 \"" +
                              filter.name + "\"\n" + filter.source + "\n#include \"" + file + "\"\n",
                          function, defines, Math::strict, filter.name + ".cl");
}

HitFilter geometry_range(const Device& device, std::uint32_t first, std::uint32_t end) {
    return {"geometry_range",
            "static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit) "
            "{\n    return hit->geometry >= as_uint(data[0]) && hit->geometry < as_uint(data[1]);\n}\n",
            Buffer<float>(device, std::vector<float>{std::bit_cast<float>(first), std::bit_cast<float>(end)})};
}

void closest_accepted(const Device& queue, const Bvh& bvh, const Buffer<Ray>& rays, Buffer<Hit>& hits,
                      const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    run_accepted(queue, bvh, "closest_accepted", rays, hits, options, count);
}
void any_accepted(const Device& queue, const Bvh& bvh, const Buffer<Ray>& rays, Buffer<std::uint8_t>& occluded,
                  const QueryOptions& options, const Buffer<std::uint32_t>& count) {
    run_accepted(queue, bvh, "any_accepted", rays, occluded, options, count);
}

}  // namespace claray
