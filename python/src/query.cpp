// Queries over arrays of NumPy, in place where the device's memory is the host's, and over buffers of the device.
#include "claray/query.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <optional>
#include <variant>

#include "arrays.hpp"
#include "pack_rays.hpp"
#include "structures.hpp"

namespace claray::python {
namespace {

/// float32 or float64, of any strides.
using AnyColumns = nb::ndarray<nb::ro, nb::device::cpu>;
using Words = Input<std::uint32_t, nb::shape<-1>>;
using Floats = Input<float, nb::shape<-1>>;
using Bytes = Output<std::uint8_t, nb::shape<-1, -1>>;  // a row for each result
using PackedRays = Input<float, nb::shape<-1, 8>>;

using Structure = std::variant<Bvh, InstancedBvh, Primitives>;

struct PyQuery {
    PyDevice device;  // with the queue
    Kept<Structure> structure;
    QueryKind kind = QueryKind::closest;
    Kept<QueryOptions> options;
    Kept<std::optional<Query>> query;                      // none for primitives
    std::shared_ptr<const CurrentInstances> follows = {};  // of instances that come and go
    unsigned replaced = 0;
};

std::optional<Query> query_over(const Structure& structure, QueryKind kind, const QueryOptions& options,
                                const Device& queue) {
    if (const auto* bvh = std::get_if<Bvh>(&structure)) return Query(*bvh, kind, options, queue);
    if (const auto* instances = std::get_if<InstancedBvh>(&structure)) return Query(*instances, kind, options, queue);
    return {};
}

Structure structure_of(const PyBvh& of) { return of.bvh; }
Structure structure_of(const PyInstancedBvh& of) { return of.current->bvh; }
Structure structure_of(const PyPrimitives& of) { return of.primitives; }

/// Takes the structure that is traced now, where it was replaced.
void follow(PyQuery& self) {
    if (!self.follows || self.follows->replaced == self.replaced) return;
    self.replaced = self.follows->replaced;
    self.structure = Structure(self.follows->bvh);
    self.query = query_over(self.structure, self.kind, self.options, self.device.device);
}

template <class Of>
PyQuery make_query(const Of& of, const PyDevice& queue, bool any, bool cull_back_faces, bool closed, bool brute_force,
                   int coherence, const PyFilter& filter) {
    const QueryKind kind = any ? QueryKind::any : QueryKind::closest;
    QueryOptions options;
    options.cull_back_faces = cull_back_faces;
    options.closed = closed;
    options.brute_force = brute_force;
    options.coherence = Coherence(coherence);
    return without_gil(queue, [&] {
        options.filter = filter_of(queue.device, filter);
        const Structure structure = structure_of(of);
        PyQuery query{queue, structure, kind, options, query_over(structure, kind, options, queue.device)};
        if constexpr (std::is_same_v<Of, PyInstancedBvh>)
            query.follows = of.current, query.replaced = of.current->replaced;
        return query;
    });
}

Columns columns_of(const AnyColumns& array) {
    const bool doubles = array.dtype().bits == 64;
    const auto bytes = std::ptrdiff_t(array.dtype().bits / 8);
    return {array.data(), array.stride(0) * bytes, array.ndim() > 1 ? array.stride(1) * bytes : 0, doubles};
}

/// One element is for all rays.
Columns ends_of(const AnyColumns& array) {
    Columns columns = columns_of(array);
    if (array.shape(0) == 1) columns.row_stride = 0;
    return columns;
}

/// Rays that are packed in pieces, so that scratch memory is bounded.
constexpr std::size_t most_rays_at_once = std::size_t(1) << 22;

template <class Result>
std::span<Result> results_of(const Bytes& out, std::size_t first, std::size_t count) {
    return {reinterpret_cast<Result*>(out.data()) + first, count};
}

/// Masks and times, one for each ray or empty.
struct PerRay {
    const Words& masks;
    const Floats& times;
};

template <class Result>
cl::Event enqueue(PyQuery& self, const Buffer<Ray>& rays, Buffer<Result>& results,
                  const std::vector<cl::Event>& wait_for) {
    if (self.query) return self.query->run(rays, results, wait_for);
    self.device.device.wait_for(wait_for);
    const Primitives& primitives = std::get<Primitives>(self.structure);
    if constexpr (std::is_same_v<Result, Hit>)
        closest_hit(primitives, rays, results, self.options);
    else if constexpr (std::is_same_v<Result, std::uint8_t>)
        any_hit(primitives, rays, results, self.options);
    return self.device.device.event();
}

template <class Result>
void run_host(PyQuery& self, std::span<const Ray> rays, std::span<Result> results, const PerRay& per_ray,
              std::size_t first) {
    const Device& device = self.device.device;
    std::optional<Query> query = self.query;
    if (per_ray.masks.size() + per_ray.times.size() != 0) {
        QueryOptions options = self.options;
        if (per_ray.masks.size() != 0)
            options.ray_masks =
                Buffer<std::uint32_t>::over(device, span_of<std::uint32_t>(per_ray.masks).subspan(first, rays.size()));
        if (per_ray.times.size() != 0)
            options.ray_times = Buffer<float>::over(device, span_of<float>(per_ray.times).subspan(first, rays.size()));
        query = query_over(self.structure, self.kind, options, device);
    }
    if (query) return query->run(rays, results);
    const auto given = Buffer<Ray>::over(device, rays);
    auto found = Buffer<Result>::under(device, results);
    enqueue(self, given, found, {});
    found.fetch(results);
}

/// Calls `use` with a value of the type of the query's results.
template <class Use>
auto with_result(const PyQuery& self, const Use& use) {
    if (self.kind == QueryKind::any) return use(std::uint8_t());
    return std::holds_alternative<InstancedBvh>(self.structure) ? use(InstanceHit()) : use(Hit());
}

void run_piece(PyQuery& self, std::span<const Ray> rays, const PerRay& per_ray, const Bytes& out, std::size_t first) {
    with_result(self, [&](auto result) {
        run_host(self, rays, results_of<decltype(result)>(out, first, rays.size()), per_ray, first);
    });
}

std::int64_t signed_row(std::size_t bad) { return bad == all_finite ? std::int64_t(-1) : std::int64_t(bad); }

/// Returns the first row that is not finite, or -1. All other rays are traced.
std::int64_t run_columns(PyQuery& self, const AnyColumns& origins, const AnyColumns& directions, const AnyColumns& tmin,
                         const AnyColumns& tmax, const Words& masks, const Floats& times, const Bytes& out) {
    const RayColumns columns{columns_of(origins), columns_of(directions), ends_of(tmin), ends_of(tmax)};
    const std::size_t count = out.shape(0);
    return without_gil(self.device, [&] {
        follow(self);
        std::size_t bad = all_finite;
        std::vector<Ray>& scratch = *self.device.scratch;
        if (scratch.size() < std::min(count, most_rays_at_once)) scratch.resize(std::min(count, most_rays_at_once));
        for (std::size_t first = 0; first < count; first += most_rays_at_once) {
            const std::span rays(scratch.data(), std::min(most_rays_at_once, count - first));
            bad = std::min(bad, pack_rays(rays, columns, first));
            run_piece(self, rays, {masks, times}, out, first);
        }
        return signed_row(bad);
    });
}

/// Returns the first row that is not finite, or -1.
std::int64_t pack(const AnyColumns& origins, const AnyColumns& directions, const AnyColumns& tmin,
                  const AnyColumns& tmax, const Output<float, nb::shape<-1, 8>>& out) {
    const RayColumns columns{columns_of(origins), columns_of(directions), ends_of(tmin), ends_of(tmax)};
    const nb::gil_scoped_release release;
    return signed_row(pack_rays({reinterpret_cast<Ray*>(out.data()), out.shape(0)}, columns, 0));
}

std::int64_t run_packed(PyQuery& self, const PackedRays& rays, const Words& masks, const Floats& times,
                        const Bytes& out, bool check) {
    const std::span<const Ray> all = span_of<Ray>(rays, 8);
    return without_gil(self.device, [&] {
        follow(self);
        const std::size_t bad = check ? first_not_finite(all) : all_finite;
        if (bad == all_finite) run_piece(self, all, {masks, times}, out, 0);
        return signed_row(bad);
    });
}

/// Buffers of the device, by their cl_mem. The caller keeps them alive until the event is complete.
PyEvent run_buffers(PyQuery& self, std::uintptr_t rays, std::uintptr_t results, std::size_t count,
                    const std::vector<PyEvent>& wait_for) {
    return without_gil(self.device, [&] {
        follow(self);
        const Device& device = self.device.device;
        const auto device_rays = Buffer<Ray>::adopt(device, reinterpret_cast<cl_mem>(rays), count);
        return with_result(self, [&](auto result) {
            auto memory = Buffer<decltype(result)>::adopt(device, reinterpret_cast<cl_mem>(results), count);
            return PyEvent(enqueue(self, device_rays, memory, {wait_for.begin(), wait_for.end()}));
        });
    });
}

}  // namespace

void bind_query(nb::module_& module) {
    // nanobind leaves the type of numbers out where an array may have several.
    module.def(
        "pack_rays", &pack,
        nb::sig(
            "def pack_rays(origins: numpy.typing.NDArray[typing.Any], directions: numpy.typing.NDArray[typing.Any], "
            "tmin: numpy.typing.NDArray[typing.Any], tmax: numpy.typing.NDArray[typing.Any], "
            "out: numpy.typing.NDArray[numpy.float32], /) -> int"));
    nb::class_<PyQuery>(module, "NativeQuery")
        .def_static("make", &make_query<PyBvh>)
        .def_static("make", &make_query<PyInstancedBvh>)
        .def_static("make", &make_query<PyPrimitives>)
        .def("run_columns", &run_columns,
             nb::sig("def run_columns(self, origins: numpy.typing.NDArray[typing.Any], directions: "
                     "numpy.typing.NDArray[typing.Any], "
                     "tmin: numpy.typing.NDArray[typing.Any], tmax: numpy.typing.NDArray[typing.Any], "
                     "masks: numpy.typing.NDArray[numpy.uint32], times: numpy.typing.NDArray[numpy.float32], "
                     "out: numpy.typing.NDArray[numpy.uint8], /) -> int"))
        .def("run_packed", &run_packed)
        .def("run_buffers", &run_buffers)
        .def("device", [](const PyQuery& self) { return self.device; });
}

}  // namespace claray::python
