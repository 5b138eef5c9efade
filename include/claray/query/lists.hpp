// Results of queries that find any number of things.
#pragma once

#include <vector>

#include "claray/buffer.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Lists in device memory, one per query: list i is elements[offsets[i]] .. elements[offsets[i + 1] - 1].
template <class T>
struct Lists {
    Buffer<std::uint32_t> offsets = {};  ///< one more than there are queries
    Buffer<T> elements = {};
};

/// The same in host memory.
template <class T>
struct HostLists {
    std::vector<std::uint32_t> offsets = {};
    std::vector<T> elements = {};
};

}  // namespace claray
#pragma GCC visibility pop
