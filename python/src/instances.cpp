// Two levels: placements of structures.
#include "claray/instances.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
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

struct Placed {
    std::vector<Instance> begin;
    InstancedBvh bvh;
};

/// `ends` is empty for structures without motion. With the device's lock.
Placed placed(const std::vector<PyBvh>& structures, const Transforms& transforms, const Transforms& ends,
              const Words& bottoms, const Words& masks, Builder builder) {
    std::vector<Bvh> shared;
    for (const PyBvh& structure : structures) shared.push_back(structure.bvh);
    const InstancedBvh::Config config{builder, 63};
    std::vector<Instance> begin = instances_of(transforms, bottoms, masks);
    InstancedBvh bvh = ends.size() == 0
                           ? InstancedBvh::build(shared, begin, config)
                           : InstancedBvh::build(shared, begin, instances_of(ends, bottoms, masks), config);
    return {std::move(begin), std::move(bvh)};
}

PyInstancedBvh build(const PyDevice& device, const std::vector<PyBvh>& structures, const Transforms& transforms,
                     const Transforms& ends, const Words& bottoms, const Words& masks, const std::string& builder) {
    const Builder by = config_of(builder).builder;
    return without_gil(device, [&] {
        Placed made = placed(structures, transforms, ends, bottoms, masks, by);
        return PyInstancedBvh{device, std::make_shared<CurrentInstances>(CurrentInstances{std::move(made.bvh), 0}),
                              std::move(made.begin)};
    });
}

/// Takes other instances, in any number.
void replace(PyInstancedBvh& self, const std::vector<PyBvh>& structures, const Transforms& transforms,
             const Transforms& ends, const Words& bottoms, const Words& masks, const std::string& builder) {
    const Builder by = config_of(builder).builder;
    without_gil(self.device, [&] {
        Placed made = placed(structures, transforms, ends, bottoms, masks, by);
        self.current->bvh = std::move(made.bvh);
        ++self.current->replaced;
        self.instances = std::move(made.begin);
    });
}

/// Moves all instances; `ends` is empty for structures without motion.
void move(PyInstancedBvh& self, const Transforms& transforms, const Transforms& ends, bool rebuild) {
    without_gil(self.device, [&] {
        Buffer<Instance> at_end = self.current->bvh.ends(), at_begin = self.current->bvh.instances();
        if (ends.size() != 0) {
            place(self.instances, ends);
            at_end.write(self.instances);
        }
        place(self.instances, transforms);
        at_begin.write(self.instances);
        rebuild ? self.current->bvh.rebuild() : self.current->bvh.refit();
    });
}

using Level = std::tuple<Transforms, Words, Words>;  // transforms, bottoms, masks

std::vector<Instance> instances_of(const Level& level) {
    return instances_of(std::get<0>(level), std::get<1>(level), std::get<2>(level));
}

/// Transforms, bottoms and masks of the flat instances, and the lists of steps.
Tuple flatten_levels(const Level& roots, const std::vector<Level>& groups, std::uint32_t bottoms) {
    std::vector<InstanceGroup> all;
    for (const Level& group : groups) all.push_back({instances_of(group)});
    FlatInstances flat = flatten(instances_of(roots), all, bottoms);
    const std::size_t count = flat.instances.size(), steps = flat.steps.size();
    std::vector<float> transforms;
    std::vector<std::uint32_t> which, masks;
    for (const Instance& instance : flat.instances) {
        for (const float* row : {instance.row0, instance.row1, instance.row2})
            transforms.insert(transforms.end(), row, row + 4);
        which.push_back(instance.bottom), masks.push_back(instance.mask);
    }
    return nb::make_tuple(array_of<float>(std::move(transforms), {count, 3, 4}),
                          array_of<std::uint32_t>(std::move(which), {count}),
                          array_of<std::uint32_t>(std::move(masks), {count}),
                          array_of<std::uint32_t>(std::move(flat.offsets), {count + 1}),
                          array_of<std::uint32_t>(std::move(flat.steps), {steps}));
}

Dict statistics(const PyInstancedBvh& self) {
    const InstanceStatistics s = without_gil(self.device, [&] { return self.current->bvh.statistics(); });
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
    module.def("flatten", &flatten_levels);
    nb::class_<PyInstancedBvh>(module, "NativeInstancedBvh")
        .def_static("build", &build)
        .def("move", &move)
        .def("replace", &replace)
        .def("count", [](const PyInstancedBvh& self) { return self.instances.size(); })
        .def("moves", [](const PyInstancedBvh& self) { return self.current->bvh.ends().allocated(); })
        .def("statistics", &statistics)
        .def("is_valid", [](const PyInstancedBvh& self) {
            return without_gil(self.device, [&] { return self.current->bvh.validate().ok(); });
        });
}

}  // namespace claray::python
