// The oracle of instances of `claray verify`, for the other tests.
#pragma once

#include "host/verify/oracles/instance_oracle.hpp"
#include "tests/oracle/brute_force.hpp"

namespace claray::test {

using verify::InstanceComparison;
using verify::InstanceOracle;
using verify::world_corners;

}  // namespace claray::test
