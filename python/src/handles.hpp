// The objects of the module: claray's handles with the lock that makes them safe to use from several Python threads.
#pragma once

#include <nanobind/nanobind.h>

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "claray/query.hpp"

namespace claray::python {

namespace nb = nanobind;

/// Copies share the device, its lock and its scratch memory.
struct PyDevice {
    Device device;
    /// claray's handles must not be used by two threads at once. Recursive: a callback may use what called it.
    std::shared_ptr<std::recursive_mutex> mutex = std::make_shared<std::recursive_mutex>();
    std::shared_ptr<std::vector<Ray>> scratch = std::make_shared<std::vector<Ray>>();
};

/// Runs `work` without the GIL and with the device's lock. Waiting for the lock with the GIL held could deadlock.
template <class Work>
auto without_gil(const PyDevice& device, const Work& work) {
    const nb::gil_scoped_release release;
    const std::lock_guard lock(*device.mutex);
    return work();
}

struct PyBvh {
    PyDevice device;
    Bvh bvh;
};

void bind_errors(nb::module_& module);
void bind_device(nb::module_& module);
void bind_bvh(nb::module_& module);
void bind_query(nb::module_& module);
void bind_points(nb::module_& module);
void bind_lists(nb::module_& module);
void bind_primitives(nb::module_& module);
void bind_instances(nb::module_& module);
void bind_scene(nb::module_& module);
void bind_renderer(nb::module_& module);
void bind_accuracy(nb::module_& module);
void bind_verify(nb::module_& module);

}  // namespace claray::python
