// What a renderer gives: images and pictures, statistics, voxels, AOVs.
#include "host/compute/memory.hpp"
#include "host/compute/read_back.hpp"
#include "host/denoise/denoised_image.hpp"
#include "host/render/light_grid/grid_rays.hpp"
#include "host/render/parts/scene_parts.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {

std::vector<glm::vec3> Renderer::image(unsigned width, unsigned height) const {
    return state_->film.image(state_->sizes(width, height));
}

void Renderer::image(std::span<glm::vec3> to, unsigned width, unsigned height) const {
    const ImageSizes size = state_->sizes(width, height);
    if (const std::size_t pixels = std::size_t(size.image_width) * size.image_height; to.size() != pixels)
        throw Error(claray::ErrorKind::usage, "an image of " + std::to_string(pixels) +
                                                  " pixels does not fit into memory for " + std::to_string(to.size()));
    state_->film.image(size, to);
}

std::span<const glm::vec3> Renderer::radiance(unsigned width, unsigned height) const {
    return state_->film.radiance(state_->sizes(width, height));
}

std::span<const std::uint8_t> Renderer::picture(const PictureConfig& config) const {
    State& state = *state_;
    const ImageSizes size = state.sizes(config.width, config.height);
    return state.mapper_of(size.image_width * size.image_height).map(state.film.resolve(size), config);
}

std::vector<glm::vec3> Renderer::denoised(DenoiserKind kind) const {
    State& state = *state_;
    DenoisingStage& stage = state.denoising_stage();
    if (picked_denoiser(kind) == DenoiserKind::oidn)
        return denoised_by_oidn({state.config.width, state.config.height, read_back(state.film.pixels()),
                                 read_back(stage.guides_of(state.noisy()))});
    VectorRoom<glm::vec3> image(state.pixels());
    read_back(stage.still(state.noisy()), image.span());
    return image.take();
}

std::span<const std::uint8_t> Renderer::denoised_picture(const PictureConfig& picture) {
    State& state = *state_;
    const Buffer<float>& image = state.denoising_stage().next_frame(state.noisy());
    return state.mapper_of(state.pixels()).map(image, picture);
}

void Renderer::release_denoiser() { state_->outputs.denoising.reset(); }

std::vector<float> Renderer::noise_map() const {
    std::vector<float> variances = state_->film.noise_map();
    const double factor = state_->noise_over_halves();
    for (float& variance : variances) variance *= float(factor * factor);
    return variances;
}

double Renderer::cut_off() const { return state_->cut_off(); }

RenderStatistics Renderer::statistics() const {
    const State& state = *state_;
    const RayTotals::Sums totals = state.wavefront.totals.sums();
    RenderStatistics statistics;
    statistics.build_milliseconds = state.time.build;
    statistics.bvh = state.buffers.structure.statistics();
    statistics.primitives = std::uint32_t(state.source.shape.primitives);
    statistics.camera = state.rays(trace_camera_name, totals.camera);
    statistics.bounce = state.rays(trace_bounce_name, totals.bounce);
    statistics.shadow = state.rays(trace_shadow_name, totals.shadow);
    statistics.in_paths = state.rays(trace_paths_name, totals.in_paths);
    if (totals.in_paths != 0)
        for (RayCount* count : {&statistics.camera, &statistics.bounce, &statistics.shadow}) count->milliseconds = 0;
    statistics.device_bytes = buffer_bytes(state.buffers, state.wavefront, state.film);
    const auto add = [&](const auto& stage) { statistics.device_bytes += stage ? stage->bytes() : 0; };
    const RenderOutputs& outputs = state.outputs;
    add(outputs.tone_mapper), add(outputs.aovs), add(outputs.gbuffer), add(outputs.denoising),
        add(state.sampling.guide);
    statistics.most_device_bytes = most_bytes_in_use(state.device);
    statistics.first_pixel_seconds = state.time.first_pixel;
    statistics.first_pixel_processor_seconds = state.time.first_pixel_processor;
    statistics.start = state.kernels.plan.start;
    statistics.own_kernels = state.kernels.are_own;
    statistics.own_kernels_from = state.kernels.own_from;
    statistics.effects = state.buffers.effects;
    for (const auto& [name, summary] : state.device.profiler().summary())
        if (summary.longest > statistics.longest_milliseconds)
            statistics.longest_milliseconds = summary.longest, statistics.longest_command = name;
    if (const std::shared_ptr<SceneParts>& parts = state.buffers.structure.parts())
        statistics.parts = unsigned(parts->parts().size()), statistics.bytes_paged = parts->bytes_paged();
    statistics.dropped_samples = state.film.noise().dropped;
    statistics.measuring_seconds = state.error.measuring_seconds;
    statistics.adapted = state.sampling.schedule.has_rounds();
    statistics.guided = state.sampling.guide && state.sampling.guide->guides();
    return statistics;
}

std::vector<glm::vec3> Renderer::voxels() const {
    State& state = *state_;
    if (!state.light_grid || !state.config.light_grid.voxels)
        throw Error(claray::ErrorKind::usage, "there are no voxels", "approximate by a light grid of voxels");
    state.follow_light();
    const std::uint32_t all = state.pixels(), most = std::min(state.wavefront.queues.capacity, all);
    VectorRoom<glm::vec3> albedo(all);
    Buffer<float> part(state.device, 3 * std::size_t(most));
    for (std::uint32_t first = 0; first < all; first += most) {
        const std::uint32_t count = std::min(most, all - first);
        show_voxels(state.wavefront, {first, count, 0, 1, 0}, part);
        read_back(part, albedo.span().subspan(first, count));
    }
    return albedo.take();
}

Aovs Renderer::aovs() const {
    State& state = *state_;
    const std::size_t pixels = state.pixels();
    AovStage& stage = state.aov_stage();
#define CLARAY_ROOM(name, kind, letters, meaning) VectorRoom<aov_kinds::kind> name(pixels);
    CLARAY_AOVS(CLARAY_ROOM)
#undef CLARAY_ROOM
    for (std::size_t first = 0; first < pixels; first += stage.capacity()) {
        const std::size_t n = std::min<std::size_t>(stage.capacity(), pixels - first);
        stage.run(state.wavefront, std::uint32_t(first), std::uint32_t(n));
#define CLARAY_READ(name, kind, letters, meaning) read_back(stage.name, name.span().subspan(first, n));
        CLARAY_AOVS(CLARAY_READ)
#undef CLARAY_READ
    }
#define CLARAY_TAKE(name, kind, letters, meaning) name.take(),
    Aovs aovs{CLARAY_AOVS(CLARAY_TAKE)};
#undef CLARAY_TAKE
    if (!state.source.shape.numbers.empty())
        for (std::uint32_t& triangle : aovs.primitive) triangle = state.source.shape.numbers.number_there(triangle);
    return aovs;
}

}  // namespace claray
