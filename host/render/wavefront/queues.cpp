#include "host/render/wavefront/queues.hpp"

#include <algorithm>
#include <cstring>

#include "claray/shared/lists/lobes.h"

namespace claray {
namespace {

constexpr std::size_t word = sizeof(std::uint32_t);
constexpr std::uint64_t bytes_per_path = 2 * CLARAY_QUEUE_TIMES * word + sizeof(Ray) + sizeof(Hit) +
                                         sizeof(LightSample) + sizeof(std::uint8_t) + 3 * sizeof(float);

}  // namespace

std::uint32_t floats_of_layers(unsigned layers) {
    return layers == 0 ? 0 : CLARAY_LAYER_FLOATS * layers + CLARAY_FLOATS_BEHIND_LAYERS;
}

RayArrays::RayArrays(const Device& device, std::size_t room, bool moves)
    // Kernels for more effects than the scene's write all of CLARAY_ALONG_RAYS.
    : queue(device, (moves ? CLARAY_QUEUE_WORDS : CLARAY_QUEUE_TIMES) * room),
      rays(queue, 0, room),
      states(queue, CLARAY_QUEUE_STATES * word * room, room) {
    if (moves) times = Buffer<float>(queue, CLARAY_QUEUE_TIMES * word * room, room);
}

ShadowArrays::ShadowArrays(const Device& device, std::size_t room, bool moves, bool casts_shadows)
    : queue(device, (moves ? CLARAY_SHADOW_WORDS : CLARAY_SHADOW_TIMES) * room),
      rays(queue, 0, room),
      light(queue, CLARAY_SHADOW_LIGHT * word * room, room),
      occluded(casts_shadows ? Buffer<std::uint8_t>(device, room)
                             : Buffer<std::uint8_t>(device, std::vector<std::uint8_t>(room))) {
    if (moves) times = Buffer<float>(queue, CLARAY_SHADOW_TIMES * word * room, room);
}

QueueLengths::QueueLengths(const Device& device) : all(device, std::vector<QueueLength>(CLARAY_QUEUE_LENGTHS)) {
    std::size_t at = 0;
    for (auto& length : rays) length = Buffer<std::uint32_t>(all, sizeof(QueueLength) * at++, 1);
    for (auto& length : shadow_rays) length = Buffer<std::uint32_t>(all, sizeof(QueueLength) * at++, 1);
}

Queues::Queues(const SceneBuffers& scene, const StageConfig& config, std::uint64_t most_paths)
    : lengths(scene.structure.device()) {
    limit(scene, config, most_paths);
}

/// At most a 16th of the device's memory, and no buffer larger than it allows.
void Queues::limit(const SceneBuffers& scene, const StageConfig& config, std::uint64_t most_paths) {
    const Device& device = scene.structure.device();
    if (config.task == PathTask::light_grid) most_paths = std::max<std::uint64_t>(most_paths, light_grid_paths);
    const bool guided = scene.where.guide != CLARAY_NO_TABLE;
    const std::uint64_t lessons =
        (guided ? 3 * CLARAY_GUIDE_LESSONS * sizeof(float) : 0) + floats_of_layers(config.light_layers) * sizeof(float);
    const std::uint64_t tuned = std::max(1u, device.tuning("render/wavefront", "PATHS"));
    const std::uint64_t memory =
        device.info().memory / share_of_wavefront / (bytes_per_path + config.shaders.size() * word + lessons);
    const std::uint64_t allocation = device.info().max_allocation / (sizeof(Ray) + lessons);
    capacity = std::uint32_t(std::max<std::uint64_t>(1, std::min({tuned, most_paths, memory, allocation})));
}

void Queues::split_light(const std::vector<std::uint32_t>& table) {
    layer_table.resize(table.size());
    std::memcpy(layer_table.data(), table.data(), sizeof(float) * table.size());
    outdate();
}

/// Short renders do not need room for all paths that a device can trace at once. The buffers hold nothing between
/// batches.
void Queues::make_room(std::uint32_t paths, const SceneBuffers& scene, const StageConfig& config,
                       std::size_t floats_per_path) {
    const Device& device = scene.structure.device();
    if (paths <= room()) return radiance.reserve(device, floats_per_path * room() + layer_table.size());
    // Each time GPUs take milliseconds.
    const std::uint32_t wanted = room() == 0 ? paths : std::max(paths, capacity);
    const std::size_t more = (wanted + CLARAY_QUEUE_ROOM - 1) / CLARAY_QUEUE_ROOM * std::size_t(CLARAY_QUEUE_ROOM);
    const bool moves = scene.structure.moves();
    rays[0] = rays[1] = {}, shadow = {}, hits = {}, radiance = {}, sorted = {};  // before more memory is taken
    if (!config.shaders.empty()) sorted = Buffer<std::uint32_t>(device, more * config.shaders.size());
    for (RayArrays& of_depth : rays) of_depth = RayArrays(device, more, moves);
    hits = SceneHits(scene.structure, more);
    radiance = Buffer<float>(device, floats_per_path * more + layer_table.size());
    if (!layer_table.empty()) radiance.write(std::span<const float>(layer_table), CLARAY_FLOATS_BEFORE_LAYERS * more);
    if (has_lights(scene.lights)) shadow = ShadowArrays(device, more, moves, !config.approximate.no_shadows);
}

}  // namespace claray
