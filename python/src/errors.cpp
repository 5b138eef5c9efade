// claray::Error as the exceptions of claray/errors.py.
#include "claray/error.hpp"

#include <string>
#include <string_view>

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

/// Where a system's package would help, drivers of PyPI do, too: claray/_loader.py finds them.
std::string message_of(const Error& error) {
    constexpr std::string_view remedy = "apt-get install pocl-opencl-icd";
    std::string message = error.what();
    const std::size_t at = message.find(remedy);
    if (at != std::string::npos)
        message.insert(at + remedy.size(), ", or pip install intel-opencl-rt intel-cmplr-lib-rt");
    return message;
}

}  // namespace

void bind_errors(nb::module_&) {
    nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
        try {
            std::rethrow_exception(thrown);
        } catch (const Error& error) {
            const nb::object type = nb::module_::import_("claray.errors").attr(class_of(error.kind()));
            PyErr_SetString(type.ptr(), message_of(error).c_str());
        }
    });
}

}  // namespace claray::python
