// claray.h: queries by points.
#include "claray/query/points.hpp"

#include "host/capi/capi.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

static_assert(sizeof(claray_nearest) == sizeof(NearestPoint));

template <class Answer, class Query>
claray_status answer_points(const claray_bvh* bvh, const float* points, std::size_t count, Answer* answers,
                            const char* name, const Query& query) {
    return guarded([&] {
        const Bvh& over = required(bvh, "bvh").bvh;
        if (count == 0) return;
        answer(over.device(), array(points, 3 * count, "points"), answers, count, name,
               [&](const Buffer<float>& given, Buffer<Answer>& found) { query(over, given, found); });
    });
}

}  // namespace

claray_status claray_nearest_point(const claray_bvh* bvh, const float* points, size_t count, float reach,
                                   claray_nearest* nearest) {
    return answer_points(bvh, points, count, reinterpret_cast<NearestPoint*>(nearest), "nearest",
                         [&](const Bvh& over, const Buffer<float>& given, Buffer<NearestPoint>& found) {
                             if (!(reach >= 0))
                                 throw Error(ErrorKind::usage, "reach is " + std::to_string(reach), "use 0 or more");
                             PointOptions options;
                             options.reach = reach;
                             nearest_point(over, given, found, options);
                         });
}

claray_status claray_inside(const claray_bvh* bvh, const float* points, size_t count, uint8_t* inside_of) {
    return answer_points(
        bvh, points, count, inside_of, "inside",
        [](const Bvh& over, const Buffer<float>& given, Buffer<std::uint8_t>& found) { inside(over, given, found); });
}

claray_status claray_signed_distance(const claray_bvh* bvh, const float* points, size_t count, float* distances) {
    return answer_points(
        bvh, points, count, distances, "distances",
        [](const Bvh& over, const Buffer<float>& given, Buffer<float>& found) { signed_distance(over, given, found); });
}
