// Queries by points: the nearest point of a surface, whether a point is inside, and its signed distance.
#include "claray/query/points.hpp"

#include "arrays.hpp"

namespace claray::python {
namespace {

using Points = Input<float, nb::shape<-1, 3>>;
using Words = Input<std::uint32_t, nb::shape<-1>>;

PointOptions options_of(const Device& device, float reach, const Words& masks, bool vote = false) {
    PointOptions options;
    options.vote = vote;
    options.reach = reach;
    if (masks.size() != 0) options.masks = Buffer<std::uint32_t>::over(device, span_of<std::uint32_t>(masks));
    return options;
}

/// Runs `query(points, answers)` with the points and the results in buffers.
template <class Answer, class Query>
void answer(const PyBvh& self, const Points& points, std::span<Answer> answers, const Query& query) {
    without_gil(self.device, [&] {
        const Device& device = self.bvh.device();
        const auto given = Buffer<float>::over(device, span_of<float>(points));
        auto found = Buffer<Answer>::under(device, answers);
        query(given, found);
        found.fetch(answers);
    });
}

void nearest(const PyBvh& self, const Points& points, float reach, const Words& masks,
             const Output<std::uint8_t, nb::shape<-1, sizeof(NearestPoint)>>& out) {
    answer(self, points, std::span(reinterpret_cast<NearestPoint*>(out.data()), out.shape(0)),
           [&](const Buffer<float>& given, Buffer<NearestPoint>& found) {
               nearest_point(self.bvh, given, found, options_of(self.bvh.device(), reach, masks));
           });
}

void are_inside(const PyBvh& self, const Points& points, bool vote, const Output<std::uint8_t, nb::shape<-1>>& out) {
    PointOptions options;
    options.vote = vote;
    answer(self, points, std::span(out.data(), out.size()),
           [&](const Buffer<float>& given, Buffer<std::uint8_t>& found) { inside(self.bvh, given, found, options); });
}

void signed_distances(const PyBvh& self, const Points& points, float reach, const Words& masks, bool vote,
                      const Output<float, nb::shape<-1>>& out) {
    answer(self, points, std::span(out.data(), out.size()), [&](const Buffer<float>& given, Buffer<float>& found) {
        signed_distance(self.bvh, given, found, options_of(self.bvh.device(), reach, masks, vote));
    });
}

}  // namespace

void bind_points(nb::module_& module) {
    module.def("nearest_point", &nearest);
    module.def("inside", &are_inside);
    module.def("signed_distance", &signed_distances);
}

}  // namespace claray::python
