#include "host/bvh/sbvh.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr const char* sbvh_file = "bvh/sbvh.cl";
// As in the kernels.
constexpr std::uint32_t tile = 2048, small = 32, large = 4096, words_per_task = 6;
constexpr std::uint32_t small_tasks = 2, first_level = 3, most_levels = 96;

Defines group_of(std::uint32_t items) { return {{"GROUP", std::to_string(items) + "u"}}; }

}  // namespace

Sbvh::Sbvh(const Device& device, std::uint32_t count, double budget)
    : count_(count),
      budget_(std::uint32_t(std::min(budget * count, double(CLARAY_SLOT - 1) - count))),
      tiles_((count + tile - 1) / tile),
      tile_sums_(device, tiles_),
      counters_(device, first_level + 2 * most_levels),
      small_(device, words_per_task * (std::size_t(capacity()) / 2 + 1)) {
    for (Buffer<float>& references : references_) references = Buffer<float>(device, 8 * std::size_t(capacity()));
    const std::uint32_t least[2] = {large, small};
    const char* const names[2] = {"LARGE_GROUP", "MEDIUM_GROUP"};
    for (int size = 0; size < 2; ++size) {
        Queue& queue = queues_[size];
        for (auto& tasks : queue.tasks)
            tasks = Buffer<std::uint32_t>(device, words_per_task * (std::size_t(capacity()) / least[size] + 1));
        queue.group = device.tuning("bvh/sbvh", names[size]);
        queue.split = load_kernel(device, sbvh_file, "split_nodes", group_of(queue.group));
    }
    const Defines of_tiles = group_of(queues_[1].group);
    count_references_ = load_kernel(device, sbvh_file, "count_references", of_tiles);
    scan_ = load_kernel(device, sbvh_file, "scan_tiles", of_tiles);
    place_ = load_kernel(device, sbvh_file, "place_references", of_tiles);
    begin_ = load_kernel(device, sbvh_file, "begin_splitting", of_tiles);
    finish_subtrees_ = load_kernel(device, "bvh/sbvh_small.cl", "finish_subtrees");
    finish_ = load_kernel(device, sbvh_file, "finish_splitting", of_tiles);
}

void Sbvh::build(const TriangleBuffers& triangles, const Buffer<std::uint32_t>& bound_keys,
                 const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves, const Buffer<BvhHeader>& header) {
    if (count_ == 0) return;
    const std::uint32_t group = queues_[1].group;
    const Range of_tiles{std::size_t(tiles_) * group, group};
    count_references_.run(of_tiles, triangles.positions, arg("indices", triangles.indices), count_,
                          arg("tile_sums", tile_sums_));
    scan_.run({group, group}, tile_sums_, tiles_);
    place_.run(of_tiles, triangles.positions, arg("indices", triangles.indices), count_, arg("tile_sums", tile_sums_),
               references_[0]);
    counters_.fill(0);
    begin_.run({1, 1}, header, capacity(), references_[0], leaves, nodes, arg("large", queues_[0].tasks[0].memory()),
               arg("medium", queues_[1].tasks[0].memory()), arg("small", small_.memory()), counters_);
    for (std::uint32_t level = 0; level < most_levels; ++level) {
        std::uint32_t waiting[2];
        counters_.read(waiting, first_level + 2 * level);
        if (waiting[0] + waiting[1] == 0) break;
        split_level(triangles, bound_keys, nodes, leaves, level, waiting);
    }
    std::uint32_t subtrees = 0;
    counters_.read(std::span(&subtrees, 1), small_tasks);
    if (subtrees != 0)
        finish_subtrees_.run({std::size_t(subtrees) * small, small}, small_.memory(), arg("even", references_[0]),
                             arg("odd", references_[1]), nodes, leaves, counters_);
    finish_.run({1, 1}, leaves, header, counters_);
}

void Sbvh::split_level(const TriangleBuffers& triangles, const Buffer<std::uint32_t>& bound_keys,
                       const Buffer<BvhNode>& nodes, const Buffer<LeafTriangle>& leaves, std::uint32_t level,
                       const std::uint32_t waiting[2]) {
    const std::uint32_t now = level % 2, next = 1 - now;
    for (int size = 0; size < 2; ++size) {
        if (waiting[size] == 0) continue;
        Queue& queue = queues_[size];
        queue.split.run({std::size_t(waiting[size]) * queue.group, queue.group},
                        arg("tasks", queue.tasks[now].memory()), arg("large", queues_[0].tasks[next].memory()),
                        arg("medium", queues_[1].tasks[next].memory()), arg("small", small_.memory()),
                        arg("from", references_[now]), arg("to", references_[next]), triangles.positions,
                        arg("indices", triangles.indices), arg("bound_keys", bound_keys), nodes, leaves,
                        arg("counters", counters_));
    }
}

}  // namespace claray
