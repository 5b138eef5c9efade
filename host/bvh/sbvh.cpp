#include "host/bvh/sbvh.hpp"

#include <algorithm>

#include "host/compute/memory.hpp"

namespace claray {
namespace {

constexpr const char* sbvh_file = "bvh/sbvh.cl";
constexpr const char* large_file = "bvh/sbvh_large.cl";
// As in the kernels.
constexpr std::uint32_t tile = 2048, small = 32, large = 4096;
constexpr std::uint32_t words_of_task = 6, words_of_wide_task = 22, words_of_extent = 16;
constexpr std::uint32_t words_of_large_node = 41, words_of_chunk = 4, words_of_bins = 3 * 32 * 10;
constexpr std::uint32_t small_tasks = 2, first_level = 5, counters_of_level = 4, most_levels = 96;

Defines group_of(std::uint32_t items) { return {{"GROUP", std::to_string(items) + "u"}}; }

/// Chunks small enough to keep the device busy, and large enough that adding up their bins takes little time.
std::uint32_t chunk_for(const Device& device, std::uint32_t references) {
    return std::clamp(references / (8 * std::max(device.info().compute_units, 1u)), 512u, 4096u);
}

/// Runs of the serial schedule; 0 on GPUs.
std::uint32_t runs_of(const Device& device) {
    return device.info().compute_units * device.tuning("bvh/serial", "RANGES_PER_UNIT");
}

}  // namespace

Sbvh::Sbvh(const Device& device, std::uint32_t count, double budget, unsigned leaf_block)
    : count_(count),
      budget_(std::uint32_t(std::min(budget * count, double(CLARAY_SLOT - 1) - count))),
      chunk_(chunk_for(device, count)),
      large_group_(device.tuning("bvh/sbvh", "LARGE_GROUP")),
      medium_group_(device.tuning("bvh/sbvh", "MEDIUM_GROUP")),
      root_extent_(device, words_of_extent),
      counters_(device, first_level + counters_of_level * (most_levels + 1)),
      small_(device, words_of_task * (std::size_t(capacity()) / 2 + 1)) {
    for (Buffer<float>& references : references_) references = Buffer<float>(device, 8 * std::size_t(capacity()));
    const std::size_t large_nodes = std::size_t(capacity()) / large + 1, medium_nodes = capacity() / small + 1;
    for (auto& tasks : large_.tasks) tasks = Buffer<std::uint32_t>(device, words_of_wide_task * large_nodes);
    for (auto& tasks : medium_.tasks) tasks = Buffer<std::uint32_t>(device, words_of_wide_task * medium_nodes);
    states_ = Buffer<std::uint32_t>(device, words_of_large_node * large_nodes);
    bins_ = Buffer<std::uint32_t>(device, words_of_bins * large_nodes);
    chunks_ = Buffer<std::uint32_t>(device, words_of_chunk * (capacity() / chunk_ + large_nodes));
    runs_ = runs_of(device);
    load(device, kernels(device, leaf_block), *this);
}

KernelsOf<Sbvh> Sbvh::kernels(const Device& device, unsigned leaf_block) {
    const Defines medium = group_of(device.tuning("bvh/sbvh", "MEDIUM_GROUP"));
    const Defines large = group_of(device.tuning("bvh/sbvh", "LARGE_GROUP"));
    const KernelRequest finish = runs_of(device) != 0 ? KernelRequest{"bvh/serial/sbvh_serial.cl",
                                                                      "finish_subtrees_serial",
                                                                      {{"LEAF_BLOCK", std::to_string(leaf_block)}}}
                                                      : KernelRequest{"bvh/sbvh_small.cl", "finish_subtrees", {}};
    return {{&Sbvh::begin_placing_, {sbvh_file, "begin_placing", medium}},
            {&Sbvh::place_, {sbvh_file, "place_references", medium}},
            {&Sbvh::begin_, {sbvh_file, "begin_splitting", medium}},
            {&Sbvh::split_, {sbvh_file, "split_nodes", medium}},
            {&Sbvh::finish_, {sbvh_file, "finish_splitting", medium}},
            {&Sbvh::begin_large_, {large_file, "begin_large", large}},
            {&Sbvh::bin_large_, {large_file, "bin_large", large}},
            {&Sbvh::choose_large_, {large_file, "choose_large", large}},
            {&Sbvh::reserve_large_, {large_file, "reserve_large", large}},
            {&Sbvh::move_large_, {large_file, "move_large", large}},
            {&Sbvh::finish_large_, {large_file, "finish_large", large}},
            {&Sbvh::finish_subtrees_, finish}};
}

void Sbvh::build(const TriangleBuffers& triangles, const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves,
                 const Buffer<BvhHeader>& header) {
    if (count_ == 0) return;
    const auto counters = std::uint32_t(counters_.size());
    begin_placing_.run({counters, 1}, arg("root_extent", root_extent_), arg("counters", counters_), counters, chunk_);
    place_.run({std::size_t((count_ + tile - 1) / tile) * medium_group_, medium_group_}, triangles.positions,
               arg("indices", triangles.indices), count_, references_[0], arg("root_extent", root_extent_),
               arg("counters", counters_));
    begin_.run({1, 1}, capacity(), references_[0], arg("root_extent", root_extent_), leaves, nodes,
               arg("large", large_.tasks[0].memory()), arg("medium", medium_.tasks[0].memory()),
               arg("small", small_.memory()), arg("counters", counters_));
    for (std::uint32_t level = 0; level < most_levels; ++level) {
        std::uint32_t waiting[3];  // large and medium nodes, and the chunks of large ones
        counters_.read(waiting, first_level + counters_of_level * level);
        if (waiting[0] + waiting[1] == 0) break;
        if (waiting[0] != 0) {
            split_large(triangles, level, waiting[0], waiting[2]);
            const std::uint32_t next = 1 - level % 2;
            finish_large_.run({waiting[0], 1}, arg("tasks", large_.tasks[level % 2].memory()), states_.memory(),
                              waiting[0], arg("large", large_.tasks[next].memory()),
                              arg("medium", medium_.tasks[next].memory()), arg("small", small_.memory()),
                              references_[next], nodes, leaves, arg("counters", counters_));
        }
        if (waiting[1] != 0) split_medium(triangles, nodes, leaves, level, waiting[1]);
    }
    finish_subtrees(nodes, leaves);
    finish_.run({1, 1}, leaves, header, counters_);
}

std::uint64_t Sbvh::bytes() const {
    return buffer_bytes(references_[0], references_[1], root_extent_, counters_, small_, large_.tasks[0],
                        large_.tasks[1], medium_.tasks[0], medium_.tasks[1], states_, bins_, chunks_);
}

/// One level of the nodes that several groups split.
void Sbvh::split_large(const TriangleBuffers& triangles, std::uint32_t level, std::uint32_t waiting,
                       std::uint32_t chunk_count) {
    const auto tasks = arg("tasks", large_.tasks[level % 2].memory());
    const auto states = arg("states", states_.memory());
    const auto chunks = arg("chunks", chunks_.memory());
    const Buffer<float>&from = references_[level % 2], &to = references_[1 - level % 2];
    const auto positions = arg("positions", triangles.positions);
    const auto indices = arg("indices", triangles.indices);
    const auto bins = arg("node_bins", bins_);
    const auto counters = arg("counters", counters_);
    const Range of_nodes{std::size_t(waiting) * large_group_, large_group_};
    const Range of_chunks{std::size_t(chunk_count) * large_group_, large_group_};
    begin_large_.run(of_nodes, tasks, states, bins, chunks, chunk_, counters);
    for (const std::uint32_t by_planes : {0u, 1u}) {
        bin_large_.run(of_chunks, tasks, states, bins, chunks, chunk_, by_planes, arg("from", from), positions,
                       indices);
        choose_large_.run(of_nodes, tasks, states, bins, arg("root_extent", root_extent_), by_planes);
    }
    reserve_large_.run(of_chunks, tasks, states, chunks, chunk_, arg("from", from), positions, indices);
    move_large_.run(of_chunks, tasks, states, chunks, chunk_, arg("from", from), arg("to", to), positions, indices);
}

/// One level of the nodes that a group splits alone.
void Sbvh::split_medium(const TriangleBuffers& triangles, const Buffer<BvhNode>& nodes,
                        const Buffer<LeafTriangle>& leaves, std::uint32_t level, std::uint32_t waiting) {
    const std::uint32_t now = level % 2, next = 1 - now;
    split_.run({std::size_t(waiting) * medium_group_, medium_group_}, arg("tasks", medium_.tasks[now].memory()),
               arg("large", large_.tasks[next].memory()), arg("medium", medium_.tasks[next].memory()),
               arg("small", small_.memory()), arg("from", references_[now]), arg("to", references_[next]),
               arg("positions", triangles.positions), arg("indices", triangles.indices),
               arg("root_extent", root_extent_), nodes, leaves, arg("counters", counters_));
}

/// Builds the subtrees of all small nodes.
void Sbvh::finish_subtrees(const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves) {
    std::uint32_t subtrees = 0;
    counters_.read(std::span(&subtrees, 1), small_tasks);
    if (subtrees == 0) return;
    const auto even = arg("even", references_[0]), odd = arg("odd", references_[1]);
    if (runs_ == 0) {
        finish_subtrees_.run({std::size_t(subtrees) * small, small}, small_.memory(), even, odd, nodes, leaves,
                             counters_);
        return;
    }
    const std::uint32_t runs = std::min(runs_, subtrees);
    finish_subtrees_.run({runs, 1}, small_.memory(), subtrees, runs, even, odd, nodes, leaves, counters_);
}

}  // namespace claray
