// Whether two scenes are the same.
#pragma once

#include "claray/scene.hpp"
#include "host/base/hash.hpp"

namespace claray {

/// A digest of all values, bit for bit, without names.
[[nodiscard]] Digest digest_of(const Scene& scene);

}  // namespace claray
