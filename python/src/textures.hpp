// Images as Python and the library exchange them.
#pragma once

#include "arrays.hpp"
#include "claray/texture.hpp"
#include "names.hpp"

namespace claray::python {

inline constexpr Named<TexelFormat> texel_formats[] = {
    {TexelFormat::srgb8, "srgb"}, {TexelFormat::linear8, "linear"}, {TexelFormat::float32, "float"}};
inline constexpr Named<Wrap> wraps[] = {{Wrap::repeat, "repeat"}, {Wrap::mirror, "mirror"}, {Wrap::clamp, "clamp"}};
inline constexpr Named<Filter> texture_filters[] = {{Filter::nearest, "nearest"},
                                                    {Filter::bilinear, "bilinear"},
                                                    {Filter::trilinear, "trilinear"},
                                                    {Filter::nearest_level, "nearest-level"}};

/// Linear colours: (height, width, 3).
using Pixels = Input<float, nb::shape<-1, -1, 3>>;

}  // namespace claray::python
