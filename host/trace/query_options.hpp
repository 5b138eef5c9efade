// Handling of the options that all queries over arrays of rays share.
#pragma once

#include "claray/query.hpp"

namespace claray {

enum class QueryKind { closest, any };

/// The macros of a structure, and those that the options call for.
[[nodiscard]] Defines query_defines(Defines defines, const QueryOptions& options);

/// Throws ErrorKind::usage where there are too many rays, or too few elements for what belongs to each.
void check_sizes(std::size_t rays, std::size_t results, const QueryOptions& options);

/// The answers of a query to rays of the host.
template <class Answer, class Tree>
std::vector<Answer> answers(const Tree& tree, std::span<const Ray> rays, const QueryOptions& options,
                            void (*query)(const Tree&, const Buffer<Ray>&, Buffer<Answer>&, const QueryOptions&,
                                          const Buffer<std::uint32_t>&)) {
    const Buffer<Ray> device_rays(tree.device(), rays);
    Buffer<Answer> results(tree.device(), rays.size());
    query(tree, device_rays, results, options, {});
    return results.read();
}

}  // namespace claray
