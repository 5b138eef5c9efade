// What all queries over arrays of rays do with their options.
#pragma once

#include "claray/query.hpp"

namespace claray {

/// The macros of a structure, and those that the options call for.
[[nodiscard]] Defines query_defines(Defines defines, const QueryOptions& options);

/// Throws ErrorKind::usage where there are too many rays, or too few elements for what belongs to each.
void check_sizes(std::size_t rays, std::size_t results, const QueryOptions& options);

}  // namespace claray
