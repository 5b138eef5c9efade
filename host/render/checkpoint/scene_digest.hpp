// Whether two scenes are the same.
#pragma once

#include "claray/scene.hpp"
#include "host/base/hash.hpp"

namespace claray {

/// Of all values bit for bit; names don't count.
[[nodiscard]] Digest digest_of(const Scene& scene);

}  // namespace claray
