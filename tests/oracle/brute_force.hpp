// The oracle of `claray verify`, for the other tests.
#pragma once

#include "host/verify/oracle.hpp"

namespace claray::test {

using verify::compare;
using verify::HitComparison;
using verify::Oracle;
using verify::OracleHit;

}  // namespace claray::test
