// Libraries that are loaded while the program runs, if they are needed.
#pragma once

#include <dlfcn.h>

#include "claray/error.hpp"

namespace claray {

/// Sets `function` to the one of this name, or null. Returns whether the library has it.
template <class Function>
[[nodiscard]] bool find_function(void* library, const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(::dlsym(library, name));
    return function != nullptr;
}

/// Returns a function of a library of claray's own, which is found by the search path of the program (RUNPATH). Throws
/// ErrorKind::user with `remedy` if it cannot be loaded; its message begins with `what`.
template <class Function>
[[nodiscard]] Function* plugin_function(const char* file, const char* name, const std::string& what,
                                        const char* remedy) {
    void* const library = ::dlopen(file, RTLD_NOW | RTLD_GLOBAL);  // Open MPI loads plugins that use its symbols
    Function* function = nullptr;
    if (library != nullptr && find_function(library, name, function)) return function;
    const char* const reason = ::dlerror();
    throw Error(ErrorKind::user, what + (reason ? reason : "no reason"), remedy);
}

}  // namespace claray
