// Devices, and events of their queues.
#include "claray/device.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "claray/program/compiling.hpp"
#include "handles.hpp"
#include "typed.hpp"

namespace claray::python {
namespace {

PyEvent adopt_event(std::uintptr_t event) {
    if (event == 0) throw Error(ErrorKind::usage, "wait_for: the event is null");
    return cl::Event(reinterpret_cast<cl_event>(event), true);
}

bool is_complete(const PyEvent& event) { return event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>() <= CL_COMPLETE; }

void wait(const PyEvent& event) try {
    refuse_if_forked();
    event.wait();
} catch (const cl::Error& error) {
    throw Error(ErrorKind::device,
                "the commands of the event failed (OpenCL error " + std::to_string(error.err()) + ")");
}

Dict as_dict(const DeviceInfo& info) {
    nb::dict dict;
    dict["index"] = info.index;
    dict["name"] = info.name;
    dict["type"] = to_string(info.type);
    dict["platform"] = info.platform;
    dict["vendor"] = info.vendor;
    dict["driver"] = info.driver;
    dict["version"] = info.version;
    dict["compute_units"] = info.compute_units;
    dict["memory"] = info.memory;
    dict["max_allocation"] = info.max_allocation;
    return dict;
}

}  // namespace

void bind_device(nb::module_& module) {
    module.def("is_forked", &is_forked);
    module.def("list_devices", []() -> List {
        nb::list list;
        for (const DeviceInfo& info : list_devices()) list.append(as_dict(info));
        return list;
    });
    on_compiling(compiling_lines());
    module.def("tell_compiling", [](bool on) { on_compiling(on ? compiling_lines() : TellCompiling()); });
    nb::class_<PyDevice>(module, "NativeDevice")
        .def_static("open",
                    [](const std::string& selector) {
                        const nb::gil_scoped_release release;
                        return PyDevice{Device::open(selector)};
                    })
        .def_static("adopt",
                    [](std::uintptr_t context, std::uintptr_t queue) {
                        return PyDevice{Device::adopt(reinterpret_cast<cl_context>(context),
                                                      reinterpret_cast<cl_command_queue>(queue))};
                    })
        .def("with_new_queue",
             [](const PyDevice& self) {
                 return without_gil(self, [&] { return PyDevice{self.device.with_new_queue()}; });
             })
        .def("info", [](const PyDevice& self) { return as_dict(self.device.info()); })
        .def("prepare", [](const PyDevice& self) { without_gil(self, [&] { self.device.prepare(); }); })
        .def("finish", [](const PyDevice& self) { without_gil(self, [&] { self.device.finish(); }); })
        .def("context_ptr",
             [](const PyDevice& self) { return reinterpret_cast<std::uintptr_t>(self.device.context()()); })
        .def("queue_ptr", [](const PyDevice& self) { return reinterpret_cast<std::uintptr_t>(self.device.queue()()); });
    nb::class_<PyEvent>(module, "NativeEvent")
        .def_static("adopt", &adopt_event)
        .def("wait",
             [](const PyEvent& self) {
                 const nb::gil_scoped_release release;
                 wait(self);
             })
        .def("done", &is_complete)
        .def("ptr", [](const PyEvent& self) { return reinterpret_cast<std::uintptr_t>(self()); });
}

}  // namespace claray::python
