// What queries take beside a Bvh: instances, primitives, filters of hits.
#pragma once

#include "claray/instances.hpp"
#include "claray/primitives/primitives.hpp"
#include "handles.hpp"
#include "typed.hpp"

namespace claray::python {

struct PyPrimitives {
    PyDevice device;
    Kept<Primitives> primitives;
};

/// A structure that is replaced when instances are added or removed. Queries follow it.
struct CurrentInstances {
    Kept<InstancedBvh> bvh;
    unsigned replaced = 0;  // so many times
};

struct PyInstancedBvh {
    PyDevice device;
    std::shared_ptr<CurrentInstances> current;
    std::vector<Instance> instances;  // as they were given, for moves
};

/// A HitFilter whose data is not on a device yet. An empty text: every hit counts.
struct PyFilter {
    std::string name, source;
    std::vector<float> data;
};

/// The filter with its data on the device.
[[nodiscard]] HitFilter filter_of(const Device& device, const PyFilter& filter);

/// The builder of that name. Throws ErrorKind::usage, naming the argument, for an unknown one.
[[nodiscard]] Bvh::Config config_of(const std::string& builder);

[[nodiscard]] Dict tree_statistics(const BvhStatistics& statistics);

}  // namespace claray::python
