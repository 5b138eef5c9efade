// claray.h: queries by points.
#include "claray/query/points.hpp"

#include "host/capi/capi.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

static_assert(sizeof(claray_nearest) == sizeof(NearestPoint));

void check_reach(float reach, const char* name) {
    if (!(reach >= 0)) refuse(std::string(name) + " is " + std::to_string(reach), "use 0 or more");
}

PointOptions options_of(const Device& device, const claray_point_options& given, std::size_t count) {
    check_reach(given.reach, "options.reach");
    PointOptions options;
    if (given.reach > 0) options.reach = given.reach;
    options.brute_force = given.brute_force != 0;
    options.sort = given.unsorted == 0;
    options.vote = given.vote != 0;
    if (given.masks) options.masks = {device, std::span(given.masks, count)};
    if (given.visits) options.visits = {device, count};
    return options;
}

template <class Answer>
using PointQuery = void (*)(const Bvh&, const Buffer<float>&, Buffer<Answer>&, const PointOptions&);

template <class Answer>
void answer_points(const Bvh& over, const float* points, std::size_t count, Answer* answers, const char* name,
                   const PointOptions& options, PointQuery<Answer> query) {
    answer(over.device(), array(points, 3 * count, "points"), answers, count, name,
           [&](const Buffer<float>& given, Buffer<Answer>& found) { query(over, given, found, options); });
}

template <class Answer>
claray_status query_points(const claray_bvh* bvh, const float* points, std::size_t count, Answer* answers,
                           const char* name, const claray_point_options* options, PointQuery<Answer> query) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        const claray_point_options given = versioned(options, "options");
        const PointOptions known = options_of(over.device(), given, count);
        if (count == 0) return;
        answer_points(over, points, count, answers, name, known, query);
        if (given.visits) known.visits.read(std::span(reinterpret_cast<Visits*>(given.visits), count));
    });
}

template <class Answer>
void enqueue_points(const Bvh& over, void* points, void* answers, std::size_t count, const PointOptions& options,
                    PointQuery<Answer> query) {
    auto found = shared<Answer>(over.device(), answers, count, "answers");
    query(over, shared<float>(over.device(), points, 3 * count, "points"), found, options);
}

}  // namespace

claray_status claray_nearest_point(const claray_bvh* bvh, const float* points, size_t count, float reach,
                                   claray_nearest* nearest) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        check_reach(reach, "reach");
        PointOptions options;
        options.reach = reach;
        if (count != 0)
            answer_points<NearestPoint>(over, points, count, reinterpret_cast<NearestPoint*>(nearest), "nearest",
                                        options, &nearest_point);
    });
}
claray_status claray_nearest_point_with(const claray_bvh* bvh, const float* points, size_t count,
                                        const claray_point_options* options, claray_nearest* nearest) {
    return query_points<NearestPoint>(bvh, points, count, reinterpret_cast<NearestPoint*>(nearest), "nearest", options,
                                      &nearest_point);
}

claray_status claray_inside(const claray_bvh* bvh, const float* points, size_t count, uint8_t* inside_of) {
    return claray_inside_with(bvh, points, count, nullptr, inside_of);
}
claray_status claray_inside_with(const claray_bvh* bvh, const float* points, size_t count,
                                 const claray_point_options* options, uint8_t* inside_of) {
    return query_points<std::uint8_t>(bvh, points, count, inside_of, "inside", options, &inside);
}

claray_status claray_signed_distance(const claray_bvh* bvh, const float* points, size_t count, float* distances) {
    return claray_signed_distance_with(bvh, points, count, nullptr, distances);
}
claray_status claray_signed_distance_with(const claray_bvh* bvh, const float* points, size_t count,
                                          const claray_point_options* options, float* distances) {
    return query_points<float>(bvh, points, count, distances, "distances", options, &signed_distance);
}

claray_status claray_points_enqueue(const claray_bvh* bvh, claray_point_query query, void* points, void* answers,
                                    size_t count, const claray_point_options* options) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        const claray_point_options given = versioned(options, "options");
        if (given.visits) refuse("options.visits is not NULL", "these queries count no visits");
        const PointOptions known = options_of(over.device(), given, count);
        const int kind = number_of(query);
        if (kind == CLARAY_POINT_NEAREST)
            enqueue_points<NearestPoint>(over, points, answers, count, known, &nearest_point);
        else if (kind == CLARAY_POINT_INSIDE)
            enqueue_points<std::uint8_t>(over, points, answers, count, known, &inside);
        else if (kind == CLARAY_POINT_SIGNED_DISTANCE)
            enqueue_points<float>(over, points, answers, count, known, &signed_distance);
        else
            refuse("query is " + std::to_string(kind), "use a claray_point_query");
    });
}
