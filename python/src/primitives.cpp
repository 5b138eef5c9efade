// Structures over geometry that is not triangles.
#include "claray/primitives/primitives.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "claray/primitives/curves.hpp"
#include "structures.hpp"

namespace claray::python {
namespace {

using Floats = Input<float, nb::shape<-1>>;

PrimitiveKind own_kind(const std::string& name) {
    if (name == "round" || name == "flat") return curve_kind(name == "flat" ? CurveShape::flat : CurveShape::round);
    return name == "discs" ? disc_kind() : name == "cylinders" ? cylinder_kind() : sphere_kind();
}

PyPrimitives build_kind(const PyDevice& device, const PrimitiveKind& kind, const Floats& data, std::uint32_t count,
                        const Bvh::Config& config) {
    return without_gil(device, [&] {
        const Buffer<float> floats(device.device, span_of<float>(data));
        return PyPrimitives{device, Primitives::build(device.device, kind, floats, count, config)};
    });
}

PyPrimitives build(const PyDevice& device, const std::string& kind, const Floats& data, std::uint32_t count,
                   const std::string& builder) {
    return build_kind(device, own_kind(kind), data, count, config_of(builder));
}

PyPrimitives build_text(const PyDevice& device, const std::string& name, const std::string& source, const Floats& data,
                        std::uint32_t count, const std::string& builder) {
    return build_kind(device, {name, source, 0}, data, count, config_of(builder));
}

/// 16 floats for each segment.
nb::object data_of_curves(const Input<float, nb::shape<-1, 4>>& points,
                          const Input<std::uint32_t, nb::shape<-1>>& segments, bool bezier) {
    std::vector<float> data = curve_data(span_of<glm::vec4>(points, 4), span_of<std::uint32_t>(segments),
                                         bezier ? CurveBasis::bezier : CurveBasis::bspline);
    const std::size_t rows = data.size() / 16;
    return array_of<float>(std::move(data), {rows, 16});
}

/// Replaces the data, and follows it.
void move(PyPrimitives& self, const Floats& data, bool rebuild) {
    without_gil(self.device, [&] {
        Buffer<float> floats = self.primitives.data();
        floats.write(span_of<float>(data));
        rebuild ? self.primitives.rebuild() : self.primitives.refit();
    });
}

}  // namespace

void bind_primitives(nb::module_& module) {
    module.def("curve_data", &data_of_curves);
    nb::class_<PyPrimitives>(module, "NativePrimitives")
        .def_static("build", &build)
        .def_static("build_text", &build_text)
        .def("move", &move)
        .def("floats", [](const PyPrimitives& self) { return self.primitives.data().size(); })
        .def("culled",
             [](const PyPrimitives& self) {
                 return without_gil(self.device, [&] { return self.primitives.bvh().statistics().culled; });
             })
        .def("count", [](const PyPrimitives& self) { return self.primitives.count(); });
}

}  // namespace claray::python
