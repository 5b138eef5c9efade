// The hashes of trees and hits that every device must find.
#pragma once

#include <string>

namespace claray::verify {

/// Empty if none is committed. Update the hashes of a builder that makes other trees; `claray verify --case
/// tree-hashes` prints them.
[[nodiscard]] std::string expected_hash(const std::string& name);

}  // namespace claray::verify
