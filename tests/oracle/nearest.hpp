// The oracle of nearest points of `claray verify`, for the other tests.
#pragma once

#include "host/verify/oracles/nearest_oracle.hpp"

namespace claray::test {

using verify::NearestOracle;

}  // namespace claray::test
