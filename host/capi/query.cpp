// claray.h: queries by rays.
#include "host/capi/members.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

static_assert(sizeof(claray_ray) == sizeof(Ray) && sizeof(claray_hit) == sizeof(Hit));
static_assert(sizeof(claray_visits) == sizeof(Visits));

/// Calls `use` with a value of the type of the query's results.
template <class Use>
void with_result(const claray_query& query, const Use& use) {
    if (query.kind == CLARAY_QUERY_ANY)
        use(std::uint8_t());
    else if (query.of_instances)
        use(InstanceHit());
    else
        use(Hit());
}

void run(claray_query& query, const claray_ray* rays, std::size_t count, void* results) {
    if (count == 0) return;
    static_cast<void>(required(rays, "rays"));
    if (results == nullptr) refuse("results is NULL");
    with_result(query, [&](auto result) {
        query.query.run(rays_of(rays, count), std::span(static_cast<decltype(result)*>(results), count));
    });
    if (query.visits) query.options.visits.read(std::span(reinterpret_cast<Visits*>(query.visits), count));
}

void run_once(const claray_bvh* bvh, claray_query_kind kind, const claray_ray* rays, std::size_t count, void* results) {
    const std::unique_ptr<claray_query> query(query_of(required(bvh, "bvh").bvh, kind, nullptr, nullptr, false));
    run(*query, rays, count, results);
}

void enqueue(claray_query& query, cl_mem rays, cl_mem results, std::size_t count, const std::vector<cl::Event>& events,
             void** event) {
    const Device& device = query.query.device();
    const auto device_rays = Buffer<Ray>::adopt(device, rays, count);
    with_result(query, [&](auto result) {
        auto memory = Buffer<decltype(result)>::adopt(device, results, count);
        const cl::Event end = query.query.run(device_rays, memory, events, query.ray_number);
        if (event) hand_over(end, *event);
    });
}

HitFilter filter_of(const Device& device, const claray_hit_filter* given) {
    if (given == nullptr) return {};
    const claray_hit_filter known = versioned(given, "filter");
    if (known.source == nullptr) {
        if (known.first_geometry >= known.end_geometry)
            refuse("filter.source is NULL, and filter.end_geometry is not above filter.first_geometry",
                   "give a source or a range of geometries");
        return geometry_range(device, known.first_geometry, known.end_geometry);
    }
    HitFilter filter{text_of(known.name), known.source, {}};
    if (known.data_count != 0) filter.data = {device, array(known.data, known.data_count, "filter.data")};
    return filter;
}

/// One element for each ray, or none.
template <class T>
Buffer<T> per_ray(const Device& device, const void* given, const claray_query_options& options) {
    if (given == nullptr) return {};
    if (options.ray_count == 0) refuse("options.ray_count is 0", "give the number of elements for each ray");
    if (options.in_buffers != 0)
        return Buffer<T>::adopt(device, static_cast<cl_mem>(const_cast<void*>(given)), options.ray_count);
    return {device, std::span(static_cast<const T*>(given), options.ray_count)};
}

}  // namespace

namespace claray::capi {

std::span<const Ray> rays_of(const claray_ray* rays, std::size_t count) {
    return {reinterpret_cast<const Ray*>(count != 0 ? &required(rays, "rays") : rays), count};
}

QueryOptions options_of(const Device& device, const claray_query_options* given, claray_visits** visits) {
    const claray_query_options known = versioned(given, "options");
    QueryOptions options;
    options.cull_back_faces = known.cull_back_faces != 0;
    options.closed = known.closed != 0;
    options.brute_force = known.brute_force != 0;
    options.coherence = enumerator(known.coherence, "options.coherence");
    options.filter = filter_of(device, known.filter);
    options.ray_masks = per_ray<std::uint32_t>(device, known.ray_masks, known);
    options.ray_times = per_ray<float>(device, known.ray_times, known);
    options.visits = per_ray<Visits>(device, known.visits, known);
    if (visits && known.in_buffers == 0) *visits = static_cast<claray_visits*>(known.visits);
    return options;
}

}  // namespace claray::capi

claray_status claray_query_create(const claray_bvh* bvh, claray_query_kind kind, const claray_query_options* options,
                                  claray_device* queue, claray_query** query) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        hand_out(query, "query", [&] { return query_of(over, kind, options, queue, false); });
    });
}

claray_status claray_query_run(claray_query* query, const claray_ray* rays, size_t count, void* results) {
    return guarded([&] { run(required(query, "query"), rays, count, results); });
}

claray_status claray_query_enqueue(claray_query* query, void* rays, void* results, size_t count,
                                   const void* const* wait_for, size_t wait_count, void** event) {
    return guarded([&] {
        claray_query& enqueued = required(query, "query");
        enqueue(enqueued, static_cast<cl_mem>(rays), static_cast<cl_mem>(results), count,
                events_of(array(wait_for, wait_count, "wait_for"), "wait_for"), event);
    });
}

void claray_query_release(claray_query* query) { delete query; }

claray_status claray_closest_hit(const claray_bvh* bvh, const claray_ray* rays, size_t count, claray_hit* hits) {
    return guarded([&] { run_once(bvh, CLARAY_QUERY_CLOSEST, rays, count, hits); });
}

claray_status claray_any_hit(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint8_t* occluded) {
    return guarded([&] { run_once(bvh, CLARAY_QUERY_ANY, rays, count, occluded); });
}
