// The rays of bench_peers are those of `claray bench`.
#pragma once

#include "bench/support.hpp"
