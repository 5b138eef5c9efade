// Queries over arrays of NumPy, in place where the device's memory is the host's, and over buffers of the device.
#include "claray/query.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <variant>

#include "arrays.hpp"
#include "pack_rays.hpp"

namespace claray::python {
namespace {

/// float32 or float64, of any strides.
using AnyColumns = nb::ndarray<nb::ro, nb::device::cpu>;
using Words = Input<std::uint32_t, nb::shape<-1>>;
using Bytes = Output<std::uint8_t, nb::shape<-1, -1>>;  // a row for each result
using PackedRays = Input<float, nb::shape<-1, 8>>;

struct PyQuery {
    PyDevice device;  // with the queue
    Bvh bvh;
    QueryKind kind = QueryKind::closest;
    QueryOptions options;
    Query query;
};

PyQuery make_query(const PyBvh& bvh, const PyDevice& queue, bool any, bool cull_back_faces, bool closed,
                   bool brute_force, int coherence) {
    const QueryKind kind = any ? QueryKind::any : QueryKind::closest;
    QueryOptions options;
    options.cull_back_faces = cull_back_faces;
    options.closed = closed;
    options.brute_force = brute_force;
    options.coherence = Coherence(coherence);
    return without_gil(queue, [&] {
        return PyQuery{queue, bvh.bvh, kind, options, Query(bvh.bvh, kind, options, queue.device)};
    });
}

Columns columns_of(const AnyColumns& array) {
    const bool doubles = array.dtype().bits == 64;
    const auto bytes = std::ptrdiff_t(array.dtype().bits / 8);
    return {array.data(), array.stride(0) * bytes, array.ndim() > 1 ? array.stride(1) * bytes : 0, doubles};
}

/// Rays that are packed in pieces, so that scratch memory is bounded.
constexpr std::size_t most_rays_at_once = std::size_t(1) << 22;

template <class Result>
std::span<Result> results_of(const Bytes& out, std::size_t first, std::size_t count) {
    return {reinterpret_cast<Result*>(out.data()) + first, count};
}

void run_piece(PyQuery& self, std::span<const Ray> rays, const Words& masks, const Bytes& out, std::size_t first) {
    Query query = self.query;
    if (masks.size() != 0) {
        QueryOptions options = self.options;
        options.ray_masks =
            Buffer<std::uint32_t>::over(self.device.device, span_of<std::uint32_t>(masks).subspan(first, rays.size()));
        query = Query(self.bvh, self.kind, options, self.device.device);
    }
    if (self.kind == QueryKind::closest)
        query.run(rays, results_of<Hit>(out, first, rays.size()));
    else
        query.run(rays, results_of<std::uint8_t>(out, first, rays.size()));
}

std::int64_t signed_row(std::size_t bad) { return bad == all_finite ? std::int64_t(-1) : std::int64_t(bad); }

/// Returns the first row that is not finite, or -1. All other rays are traced.
std::int64_t run_columns(PyQuery& self, const AnyColumns& origins, const AnyColumns& directions, const AnyColumns& tmin,
                         const AnyColumns& tmax, const Words& masks, const Bytes& out) {
    const RayColumns columns{columns_of(origins), columns_of(directions), columns_of(tmin), columns_of(tmax)};
    const std::size_t count = out.shape(0);
    return without_gil(self.device, [&] {
        std::size_t bad = all_finite;
        std::vector<Ray>& scratch = *self.device.scratch;
        if (scratch.size() < std::min(count, most_rays_at_once)) scratch.resize(std::min(count, most_rays_at_once));
        for (std::size_t first = 0; first < count; first += most_rays_at_once) {
            const std::span rays(scratch.data(), std::min(most_rays_at_once, count - first));
            bad = std::min(bad, pack_rays(rays, columns, first));
            run_piece(self, rays, masks, out, first);
        }
        return signed_row(bad);
    });
}

/// Returns the first row that is not finite, or -1.
std::int64_t pack(const AnyColumns& origins, const AnyColumns& directions, const AnyColumns& tmin,
                  const AnyColumns& tmax, const Output<float, nb::shape<-1, 8>>& out) {
    const RayColumns columns{columns_of(origins), columns_of(directions), columns_of(tmin), columns_of(tmax)};
    const nb::gil_scoped_release release;
    return signed_row(pack_rays({reinterpret_cast<Ray*>(out.data()), out.shape(0)}, columns, 0));
}

std::int64_t run_packed(PyQuery& self, const PackedRays& rays, const Words& masks, const Bytes& out, bool check) {
    const std::span<const Ray> all = span_of<Ray>(rays, 8);
    return without_gil(self.device, [&] {
        const std::size_t bad = check ? first_not_finite(all) : all_finite;
        if (bad == all_finite) run_piece(self, all, masks, out, 0);
        return signed_row(bad);
    });
}

/// Buffers of the device, by their cl_mem. The caller keeps them alive until the event is complete.
cl::Event run_buffers(PyQuery& self, std::uintptr_t rays, std::uintptr_t results, std::size_t count,
                      const std::vector<cl::Event>& wait_for) {
    return without_gil(self.device, [&] {
        const Device& device = self.device.device;
        const auto device_rays = Buffer<Ray>::adopt(device, reinterpret_cast<cl_mem>(rays), count);
        const auto memory = reinterpret_cast<cl_mem>(results);
        if (self.kind == QueryKind::closest) {
            auto hits = Buffer<Hit>::adopt(device, memory, count);
            return self.query.run(device_rays, hits, wait_for);
        }
        auto occluded = Buffer<std::uint8_t>::adopt(device, memory, count);
        return self.query.run(device_rays, occluded, wait_for);
    });
}

}  // namespace

void bind_query(nb::module_& module) {
    module.def("pack_rays", &pack);
    nb::class_<PyQuery>(module, "NativeQuery")
        .def_static("make", &make_query)
        .def("run_columns", &run_columns)
        .def("run_packed", &run_packed)
        .def("run_buffers", &run_buffers)
        .def("device", [](const PyQuery& self) { return self.device; });
}

}  // namespace claray::python
