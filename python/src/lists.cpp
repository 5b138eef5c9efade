// Queries that find any number of things: all hits of rays, triangles that overlap boxes and spheres.
#include "claray/query/all_hits.hpp"

#include <nanobind/stl/string.h>

#include "arrays.hpp"
#include "claray/query/overlaps.hpp"
#include "structures.hpp"

namespace claray::python {
namespace {

using Words = Input<std::uint32_t, nb::shape<-1>>;
using WordsOut = Output<std::uint32_t, nb::shape<-1>>;
using PackedRays = Input<float, nb::shape<-1, 8>>;

/// What counts as a hit.
struct Sides {
    bool cull_back_faces, closed;
};

QueryOptions options_of(const Device& device, const Sides& sides, const Words& masks, const PyFilter& filter) {
    QueryOptions options;
    options.cull_back_faces = sides.cull_back_faces, options.closed = sides.closed;
    if (masks.size() != 0) options.ray_masks = Buffer<std::uint32_t>::over(device, span_of<std::uint32_t>(masks));
    options.filter = filter_of(device, filter);
    return options;
}

void count(const PyBvh& self, const PackedRays& rays, bool cull_back_faces, bool closed, const Words& masks,
           const PyFilter& filter, const WordsOut& out) {
    without_gil(self.device, [&] {
        const Device& device = self.bvh.device();
        const auto given = Buffer<Ray>::over(device, span_of<Ray>(rays, 8));
        const std::span counts(out.data(), out.size());
        auto found = Buffer<std::uint32_t>::under(device, counts);
        count_hits(self.bvh, given, found, options_of(device, {cull_back_faces, closed}, masks, filter));
        found.fetch(counts);
    });
}

void nearest(const PyBvh& self, const PackedRays& rays, std::uint32_t most, bool cull_back_faces, bool closed,
             const Words& masks, const PyFilter& filter,
             const Output<std::uint8_t, nb::shape<-1, -1, sizeof(Hit)>>& hits, const WordsOut& counts) {
    without_gil(self.device, [&] {
        const Device& device = self.bvh.device();
        const auto given = Buffer<Ray>::over(device, span_of<Ray>(rays, 8));
        const std::span found_hits(reinterpret_cast<Hit*>(hits.data()), hits.shape(0) * hits.shape(1));
        const std::span found_counts(counts.data(), counts.size());
        auto hit_buffer = Buffer<Hit>::under(device, found_hits);
        auto count_buffer = Buffer<std::uint32_t>::under(device, found_counts);
        nearest_hits(self.bvh, given, most, hit_buffer, count_buffer,
                     options_of(device, {cull_back_faces, closed}, masks, filter));
        hit_buffer.fetch(found_hits);
        count_buffer.fetch(found_counts);
    });
}

/// Offsets, and elements of `columns` numbers.
template <class Number, class Element>
Tuple as_tuple(HostLists<Element>&& lists, std::vector<std::size_t> columns) {
    columns.insert(columns.begin(), lists.elements.size());
    const std::size_t offsets = lists.offsets.size();
    return nb::make_tuple(array_of<std::uint32_t>(std::move(lists.offsets), {offsets}),
                          array_of<Number>(std::move(lists.elements), columns));
}

Tuple all(const PyBvh& self, const PackedRays& rays, bool cull_back_faces, bool closed, const Words& masks,
              const PyFilter& filter) {
    HostLists<Hit> lists = without_gil(self.device, [&] {
        return all_hits(self.bvh, span_of<Ray>(rays, 8),
                        options_of(self.bvh.device(), {cull_back_faces, closed}, masks, filter));
    });
    return as_tuple<std::uint8_t>(std::move(lists), {sizeof(Hit)});
}

Tuple boxes(const PyBvh& self, const Input<float, nb::shape<-1, 6>>& given) {
    HostLists<std::uint32_t> lists =
        without_gil(self.device, [&] { return box_overlaps(self.bvh, span_of<Bounds>(given, 6)); });
    return as_tuple<std::uint32_t>(std::move(lists), {});
}

Tuple spheres(const PyBvh& self, const Input<float, nb::shape<-1, 4>>& given) {
    HostLists<std::uint32_t> lists =
        without_gil(self.device, [&] { return sphere_overlaps(self.bvh, span_of<Sphere>(given, 4)); });
    return as_tuple<std::uint32_t>(std::move(lists), {});
}

void count_spheres(const PyBvh& self, const Input<float, nb::shape<-1, 4>>& given, const WordsOut& out) {
    without_gil(self.device, [&] {
        const Device& device = self.bvh.device();
        const auto spheres = Buffer<float>::over(device, span_of<float>(given));
        const std::span counts(out.data(), out.size());
        auto found = Buffer<std::uint32_t>::under(device, counts);
        count_sphere_overlaps(self.bvh, spheres, found);
        found.fetch(counts);
    });
}

}  // namespace

HitFilter filter_of(const Device& device, const PyFilter& filter) {
    if (filter.source.empty()) return {};
    return {filter.name, filter.source, Buffer<float>(device, filter.data)};
}

void bind_lists(nb::module_& module) {
    nb::class_<PyFilter>(module, "NativeFilter")
        .def(nb::init<>())
        .def("__init__", [](PyFilter* self, const std::string& name, const std::string& source,
                            const Input<float, nb::shape<-1>>& data) {
            const auto floats = span_of<float>(data);
            new (self) PyFilter{name, source, {floats.begin(), floats.end()}};
        });
    module.def("count_hits", &count);
    module.def("nearest_hits", &nearest);
    module.def("all_hits", &all);
    module.def("box_overlaps", &boxes);
    module.def("sphere_overlaps", &spheres);
    module.def("count_sphere_overlaps", &count_spheres);
}

}  // namespace claray::python
