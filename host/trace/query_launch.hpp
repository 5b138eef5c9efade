// How many queries a work-item answers, and how many items form a group: as for closest hits.
#pragma once

#include "claray/program.hpp"

namespace claray {

struct QueryLaunch {
    explicit QueryLaunch(const Device& device);
    [[nodiscard]] Range range(std::size_t queries) const { return {(queries + per_item - 1) / per_item, group}; }
    /// Appends the macros of kernels/trace/query.clh.
    [[nodiscard]] Defines with(Defines defines) const;

    unsigned per_item, group;
};

}  // namespace claray
