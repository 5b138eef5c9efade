// Hits that a query leaves out, by a program's own function.
#pragma once

#include <string>

#include "claray/buffer.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// OpenCL C that defines
///
///     static inline bool accept_hit(global const float* data, float3 origin, float3 direction, const Hit* hit);
///
/// which returns whether the hit counts; if not, the ray goes on. It is called for hits in any order, some of them
/// behind the closest one, and must return the same for the same hit. The source may include claray's device headers.
struct HitFilter {
    std::string name = {};    ///< appears in the compiler's messages
    std::string source = {};  ///< empty: every hit counts
    Buffer<float> data = {};  ///< passed to the function
};

/// Accepts hits of meshes `first` to `end` - 1.
[[nodiscard]] HitFilter geometry_range(const Device& device, std::uint32_t first, std::uint32_t end);

}  // namespace claray
#pragma GCC visibility pop
