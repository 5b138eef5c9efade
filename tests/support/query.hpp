// Options that several tests ask queries with.
#pragma once

#include "claray/query.hpp"

namespace claray::test {

/// Queries without the tree.
inline const QueryOptions brute_force = [] {
    QueryOptions options;
    options.brute_force = true;
    return options;
}();

}  // namespace claray::test
