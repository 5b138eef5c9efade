// The objects of the module: claray's handles with the lock that makes them safe to use from several Python threads.
#pragma once

#include <nanobind/nanobind.h>

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "claray/query.hpp"
#include "host/compute/fork.hpp"

namespace claray::python {

namespace nb = nanobind;

/// A handle that is not released in a process that fork() made: releasing takes locks of the driver, which another
/// thread may have held then.
template <class T>
struct Kept : T {
    Kept() = default;
    Kept(T handle) : T(std::move(handle)) {}
    Kept(const Kept&) = default;
    Kept(Kept&&) = default;
    Kept& operator=(const Kept&) = default;
    Kept& operator=(Kept&&) = default;
    ~Kept() {
        if (is_forked()) static_cast<void>(new T(std::move(static_cast<T&>(*this))));
    }
};

/// Copies share the device, its lock and its scratch memory.
struct PyDevice {
    Kept<Device> device;
    /// claray's handles must not be used by two threads at once. Recursive: a callback may use what called it.
    std::shared_ptr<std::recursive_mutex> mutex = std::make_shared<std::recursive_mutex>();
    std::shared_ptr<std::vector<Ray>> scratch = std::make_shared<std::vector<Ray>>();
};

/// Runs `work` without the GIL and with the device's lock. Waiting for the lock with the GIL held could deadlock, as
/// could a lock that another thread held when fork() made this process.
template <class Work>
auto without_gil(const PyDevice& device, const Work& work) {
    refuse_if_forked();
    const nb::gil_scoped_release release;
    const std::lock_guard lock(*device.mutex);
    return work();
}

/// The same with the locks of several devices, taken in one order everywhere.
template <class Work>
auto without_gil(const std::vector<PyDevice>& devices, const Work& work) {
    refuse_if_forked();
    std::set<std::recursive_mutex*> mutexes;
    for (const PyDevice& device : devices) mutexes.insert(device.mutex.get());
    const nb::gil_scoped_release release;
    std::vector<std::unique_lock<std::recursive_mutex>> locks;
    for (std::recursive_mutex* mutex : mutexes) locks.emplace_back(*mutex);
    return work();
}

using PyEvent = Kept<cl::Event>;

struct PyBvh {
    PyDevice device;
    Kept<Bvh> bvh;
};

void bind_errors(nb::module_& module);
void bind_device(nb::module_& module);
void bind_bvh(nb::module_& module);
void bind_query(nb::module_& module);
void bind_points(nb::module_& module);
void bind_lists(nb::module_& module);
void bind_primitives(nb::module_& module);
void bind_instances(nb::module_& module);
void bind_sensors(nb::module_& module);
void bind_records(nb::module_& module);
void bind_scene(nb::module_& module);
void bind_textures(nb::module_& module);
void bind_render_config(nb::module_& module);
void bind_renderer(nb::module_& module);
void bind_bake(nb::module_& module);
void bind_explain(nb::module_& module);
void bind_accuracy(nb::module_& module);
void bind_verify(nb::module_& module);
void bind_view(nb::module_& module);

}  // namespace claray::python
