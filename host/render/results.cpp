// What a renderer gives: images and pictures, statistics, voxels, AOVs.
#include "host/compute/memory.hpp"
#include "host/compute/read_back.hpp"
#include "host/denoise/denoised_image.hpp"
#include "host/render/light_grid/grid_rays.hpp"
#include "host/render/parts/scene_parts.hpp"
#include "host/render/renderer_state.hpp"

namespace claray {

std::vector<glm::vec3> Renderer::image(unsigned width, unsigned height) const {
    const ImageSizes size = state_->sizes(width, height);
    std::vector<glm::vec3> image = state_->film.image(size);
    if (state_->outputs.matte) state_->outputs.matte->finish(size, image);
    return image;
}

void Renderer::image(std::span<glm::vec3> to, unsigned width, unsigned height) const {
    const ImageSizes size = state_->sizes(width, height);
    if (const std::size_t pixels = std::size_t(size.image_width) * size.image_height; to.size() != pixels)
        throw Error(claray::ErrorKind::usage, "an image of " + std::to_string(pixels) +
                                                  " pixels does not fit into memory for " + std::to_string(to.size()));
    state_->film.image(size, to);
    if (state_->outputs.matte) state_->outputs.matte->finish(size, to);
}

std::span<const glm::vec3> Renderer::radiance(unsigned width, unsigned height) const {
    if (!state_->has_catchers()) return state_->film.radiance(state_->sizes(width, height));
    return state_->outputs.matte->room() = image(width, height);
}

std::span<const std::uint8_t> Renderer::picture(const PictureConfig& config) const {
    State& state = *state_;
    const ImageSizes size = state.sizes(config.width, config.height);
    ToneMapper& mapper = state.mapper_of(size.image_width * size.image_height);
    if (!state.has_catchers()) return mapper.map(state.film.resolve(size), config);
    const std::span<const glm::vec3> pixels = radiance(size.image_width, size.image_height);
    return mapper.map(Buffer<float>(state.device, std::span(&pixels[0].x, 3 * pixels.size())), config);
}

std::vector<float> Renderer::alpha() const {
    const std::optional<Matte>& matte = state_->outputs.matte;
    return matte ? matte->alpha() : std::vector<float>(state_->pixels(), 1.f);
}

std::vector<glm::vec3> Renderer::denoised(DenoiserKind kind) const {
    State& state = *state_;
    state.refuse_with_region("a region cannot be denoised: its edges would need the pixels beyond");
    DenoisingStage& stage = state.denoising_stage();
    const auto finished = [&](std::vector<glm::vec3> image) {
        if (state.outputs.matte) state.outputs.matte->finish(state.sizes(0, 0), image);
        return image;
    };
    if (picked_denoiser(kind) == DenoiserKind::oidn)
        return finished(denoised_by_oidn({state.config.width, state.config.height, read_back(state.film.pixels()),
                                          read_back(stage.guides_of(state.noisy()))}));
    VectorRoom<glm::vec3> image(state.pixels());
    read_back(stage.still(state.noisy()), image.span());
    return finished(image.take());
}

std::span<const std::uint8_t> Renderer::denoised_picture(const PictureConfig& picture) {
    State& state = *state_;
    state.refuse_with_region("a region cannot be denoised: its edges would need the pixels beyond");
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
    add(outputs.tone_mapper), add(outputs.aovs), add(outputs.gbuffer), add(outputs.denoising), add(outputs.matte),
        add(outputs.light_layers), add(state.sampling.guide);
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
    state.refuse_with_region("voxels are shown in whole images only");
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

std::vector<LightLayer> Renderer::light_layers() const {
    const State& state = *state_;
    if (!state.outputs.light_layers)
        throw Error(claray::ErrorKind::usage, "the render keeps no layers of light", "ask for lobes or light_groups");
    return state.outputs.light_layers->read(state.film.image(), state.film.sums());
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
        stage.run(state.wavefront, state.in_image({std::uint32_t(first), std::uint32_t(n), 0, 1, 0}));
#define CLARAY_READ(name, kind, letters, meaning) read_back(stage.name, name.span().subspan(first, n));
        CLARAY_AOVS(CLARAY_READ)
#undef CLARAY_READ
    }
#define CLARAY_TAKE(name, kind, letters, meaning) name.take(),
    Aovs aovs{CLARAY_AOVS(CLARAY_TAKE)};
#undef CLARAY_TAKE
    const SceneShape& shape = state.source.shape;
    for (std::size_t i = 0; i < pixels; ++i) {
        aovs.instance[i] = shape.surfaces.instance_of(aovs.primitive[i], aovs.instance[i]);
        aovs.primitive[i] = shape.numbers.number_there(aovs.primitive[i]);
        aovs.object[i] = shape.surfaces.object_of(aovs.primitive[i]);
    }
    return aovs;
}

}  // namespace claray
