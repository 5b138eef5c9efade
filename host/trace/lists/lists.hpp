// Makes lists of results: counts them, allocates, finds them again, puts each list in order.
#pragma once

#include <functional>

#include "claray/bvh.hpp"
#include "claray/query/lists.hpp"

namespace claray {

template <class T>
struct CountedLists {
    Lists<T> lists;
    Buffer<std::uint32_t> counts;
};

/// Runs a query: without offsets and elements it only writes counts.
template <class T>
using FindLists =
    std::function<void(const Buffer<std::uint32_t>& offsets, const Buffer<T>& elements, Buffer<std::uint32_t>& counts)>;

/// The lists of `queries` queries, of Hits or of indices of triangles; each triangle once.
template <class T>
[[nodiscard]] CountedLists<T> make_lists(const Bvh& bvh, std::uint32_t queries, const FindLists<T>& find);

template <class T>
[[nodiscard]] HostLists<T> download(const Lists<T>& lists) {
    return {lists.offsets.read(), lists.elements.read()};
}

/// Writes the number of results of each query. If triangles are split, that is the length of the lists.
template <class T>
void count_results(const Bvh& bvh, std::uint32_t queries, Buffer<std::uint32_t>& counts, const FindLists<T>& find);

}  // namespace claray
