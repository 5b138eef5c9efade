// The meshes and rays of `claray verify`, for the other tests.
#pragma once

#include "host/verify/shapes.hpp"

namespace claray::test {

using verify::grid;
using verify::make_ray;
using verify::Random;
using verify::random_rays;
using verify::soup;
using verify::sphere;

}  // namespace claray::test
