// The hashes of trees and hits that every device must find.
#pragma once

#include <string>

namespace claray::verify {

/// Empty where none is committed.
[[nodiscard]] std::string expected_hash(const std::string& name);

}  // namespace claray::verify
