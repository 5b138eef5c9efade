#include "host/accuracy/studies/trees/karras.hpp"

#include "host/sort/radix_sort.hpp"

namespace claray {
namespace {

constexpr unsigned hierarchy_group = 64;
const Defines code_bits = {{"CODE_BITS", "63"}};

}  // namespace

SortedTriangles sort_triangles(const Device& device, const TriangleBuffers& triangles) {
    const auto count = std::uint32_t(triangles.indices.size() / 3);
    SortedTriangles sorted{triangles, Buffer<std::uint64_t>(device, count), Buffer<std::uint32_t>(device, count),
                           Buffer<BvhHeader>(device, 1)};
    const Buffer<std::uint32_t> keys(device, 7);
    constexpr std::uint32_t group = 256, axis_bits = 21;
    load_kernel(device, "bvh/bounds.cl", "reset_header").run({1, 1}, sorted.header, keys);
    load_kernel(device, "bvh/bounds.cl", "compute_bounds")
        .run({count, group}, triangles.positions, arg("indices", triangles.indices), count, sorted.header,
             arg("keys", keys));
    load_kernel(device, "bvh/bounds.cl", "finish_bounds").run({1, 1}, sorted.header, keys, count, axis_bits);
    load_kernel(device, "bvh/morton_codes.cl", "compute_morton_codes", code_bits)
        .run({count, group}, triangles.positions, arg("indices", triangles.indices), count, sorted.header,
             arg("keys", keys), arg("codes", sorted.codes));
    RadixSort<std::uint64_t>(device, count, RadixSort<std::uint64_t>::config_for(device))
        .sort(sorted.codes, sorted.order, count);
    device.finish();
    return sorted;
}

KarrasTree::KarrasTree(const Device& device, const SortedTriangles& sorted, unsigned max_leaf)
    : sorted_(sorted),
      splits_(device, sorted.order.size()),
      parents_(device, 2 * sorted.order.size()),
      arrivals_(device, sorted.order.size()),
      nodes_(device, sorted.order.size()),
      leaves_(device, sorted.order.size()) {
    Defines defines = code_bits;
    defines.emplace_back("MAX_LEAF", std::to_string(max_leaf));
    find_splits_ = load_kernel(device, "accuracy/karras.cl", "find_splits", defines);
    fit_boxes_ = load_kernel(device, "accuracy/karras.cl", "fit_boxes", defines);
}

void KarrasTree::build() {
    const Range range{sorted_.order.size(), hierarchy_group};
    find_splits_.run(range, sorted_.codes, sorted_.header, arg("splits", splits_), arg("parents", parents_));
    arrivals_.fill(0xffffffffu);
    fit_boxes_.run(range, sorted_.triangles.positions, arg("indices", sorted_.triangles.indices),
                   arg("geometries", sorted_.triangles.geometries), arg("masks", sorted_.triangles.masks),
                   arg("order", sorted_.order), arg("splits", splits_), arg("parents", parents_), nodes_, leaves_,
                   arg("arrivals", arrivals_), sorted_.header);
}

}  // namespace claray
