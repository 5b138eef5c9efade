// How commands are refused.
#pragma once

#include <string>

#include "claray/error.hpp"

namespace claray::view {

/// Throws ErrorKind::user: `what` cannot be done, and `remedy` tells what to do.
[[noreturn]] inline void refuse(const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::user, what, remedy);
}

}  // namespace claray::view
