// claray.h: all hits of rays, and what overlaps boxes and spheres.
#include "claray/query/all_hits.hpp"
#include "claray/query/overlaps.hpp"
#include "host/capi/capi.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_lists {
    std::vector<std::uint32_t> offsets;
    std::vector<Hit> hits;
    std::vector<std::uint32_t> triangles;
    bool of_hits;
};

namespace {

static_assert(sizeof(Bounds) == 6 * sizeof(float) && sizeof(Sphere) == 4 * sizeof(float));

claray_lists* handle_of(HostLists<Hit>&& lists) {
    return new claray_lists{std::move(lists.offsets), std::move(lists.elements), {}, true};
}
claray_lists* handle_of(HostLists<std::uint32_t>&& lists) {
    return new claray_lists{std::move(lists.offsets), {}, std::move(lists.elements), false};
}

template <class Shape>
claray_status overlaps_of(const claray_bvh* bvh, const float* shapes, std::size_t count, const char* name,
                          claray_lists** lists, HostLists<std::uint32_t> (*query)(const Bvh&, std::span<const Shape>)) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        const auto given = array(reinterpret_cast<const Shape*>(shapes), count, name);
        hand_out(lists, "lists", [&] { return handle_of(query(over, given)); });
    });
}

claray_status count_overlaps(const claray_bvh* bvh, const float* shapes, std::size_t floats, std::size_t count,
                             const char* name, std::uint32_t* counts,
                             void (*query)(const Bvh&, const Buffer<float>&, Buffer<std::uint32_t>&)) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        if (count == 0) return;
        answer(over.device(), array(shapes, floats * count, name), counts, count, "counts",
               [&](const Buffer<float>& given, Buffer<std::uint32_t>& found) { query(over, given, found); });
    });
}

QueryOptions options_without_visits(const Bvh& over, const claray_query_options* options) {
    if (versioned(options, "options").visits) refuse("options.visits is not NULL", "these queries count no visits");
    return options_of(over.device(), options, nullptr);
}

}  // namespace

claray_status claray_count_hits(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint32_t* counts) {
    return claray_count_hits_with(bvh, rays, count, nullptr, counts);
}

claray_status claray_count_hits_with(const claray_bvh* bvh, const claray_ray* rays, size_t count,
                                     const claray_query_options* options, uint32_t* counts) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        const QueryOptions known = options_of(over.device(), options, nullptr);
        if (count == 0) return;
        answer(over.device(), rays_of(rays, count), counts, count, "counts",
               [&](const Buffer<Ray>& given, Buffer<std::uint32_t>& found) { count_hits(over, given, found, known); });
    });
}

claray_status claray_nearest_hits(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint32_t most,
                                  claray_hit* hits, uint32_t* counts) {
    return claray_nearest_hits_with(bvh, rays, count, most, nullptr, hits, counts);
}

claray_status claray_nearest_hits_with(const claray_bvh* bvh, const claray_ray* rays, size_t count, uint32_t most,
                                       const claray_query_options* options, claray_hit* hits, uint32_t* counts) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        const std::span all = rays_of(rays, count);
        const QueryOptions known = options_of(over.device(), options, nullptr);
        if (most == 0) refuse("most is 0", "ask for at least one hit");
        if (count == 0) return;
        const std::span found(reinterpret_cast<Hit*>(&required(hits, "hits")), count * most);
        const std::span numbers(&required(counts, "counts"), count);
        auto hit_buffer = Buffer<Hit>::under(over.device(), found);
        auto count_buffer = Buffer<std::uint32_t>::under(over.device(), numbers);
        nearest_hits(over, Buffer<Ray>::over(over.device(), all), most, hit_buffer, count_buffer, known);
        hit_buffer.fetch(found);
        count_buffer.fetch(numbers);
    });
}

claray_status claray_count_hits_enqueue(const claray_bvh* bvh, void* rays, void* counts, size_t count,
                                        const claray_query_options* options) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        auto found = shared<std::uint32_t>(over.device(), counts, count, "counts");
        count_hits(over, shared<Ray>(over.device(), rays, count, "rays"), found, options_without_visits(over, options));
    });
}

claray_status claray_nearest_hits_enqueue(const claray_bvh* bvh, void* rays, void* hits, void* counts, size_t count,
                                          uint32_t most, const claray_query_options* options) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        if (most == 0) refuse("most is 0", "ask for at least one hit");
        auto found = shared<Hit>(over.device(), hits, count * most, "hits");
        auto numbers = shared<std::uint32_t>(over.device(), counts, count, "counts");
        nearest_hits(over, shared<Ray>(over.device(), rays, count, "rays"), most, found, numbers,
                     options_without_visits(over, options));
    });
}

claray_status claray_all_hits_create(const claray_bvh* bvh, const claray_ray* rays, size_t count,
                                     const claray_query_options* options, claray_lists** lists) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        const QueryOptions known = options_of(over.device(), options, nullptr);
        hand_out(lists, "lists", [&] { return handle_of(all_hits(over, rays_of(rays, count), known)); });
    });
}

claray_status claray_box_overlaps_create(const claray_bvh* bvh, const float* boxes, size_t count,
                                         claray_lists** lists) {
    return overlaps_of<Bounds>(bvh, boxes, count, "boxes", lists, &box_overlaps);
}
claray_status claray_sphere_overlaps_create(const claray_bvh* bvh, const float* spheres, size_t count,
                                            claray_lists** lists) {
    return overlaps_of<Sphere>(bvh, spheres, count, "spheres", lists, &sphere_overlaps);
}
claray_status claray_count_box_overlaps(const claray_bvh* bvh, const float* boxes, size_t count, uint32_t* counts) {
    return count_overlaps(bvh, boxes, 6, count, "boxes", counts, &count_box_overlaps);
}
claray_status claray_count_sphere_overlaps(const claray_bvh* bvh, const float* spheres, size_t count,
                                           uint32_t* counts) {
    return count_overlaps(bvh, spheres, 4, count, "spheres", counts, &count_sphere_overlaps);
}

size_t claray_lists_count(const claray_lists* lists) { return lists ? lists->offsets.size() - 1 : 0; }
const uint32_t* claray_lists_offsets(const claray_lists* lists) { return lists ? lists->offsets.data() : nullptr; }
const claray_hit* claray_lists_hits(const claray_lists* lists) {
    return lists && lists->of_hits ? reinterpret_cast<const claray_hit*>(lists->hits.data()) : nullptr;
}
const uint32_t* claray_lists_triangles(const claray_lists* lists) {
    return lists && !lists->of_hits ? lists->triangles.data() : nullptr;
}
void claray_lists_release(claray_lists* lists) { delete lists; }
