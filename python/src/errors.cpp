// claray::Error as the exceptions of claray/errors.py.
#include "claray/error.hpp"

#include "handles.hpp"

namespace claray::python {

namespace {

const char* class_of(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::usage: return "UsageError";
        case ErrorKind::device: return "DeviceError";
        default: return "InputError";
    }
}

}  // namespace

void bind_errors(nb::module_&) {
    nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
        try {
            std::rethrow_exception(thrown);
        } catch (const Error& error) {
            const nb::object type = nb::module_::import_("claray.errors").attr(class_of(error.kind()));
            PyErr_SetString(type.ptr(), error.what());
        }
    });
}

}  // namespace claray::python
