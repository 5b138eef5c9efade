#include "host/build/presplit.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr const char* file = "build/presplit.cl";
constexpr std::uint32_t group = 256, tile = 2048;  // as in the kernels
constexpr std::size_t plan_words = 20;
constexpr std::uint32_t most_splits = 1023;  // of one triangle

}  // namespace

Presplit::Presplit(const Device& device, std::uint32_t count, double budget, unsigned code_bits)
    : count_(count),
      budget_(std::uint32_t(std::min(budget * count, double(CLARAY_SLOT - 1) - count))),
      limit_(std::min(most_splits, 0xffffffffu / std::max(count, 1u))),
      tiles_((count + tile - 1) / tile),
      priorities_(device, count),
      plan_(device, plan_words),
      tile_sums_(device, tiles_),
      references_(device, capacity()) {
    const Defines bits = {{"CODE_BITS", std::to_string(code_bits)}};
    find_priorities_ = load_kernel(device, file, "split_priorities", bits);
    count_splits_ = load_kernel(device, file, "count_splits", bits);
    choose_ = load_kernel(device, file, "choose_scale", bits);
    sum_ = load_kernel(device, file, "sum_splits", bits);
    scan_ = load_kernel(device, file, "scan_splits", bits);
    place_ = load_kernel(device, file, "place_splits", bits);
    gather_ = load_kernel(device, file, "gather_references", bits);
}

template <class Code>
std::uint32_t Presplit::split(const TriangleBuffers& triangles, const Buffer<BvhHeader>& header,
                              const Buffer<std::uint32_t>& bound_keys, const Buffer<Code>& codes) {
    find_priorities_.run({std::max(count_, 1u), group}, triangles.positions, triangles.indices, count_, header,
                         bound_keys, priorities_, plan_);
    const Range range{std::size_t(tiles_) * group, group};
    for (std::uint32_t pass = 0; pass < 2; ++pass) {
        count_splits_.run(range, priorities_, count_, limit_, pass, plan_);
        choose_.run({1, 1}, plan_, budget_, pass);
    }
    sum_.run(range, priorities_, count_, limit_, plan_, tile_sums_);
    scan_.run({group, group}, tile_sums_, tiles_, plan_);
    place_.run(range, triangles.positions, triangles.indices, count_, limit_, header, priorities_, plan_, tile_sums_,
               references_, codes);
    std::uint32_t extra = 0;
    plan_.read(std::span(&extra, 1));
    to_sort_ = count_ + extra;
    return to_sort_;
}

void Presplit::gather(const Buffer<std::uint32_t>& order, const Buffer<LeafTriangle>& leaves,
                      const Buffer<std::uint32_t>& clusters, const Buffer<BvhHeader>& header) {
    gather_.run({std::max(to_sort_, 1u), group}, references_, order, plan_, leaves, clusters, header);
}

template std::uint32_t Presplit::split(const TriangleBuffers&, const Buffer<BvhHeader>&, const Buffer<std::uint32_t>&,
                                       const Buffer<std::uint32_t>&);
template std::uint32_t Presplit::split(const TriangleBuffers&, const Buffer<BvhHeader>&, const Buffer<std::uint32_t>&,
                                       const Buffer<std::uint64_t>&);

}  // namespace claray
