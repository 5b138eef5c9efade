#include "host/render/wavefront.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "host/compute/memory.hpp"

namespace claray {
namespace {

/// Consecutive paths that an item of shade_surface works on.
std::uint32_t paths_per_item(const Device& device) {
    if (device.info().type != DeviceType::cpu) return 1;
    return std::max(1u, device.tuning("render/shade_surface", "PATHS_PER_ITEM"));
}

constexpr std::uint32_t probe_seed = 0x9e3779b9;
constexpr std::uint32_t most_surfaces_of_probes =
    5;  // of their rays' paths, which the grid nearly always ends at the first

constexpr const char* path_kernel_stem = "render/trace_paths";

constexpr std::uint64_t bytes_per_path =
    2 * (sizeof(Ray) + sizeof(PathState) + sizeof(RayCone) + sizeof(std::uint64_t)) + sizeof(Ray) + sizeof(Hit) +
    sizeof(LightSample) + sizeof(std::uint8_t) + 3 * sizeof(float);

/// At most a 16th of the device's memory, and no buffer larger than it allows.
std::uint32_t choose_capacity(const Device& device, std::uint64_t most_paths, bool guided, std::size_t lists) {
    const std::uint64_t lessons = guided ? 3 * CLARAY_GUIDE_LESSONS * sizeof(float) : 0;
    const std::uint64_t tuned = std::max(1u, device.tuning("render/wavefront", "PATHS"));
    const std::uint64_t memory =
        device.info().memory / share_of_wavefront / (bytes_per_path + lists * sizeof(std::uint32_t) + lessons);
    const std::uint64_t allocation = device.info().max_allocation / (sizeof(Ray) + lessons);
    return std::uint32_t(std::max<std::uint64_t>(1, std::min({tuned, most_paths, memory, allocation})));
}

std::uint64_t most_whole_paths(const Device& device) {
    return std::uint64_t(device.info().compute_units) * device.tuning(path_kernel_stem, "MOST_PATHS_PER_UNIT");
}

std::uint64_t most_last_paths(const Device& device) {
    return std::uint64_t(device.info().compute_units) * device.tuning("render/finish_paths", "MOST_PATHS_PER_UNIT");
}

std::uint64_t with_light_grid(std::uint64_t most_paths, const WavefrontKernels& kernels) {
    return kernels.light_grid ? std::max<std::uint64_t>(most_paths, light_grid_paths) : most_paths;
}

/// Consecutive items of a box that a batch has room for, with `samples` paths each.
template <class Visit>
void for_each_batch(const GridBox& box, std::uint32_t samples, std::uint32_t capacity, const Visit& visit) {
    const std::uint32_t all = box.width * box.height * box.depth;
    const std::uint32_t most = std::max(1u, std::min(light_grid_paths, capacity) / samples);
    for (std::uint32_t first = 0; first < all; first += most) visit(first, std::min(most, all - first));
}

}  // namespace

SkyData sky_data(const Scene& scene) {
    Sky sky = scene.sky;
    if (!scene.environment.images.empty()) sky.horizon = sky.zenith = glm::vec3(0.f);
    SkyData data{};
#define CLARAY_COLOR(name, text) data.name##_r = sky.name.x, data.name##_g = sky.name.y, data.name##_b = sky.name.z;
#define CLARAY_NUMBER(name, text) data.name = sky.name;
    CLARAY_SKY(CLARAY_COLOR, CLARAY_NUMBER)
#undef CLARAY_COLOR
#undef CLARAY_NUMBER
    return data;
}

bool may_follow_paths(const SceneBuffers& scene, EffectSet effects) {
    const Structure& structure = scene.structure;
    if (!structure.is_one_binary_tree()) return false;
    return number_of(of_stage(effects, Stage::shade)) <= structure.device().tuning(path_kernel_stem, "MOST_EFFECTS");
}

double path_kernel_patience(const Device& device) {
    return device.tuning(path_kernel_stem, "PATIENCE_MILLISECONDS") * 1e-3;
}

bool may_finish_paths(const SceneBuffers& scene, EffectSet effects) {
    return may_follow_paths(scene, effects) && most_last_paths(scene.structure.device()) > 0;
}

Wavefront::Wavefront(const Device& device, const SceneBuffers& scene, const FrameData& frame, WavefrontKernels kernels,
                     std::uint64_t most_paths)
    : device_(device),
      scene_(scene),
      frame_(frame),
      bounces_per_look_(std::max(1u, device.tuning("render/wavefront", "BOUNCES_PER_LOOK"))),
      shade_group_(device.tuning("render/shade_surface", "GROUP_SIZE")),
      paths_per_item_(paths_per_item(device)),
      most_whole_paths_(most_whole_paths(device)),
      most_last_paths_(most_last_paths(device)),
      capacity_(choose_capacity(device, with_light_grid(most_paths, kernels), scene.where.guide != CLARAY_NO_TABLE,
                                kernels.shaders.size())),
      kernels_(std::move(kernels)) {
    frame_.tables = scene.where;
    queue_lengths_ = Buffer<QueueLength>(device, std::vector<QueueLength>(CLARAY_QUEUE_LENGTHS));
    std::size_t at = 0;
    for (auto& length : lengths_) length = Buffer<std::uint32_t>(queue_lengths_, sizeof(QueueLength) * at++, 1);
    for (auto& length : shadow_lengths_) length = Buffer<std::uint32_t>(queue_lengths_, sizeof(QueueLength) * at++, 1);
    totals_ = Buffer<std::uint64_t>(device, 2);
    totals_in_paths_ = Buffer<std::uint64_t>(device, 2);
    reset_totals();
}

/// Short renders do not need room for all paths that a device can trace at once. The buffers hold nothing between
/// batches.
void Wavefront::make_room(std::uint32_t paths) {
    if (paths <= rays_[0].size()) {
        const std::size_t floats = floats_per_path() * rays_[0].size();
        if (radiance_.size() < floats) radiance_ = Buffer<float>(device_, floats);
        return;
    }
    // Each time GPUs take milliseconds.
    const std::uint32_t wanted = rays_[0].size() == 0 ? paths : std::max(paths, capacity_);
    const std::size_t room = (wanted + CLARAY_QUEUE_ROOM - 1) / CLARAY_QUEUE_ROOM * std::size_t(CLARAY_QUEUE_ROOM);
    const bool moves = scene_.structure.moves();
    constexpr std::size_t word = sizeof(std::uint32_t);
    // Kernels for more effects than the scene's also write cones and media.
    const std::size_t words = moves ? CLARAY_QUEUE_WORDS : CLARAY_QUEUE_TIMES;
    for (int i = 0; i < 2; ++i) queues_[i] = {}, rays_[i] = {}, states_[i] = {}, times_[i] = {};
    hits_ = {}, radiance_ = {}, sorted_ = {};
    if (!kernels_.shaders.empty()) sorted_ = Buffer<std::uint32_t>(device_, room * kernels_.shaders.size());
    shadow_queue_ = {}, shadow_rays_ = {}, shadow_light_ = {}, occluded_ = {}, shadow_times_ = {};
    for (int i = 0; i < 2; ++i) {
        queues_[i] = Buffer<RayQueue>(device_, words * room);
        rays_[i] = Buffer<Ray>(queues_[i], 0, room);
        states_[i] = Buffer<PathState>(queues_[i], CLARAY_QUEUE_STATES * word * room, room);
        if (moves) times_[i] = Buffer<float>(queues_[i], CLARAY_QUEUE_TIMES * word * room, room);
    }
    hits_ = SceneHits(scene_.structure, room);
    radiance_ = Buffer<float>(device_, floats_per_path() * room);
    if (!has_lights(scene_.lights)) return;
    shadow_queue_ = Buffer<ShadowQueue>(device_, (moves ? CLARAY_SHADOW_WORDS : CLARAY_SHADOW_TIMES) * room);
    shadow_rays_ = Buffer<Ray>(shadow_queue_, 0, room);
    shadow_light_ = Buffer<LightSample>(shadow_queue_, CLARAY_SHADOW_LIGHT * word * room, room);
    occluded_ = kernels_.casts_shadows ? Buffer<std::uint8_t>(device_, room)
                                       : Buffer<std::uint8_t>(device_, std::vector<std::uint8_t>(room));
    if (moves) shadow_times_ = Buffer<float>(shadow_queue_, CLARAY_SHADOW_TIMES * word * room, room);
}

std::uint32_t Wavefront::floats_of_paths() const { return scene_.where.light_tree == CLARAY_NO_TABLE ? 3 : 6; }

std::size_t Wavefront::floats_per_path() const {
    return floats_of_paths() + (frame_.guide.lessons != 0 ? 3 * CLARAY_GUIDE_LESSONS : 0);
}

Step Wavefront::step_of(const Batch& batch, std::uint32_t depth, std::uint32_t limit) const {
    return {batch, frame_, depth, limit, std::uint32_t(rays_[0].size()), waves()};
}

void Wavefront::resize(std::uint32_t width, std::uint32_t height, std::uint64_t most_paths) {
    frame_.width = width, frame_.height = height;
    capacity_ = choose_capacity(device_, with_light_grid(most_paths, kernels_), scene_.where.guide != CLARAY_NO_TABLE,
                                kernels_.shaders.size());
}

void Wavefront::take_over(const Structure& structure, WavefrontKernels kernels) {
    scene_.structure = structure;
    if (kernels.shaders.size() > kernels_.shaders.size()) rays_[0] = rays_[1] = {};  // room for the lists
    kernels_ = std::move(kernels);
    path_kernel_.reset(), finish_kernel_.reset();
}

/// Which buffers there are depends on lights, a light tree, instances and motion.
void Wavefront::replace_scene(const SceneBuffers& scene) {
    const auto needs = [](const SceneBuffers& of) {
        return std::tuple(has_lights(of.lights), of.where.light_tree != CLARAY_NO_TABLE,
                          of.structure.instanced().has_value(), of.structure.moves());
    };
    if (needs(scene) != needs(scene_)) rays_[0] = rays_[1] = {};
    scene_ = scene;
    frame_.lights = scene.lights, frame_.tables = scene.where;
}

bool Wavefront::batches_are_small(std::uint64_t paths) const {
    return std::min<std::uint64_t>(paths, capacity()) <= most_whole_paths_;
}

bool Wavefront::paths_are_short() const {
    const Totals all = totals();
    const double most = device_.tuning(path_kernel_stem, "MOST_BOUNCES_PERMILLE") * 1e-3;
    return double(all.bounce) <= most * double(all.camera);
}

void Wavefront::generate(const Batch& batch, bool centers) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    const std::uint32_t items = device_.info().type == DeviceType::cpu ? (paths + 15) / 16 : paths;
    lengths_[0].fill(paths);
    kernels_.generate.run({items, 64}, batch, frame_, std::uint32_t(centers), scene_.tables, rays_[0], states_[0],
                          arg("radiance", radiance_), arg("times", times_[0]));
}

void Wavefront::trace(const Batch& batch) {
    make_room(batch.pixels * batch.samples);
    if (path_kernel_ && !is_guided() && batches_are_small(batch.pixels * batch.samples)) {
        trace_paths(batch);
        return;
    }
    generate(batch, false);
    kernels_.tile_sum ? sum_tiles(batch) : trace_stages(batch, false);
}

/// Camera rays only.
void Wavefront::sum_tiles(const Batch& batch) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    camera_rays_ += paths;
    kernels_.trace_camera.closest(rays_[0], hits_, paths, lengths_[0], times_[0]);
    kernels_.tile_sum->run(step_of(batch, 0, paths), scene_, rays_[0], queues_[0], hits_, radiance_);
    empty_queues(totals_);
}

void Wavefront::trace_from(const Buffer<Hit>& points, const Batch& batch) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    make_room(paths);
    lengths_[0].fill(paths);
    kernels_.generate.run(
        {paths, 64}, batch, arg("points", points), arg("positions", scene_.structure.triangles().positions),
        scene_.structure.triangles().indices, rays_[0], states_[0], arg("hits", hits_), arg("radiance", radiance_));
    trace_stages(batch, true);
}

void Wavefront::mark_cells(const GridBox& cells) {
    for_each_batch(cells, CLARAY_RAYS_PER_CELL, capacity_, [&](std::uint32_t first, std::uint32_t count) {
        const Batch batch{first, count, 0, CLARAY_RAYS_PER_CELL, 0};
        const std::uint32_t paths = count * CLARAY_RAYS_PER_CELL;
        make_room(paths);
        lengths_[0].fill(paths);
        kernels_.light_grid->aim_cells.run({paths, 64}, step_of(batch, 0, paths), cells, scene_.tables, queues_[0]);
        kernels_.trace_bounce.closest(rays_[0], hits_, paths, lengths_[0], times_[0]);
        kernels_.light_grid->mark_cells.run({count * CLARAY_GRID_WORDS, 64}, step_of(batch, 0, paths), cells, scene_,
                                            arg("grid_tables", scene_.tables), queues_[0], hits_);
        lengths_[0].fill(0);
    });
}

/// The rays begin where a path would be that met one surface.
void Wavefront::gather_probes(const GridBox& probes, const ProbeRays& rays) {
    const FrameData frame = frame_;
    frame_.seed = probe_seed, frame_.max_depth = most_surfaces_of_probes;
    for_each_batch(probes, rays.per_probe, capacity_, [&](std::uint32_t first, std::uint32_t count) {
        const Batch batch{first, count, rays.round * rays.per_probe, rays.per_probe, 0};
        const std::uint32_t paths = count * rays.per_probe;
        make_room(paths);
        lengths_[1].fill(paths);
        const std::uint32_t items = device_.info().type == DeviceType::cpu ? count : paths;
        kernels_.light_grid->aim_probes.run({items, device_.info().type == DeviceType::cpu ? 4u : 64u},
                                            step_of(batch, 1, paths), probes, scene_.tables, queues_[1], radiance_);
        trace_stages(batch, false, 1);
        kernels_.light_grid->gather_probes.run({count, 64}, step_of(batch, 1, paths), probes, rays.most_before,
                                               scene_.tables, radiance_);
    });
    frame_ = frame;
}

/// Only the light that arrives at the surfaces directly or from the grid.
void Wavefront::gather_voxels(const GridBox& voxels, const ProbeRays& rays) {
    const FrameData frame = frame_;
    frame_.seed = probe_seed + rays.round, frame_.max_depth = most_surfaces_of_probes;
    for_each_batch(voxels, CLARAY_RAYS_PER_VOXEL, capacity_, [&](std::uint32_t first, std::uint32_t count) {
        const Batch batch{first, count, 0, CLARAY_RAYS_PER_VOXEL, 0};
        const std::uint32_t paths = count * CLARAY_RAYS_PER_VOXEL;
        make_room(paths);
        lengths_[1].fill(paths);
        kernels_.light_grid->aim_voxels.run({paths, 64}, step_of(batch, 1, paths), voxels, scene_.tables, queues_[1],
                                            radiance_);
        bounce(batch, 1, paths, false);
        if (scene_.effects.has(Effect::sky)) {  // which the surfaces look for by one more ray
            bounce(batch, 2, paths, false);
            lengths_[1].fill(paths);
            kernels_.trace_bounce.closest(rays_[1], hits_, paths, lengths_[1], times_[1]);
        }
        kernels_.light_grid->gather_voxels.run({count, 64}, step_of(batch, 1, paths), voxels, rays.most_before, scene_,
                                               arg("grid_tables", scene_.tables), queues_[1], hits_,
                                               arg("radiance", radiance_));
        empty_queues(totals_);
    });
    frame_ = frame;
}

void Wavefront::show_voxels(const Batch& batch, const Buffer<float>& albedo) {
    trace_centers(batch, kernels_.trace_camera);
    kernels_.light_grid->show_voxels.run({batch.pixels, 64}, step_of(batch, 0, batch.pixels), scene_.tables, rays_[0],
                                         hits_, albedo);
}

/// After its last scattering a path may still meet a light or the sky.
std::uint32_t Wavefront::waves() const {
    const bool one_more =
        !(scene_.effects & effects_with(CLARAY_EMITS)).empty() && frame_.max_depth != ~std::uint32_t(0);
    return frame_.max_depth + (one_more ? 1 : 0);
}

void Wavefront::trace_paths(const Batch& batch) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    camera_rays_in_paths_ += paths;
    path_kernel_->run({paths, device_.tuning(path_kernel_stem, "GROUP_SIZE")}, step_of(batch, waves(), paths),
                      scene_.structure.bvh(), scene_, arg("radiance", radiance_), queue_lengths_);
    empty_queues(totals_in_paths_);
}

void Wavefront::trace_stages(const Batch& batch, bool arrived, std::uint32_t first_depth) {
    std::uint32_t limit = batch.pixels * batch.samples;  // upper limit of the rays in the queue
    camera_rays_ += limit;
    const std::uint32_t all = waves();
    for (std::uint32_t depth = first_depth; depth < all && limit != 0; ++depth) {
        bounce(batch, depth, limit, arrived && depth == 0);
        const bool looks = scene_.structure.parts() || (depth + 1) % bounces_per_look_ == 0;
        if (looks && depth + 1 < all) limit = lengths_[(depth + 1) % CLARAY_RAY_QUEUES].read()[0];
        if (finish_kernel_ && !is_guided() && limit != 0 && limit <= most_last_paths_ && depth + 1 < all) {
            trace_last_paths(batch, depth + 1, limit);
            break;
        }
    }
    empty_queues(totals_);
}

void Wavefront::trace_last_paths(const Batch& batch, std::uint32_t depth, std::uint32_t limit) {
    finish_kernel_->run({limit, device_.tuning(path_kernel_stem, "GROUP_SIZE")}, step_of(batch, depth, limit),
                        scene_.structure.bvh(), scene_, arg("queue", queues_[depth % 2]), arg("radiance", radiance_),
                        queue_lengths_, waves());
}

void Wavefront::bounce(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived) {
    scatter(batch, depth, limit, arrived, false);
    look_for_light(depth, limit);
}

void Wavefront::scatter(const Batch& batch, std::uint32_t depth, std::uint32_t limit, bool arrived, bool always) {
    const int in = depth % 2, out = 1 - in;
    SceneQuery& trace = depth == 0 ? kernels_.trace_camera : kernels_.trace_bounce;
    if (!arrived) trace.closest(rays_[in], hits_, limit, lengths_[depth % CLARAY_RAY_QUEUES], times_[in]);
    const std::uint32_t items = (limit + paths_per_item_ - 1) / paths_per_item_;
    Step step = step_of(batch, depth, limit);
    if (always) step.waves = ~std::uint32_t(0);
    const auto shade = [&](Kernel& kernel, const auto&... which) {
        kernel.run({items, shade_group_}, step, scene_, queue_lengths_, totals_, arg("queue", queues_[in]), hits_,
                   arg("next_queue", queues_[out]), shadow_queue_, arg("radiance", radiance_), which...);
    };
    if (kernels_.shaders.empty()) return shade(kernels_.shade[0]);
    kernels_.sort.run({limit, 64}, step, scene_, queue_lengths_, hits_, arg("sorted", sorted_));
    for (std::uint32_t i = 0; i < kernels_.shade.size(); ++i) shade(kernels_.shade[i], arg("sorted", sorted_), i);
}

void Wavefront::look_for_light(std::uint32_t depth, std::uint32_t limit) {
    if (has_lights(scene_.lights) && depth < frame_.max_depth)
        trace_shadows(limit, shadow_lengths_[depth % CLARAY_SHADOW_QUEUES]);
}

/// Sum of the throughput of next rays, without rays aimed at hot spots.
double Wavefront::carried_on(std::uint32_t depth, std::uint32_t rays) const {
    double sum = 0;
    std::vector<PathState> states(rays);
    states_[1 - depth % 2].read(std::span(states));
    for (const PathState& state : states)
        if ((state.flags & CLARAY_TO_HOT_SPOT) == 0)
            sum += double(state.throughput_r) + state.throughput_g + state.throughput_b;
    return sum;
}

double Wavefront::light_of(std::uint32_t paths) const {
    double sum = 0;
    std::vector<float> values(3 * std::size_t(paths));
    radiance_.read(std::span(values));
    for (const float value : values)
        if (std::isfinite(value)) sum += value;
    return sum;
}

void Wavefront::follow(const Batch& batch, std::uint32_t limit_of_depth, Carried& sums) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    make_room(paths);
    generate(batch, false);
    std::optional<double> within;
    std::uint32_t limit = paths;
    for (std::uint32_t depth = 0; depth < waves() && limit != 0; ++depth) {
        scatter(batch, depth, limit, false, true);
        if (depth == limit_of_depth) within = light_of(paths);  // including the emission of the last surface
        look_for_light(depth, limit);
        limit = lengths_[(depth + 1) % CLARAY_RAY_QUEUES].read()[0];
        if (depth + 1 == limit_of_depth) sums.dropped += carried_on(depth, limit);
        if (depth + 1 == frame_.max_depth) sums.left += carried_on(depth, limit);
    }
    empty_queues(totals_);
    const double all = light_of(paths);
    sums.within += within.value_or(all), sums.beyond += all - within.value_or(all);
}

/// Traces paths of a small image to twice the depth. The light found beyond the limit is missing, and so is the light
/// of the remaining throughput, which is assumed to carry as much light per throughput as at the limit: missing =
/// beyond + missing * left / dropped. This is exact if light falls by the same factor at each bounce.
double Wavefront::cut_off() const {
    if (kernels_.tile_sum) return 0;  // which answers for the first surface only
    constexpr std::uint32_t most_side = 128, paths = most_side * most_side;
    constexpr double slowest_fall = 0.99;  // the estimate is at most 100 times the light found
    constexpr double least_share = 1e-5;   // smallest share that so few paths can resolve
    FrameData frame = frame_;              // the same view in fewer pixels
    frame.width = std::min(frame.width, most_side), frame.height = std::min(frame.height, most_side);
    frame.seed = ~frame_.seed;
    frame.max_depth = std::max(frame_.max_depth, 2 * std::min(frame_.max_depth, 1u << 30));
    const std::uint32_t pixels = frame.width * frame.height;
    Wavefront probe(device_, scene_, frame, kernels_, paths);
    Carried sums;
    const std::uint32_t at_once = std::min(probe.capacity(), pixels), samples = std::max(1u, probe.capacity() / pixels);
    for (std::uint32_t first = 0; first < pixels; first += at_once)
        probe.follow({first, std::min(at_once, pixels - first), 0, samples, 0}, frame_.max_depth, sums);
    if (!(sums.beyond > 0)) return 0;
    const double missing = sums.beyond / (1 - std::min(sums.left / sums.dropped, slowest_fall));
    const double share = missing / (sums.within + missing);
    return share < least_share ? 0 : share;
}

void Wavefront::empty_queues(const Buffer<std::uint64_t>& totals) {
    kernels_.empty_queues.run({1, 1}, queue_lengths_, totals);
}

void Wavefront::trace_shadows(std::uint32_t limit, const Buffer<std::uint32_t>& length) {
    if (kernels_.adds_light) {
        kernels_.trace_shadow.shadow(shadow_rays_, {shadow_light_, radiance_}, limit, length);
        return;
    }
    if (kernels_.casts_shadows) kernels_.trace_shadow.any(shadow_rays_, occluded_, limit, length, shadow_times_);
    kernels_.add_light.run({limit, 64}, length, limit, occluded_, shadow_light_, radiance_);
}

void Wavefront::trace_centers(const Batch& batch, SceneQuery& trace) {
    make_room(batch.pixels * batch.samples);
    generate(batch, true);
    trace.closest(rays_[0], hits_, batch.pixels * batch.samples, lengths_[0], times_[0]);
    lengths_[0].fill(0);
}

Wavefront::Totals Wavefront::totals() const {
    const std::vector<std::uint64_t> stages = totals_.read(), paths = totals_in_paths_.read();
    return {camera_rays_ + camera_rays_in_paths_, stages[0] - camera_rays_ + paths[0], stages[1] + paths[1],
            camera_rays_in_paths_ + paths[0] + paths[1]};
}

void Wavefront::reset_totals() {
    camera_rays_ = camera_rays_in_paths_ = 0;
    totals_.fill(0), totals_in_paths_.fill(0);
}

std::uint64_t Wavefront::bytes() const {
    return buffer_bytes(queues_[0], queues_[1], shadow_queue_, hits_, occluded_, radiance_, queue_lengths_, sorted_,
                        totals_, totals_in_paths_, kernels_.trace_camera, kernels_.trace_bounce,
                        kernels_.trace_shadow) +
           (kernels_.tile_sum ? kernels_.tile_sum->bytes() : 0);
}

}  // namespace claray
