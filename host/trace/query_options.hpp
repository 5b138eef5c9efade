// Handling of the options that all queries over arrays of rays share.
#pragma once

#include "claray/query.hpp"
#include "host/bvh/bvh_state.hpp"

namespace claray {

/// The macros of a structure. Throws ErrorKind::usage if it holds primitives instead of triangles.
[[nodiscard]] Defines triangle_defines(const Bvh& bvh);

/// The macros of a structure and of the options.
[[nodiscard]] Defines query_defines(Defines defines, const QueryOptions& options);

/// The macros of a structure whose triangles are all treated as solid.
[[nodiscard]] Defines solid_defines(const Bvh& bvh);

/// Throws ErrorKind::usage if there are too many rays, or if a buffer of the options has fewer elements than rays.
void check_sizes(std::size_t rays, std::size_t results, const QueryOptions& options);

/// The results of a query for rays of the host.
template <class Answer, class Tree>
std::vector<Answer> answers(const Tree& tree, std::span<const Ray> rays, const QueryOptions& options,
                            void (*query)(const Tree&, const Buffer<Ray>&, Buffer<Answer>&, const QueryOptions&,
                                          const Buffer<std::uint32_t>&)) {
    std::vector<Answer> answers(rays.size());
    const auto device_rays = Buffer<Ray>::over(tree.device(), rays);
    auto results = Buffer<Answer>::under(tree.device(), answers);
    query(tree, device_rays, results, options, {});
    results.fetch(answers);
    return answers;
}

}  // namespace claray
