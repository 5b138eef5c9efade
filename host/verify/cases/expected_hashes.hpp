// The hashes of trees and hits that every device must find.
#pragma once

#include <string>

namespace claray::verify {

/// Empty where none is committed. A builder that makes other trees changes those of its trees; `claray verify --case
/// tree-hashes` prints them.
[[nodiscard]] std::string expected_hash(const std::string& name);

}  // namespace claray::verify
