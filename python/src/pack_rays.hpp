// From arrays of origins and directions, of any strides, to the rays of claray.
#pragma once

#include <cstddef>
#include <span>

#include "claray/shared/types.h"

namespace claray::python {

/// `columns` numbers for each ray: float64 or float32. Strides are in bytes; a row stride of 0 gives all rays the same.
struct Columns {
    const void* data = nullptr;
    std::ptrdiff_t row_stride = 0, column_stride = 0;
    bool doubles = false;
};

struct RayColumns {
    Columns origins, directions, tmin, tmax;
};

inline constexpr std::size_t all_finite = std::size_t(-1);

/// Fills `rays` from row `first` on, on all processors. Returns the first row whose origin or direction is not finite
/// in float32, or `all_finite`.
[[nodiscard]] std::size_t pack_rays(std::span<Ray> rays, const RayColumns& columns, std::size_t first);

/// Returns the first ray whose origin or direction is not finite, or `all_finite`.
[[nodiscard]] std::size_t first_not_finite(std::span<const Ray> rays);

}  // namespace claray::python
