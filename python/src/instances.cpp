// Two levels: placements of structures.
#include "claray/instances.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "structures.hpp"

namespace claray::python {
namespace {

using Transforms = Input<float, nb::shape<-1, 3, 4>>;  // rows of matrices from object to world space
using Words = Input<std::uint32_t, nb::shape<-1>>;

void place(std::vector<Instance>& instances, const Transforms& transforms) {
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const float* rows = transforms.data() + 12 * i;
        std::copy(rows, rows + 4, instances[i].row0);
        std::copy(rows + 4, rows + 8, instances[i].row1);
        std::copy(rows + 8, rows + 12, instances[i].row2);
    }
}

std::vector<Instance> instances_of(const Transforms& transforms, const Words& bottoms, const Words& masks) {
    std::vector<Instance> instances(transforms.shape(0));
    place(instances, transforms);
    for (std::size_t i = 0; i < instances.size(); ++i) {
        instances[i].bottom = bottoms.size() == 0 ? 0 : bottoms.data()[i];
        instances[i].mask = masks.size() == 0 ? 0xffffffffu : masks.data()[i];
        instances[i].id = std::uint32_t(i), instances[i].tag = 0;
    }
    return instances;
}

PyInstancedBvh build(const PyDevice& device, const std::vector<PyBvh>& structures, const Transforms& transforms,
                     const Transforms& ends, const Words& bottoms, const Words& masks, const std::string& builder) {
    const Builder by = config_of(builder).builder;
    return without_gil(device, [&] {
        std::vector<Bvh> shared;
        for (const PyBvh& structure : structures) shared.push_back(structure.bvh);
        const InstancedBvh::Config config{by, 63};
        const std::vector<Instance> begin = instances_of(transforms, bottoms, masks);
        if (ends.size() == 0)
            return PyInstancedBvh{device, InstancedBvh::build(shared, begin, config), std::move(begin)};
        const std::vector<Instance> end = instances_of(ends, bottoms, masks);
        return PyInstancedBvh{device, InstancedBvh::build(shared, begin, end, config), std::move(begin)};
    });
}

/// Moves all instances; `ends` is empty for structures without motion.
void move(PyInstancedBvh& self, const Transforms& transforms, const Transforms& ends, bool rebuild) {
    without_gil(self.device, [&] {
        Buffer<Instance> at_end = self.bvh.ends(), at_begin = self.bvh.instances();
        if (ends.size() != 0) {
            place(self.instances, ends);
            at_end.write(self.instances);
        }
        place(self.instances, transforms);
        at_begin.write(self.instances);
        rebuild ? self.bvh.rebuild() : self.bvh.refit();
    });
}

nb::dict statistics(const PyInstancedBvh& self) {
    const InstanceStatistics s = without_gil(self.device, [&] { return self.bvh.statistics(); });
    nb::dict dict;
    dict["instances"] = s.instances;
    dict["culled"] = s.culled;
    dict["height"] = s.height;
    dict["sah_cost"] = s.sah_cost;
    dict["top_bytes"] = s.top_bytes;
    dict["bottom_bytes"] = s.bottom_bytes;
    return dict;
}

}  // namespace

void bind_instances(nb::module_& module) {
    nb::class_<PyInstancedBvh>(module, "NativeInstancedBvh")
        .def_static("build", &build)
        .def("move", &move)
        .def("moves", [](const PyInstancedBvh& self) { return self.bvh.ends().allocated(); })
        .def("statistics", &statistics)
        .def("is_valid", [](const PyInstancedBvh& self) {
            return without_gil(self.device, [&] { return self.bvh.validate().ok(); });
        });
}

}  // namespace claray::python
