// Progress callbacks of Python in C++: an exception stops the work, and is raised when the work has stopped.
#pragma once

#include <nanobind/nanobind.h>

#include <optional>

namespace claray::python {

class Callback {
public:
    explicit Callback(nanobind::object function) : function_(std::move(function)) {}

    /// Calls the function with what `argument` makes, and takes the GIL for it. Returns false where the work must stop:
    /// the function returned False or raised, or Ctrl-C was pressed.
    template <class Argument>
    bool operator()(const Argument& argument) {
        const nanobind::gil_scoped_acquire acquire;
        try {
            if (PyErr_CheckSignals() != 0) throw nanobind::python_error();
            if (function_.is_none()) return true;
            return !call(argument()).is(nanobind::handle(Py_False));
        } catch (nanobind::python_error& error) {
            raised_.emplace(std::move(error));
            return false;
        }
    }
    /// With the GIL: raises what the function raised.
    void rethrow() {
        if (raised_) throw std::move(*raised_);
    }

private:
    nanobind::object call(const nanobind::tuple& arguments) { return function_(*arguments); }
    nanobind::object call(const nanobind::object& argument) { return function_(argument); }

    nanobind::object function_;
    std::optional<nanobind::python_error> raised_;
};

}  // namespace claray::python
