#include "host/render/guides.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr std::uint32_t samples_of_all = 4;  // camera rays of every pixel
// At borders of lamps, where a pixel's noise is that of coverage: so many times the film's samples, within these
// limits.
constexpr std::uint32_t edge_factor = 16, least_at_edges = 256, most_at_edges = 4096;
/// The most rays at borders, per pixel of the image.
std::uint64_t edge_rays_per_pixel(std::uint32_t spp) { return 2 + spp / 8; }
constexpr const char* file = "render/write_guides.cl";

Defines defines_for(const SceneBuffers& scene, Sampler sampler) {
    Defines defines = defines_of(scene.effects, Stage::generate);
    for (const auto& more : {defines_of(scene.effects, Stage::shade), scene.structure.defines()})
        for (const auto& define : more)
            if (std::find(defines.begin(), defines.end(), define) == defines.end()) defines.push_back(define);
    defines.emplace_back("SAMPLER", std::to_string(std::uint32_t(sampler)));
    return defines;
}

QueryOptions camera_rays(const SceneBuffers& scene) {
    QueryOptions options;
    options.coherence = Coherence::coherent;
    options.cull_back_faces = scene.textures.culls_back_faces;
    return options;
}

}  // namespace

Guides::Guides(const Device& device, const SceneBuffers& scene, Sampler sampler)
    : device_(device),
      scene_(scene),
      capacity_(std::max(most_at_edges, device.tuning("render/wavefront", "PATHS"))),
      query_(scene.structure, QueryKernel::Kind::closest, camera_rays(scene), "trace_guide_rays"),
      length_(device, 1) {
    const Defines defines = defines_for(scene, sampler);
    start_ = load_kernel(device, file, "guide_rays", defines);
    see_ = load_kernel(device, file, "see_surfaces", defines);
    write_ = load_kernel(device, file, "write_guides", defines);
    list_edges_ = load_kernel(device, file, "list_edges", defines);
}

const Buffer<Guide>& Guides::trace(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t spp) {
    const std::uint32_t pixels = frame.width * frame.height;
    guides_.reserve(device_, pixels), list_.reserve(device_, pixels);
    trace_pixels(frame, film, pixels, samples_of_all, false);
    const std::uint32_t edges = find_edges(frame);
    if (edges == 0) return guides_;
    const std::uint64_t affordable = std::uint64_t(pixels) * edge_rays_per_pixel(spp) / edges;
    const auto samples = std::uint32_t(
        std::min<std::uint64_t>(std::clamp(edge_factor * spp, least_at_edges, most_at_edges), affordable));
    if (samples > spp) trace_pixels(frame, film, edges, samples, true);
    return guides_;
}

std::uint32_t Guides::find_edges(const FrameData& frame) {
    length_.fill(0);
    list_edges_.run({std::size_t(frame.width) * frame.height, 64}, frame.width, frame.height, guides_,
                    arg("list", list_), arg("edges", length_));
    return length_.read()[0];
}

void Guides::make_room(std::size_t rays) {
    if (sights_.allocated() && sights_.size() >= rays) return;
    for (int i = 0; i < 2; ++i) {
        rays_[i] = Buffer<Ray>(device_, rays), numbers_[i] = Buffer<std::uint32_t>(device_, 1 + rays);
        if (scene_.structure.moves()) times_[i] = Buffer<float>(device_, rays);
    }
    hits_ = SceneHits(scene_.structure, rays);
    sights_ = Buffer<Sight>(device_, rays);
}

void Guides::trace_pixels(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t count,
                          std::uint32_t samples, bool listed) {
    const std::uint32_t at_once = std::min(count, std::max(1u, capacity_ / samples));
    make_room(std::size_t(at_once) * samples);
    for (std::uint32_t first = 0; first < count; first += at_once) {
        const std::uint32_t pixels = std::min(at_once, count - first);
        const GuideStep guide{{{first, pixels, 0, samples, 0}, frame, 0, pixels * samples, 0}, std::uint32_t(listed)};
        see(guide);
        write_.run({pixels, 64}, guide, list_, film, sights_, guides_);
    }
}

void Guides::see(GuideStep guide) {
    std::uint32_t& count = guide.step.capacity;
    start_.run({count, 64}, guide, list_, rays_[0], times_[0]);
    numbers_[0].write(std::span<const std::uint32_t>(&count, 1));
    for (; count != 0; ++guide.step.depth) {
        const int in = guide.step.depth % 2, out = 1 - in;
        query_.closest(rays_[in], hits_, count, numbers_[in], times_[in]);
        constexpr std::uint32_t none = 0;
        numbers_[out].write(std::span<const std::uint32_t>(&none, 1));
        see_.run({count, 64}, guide, arg("list", list_), scene_, arg("rays", rays_[in]), hits_,
                 arg("numbers", numbers_[in]), sights_, arg("next_rays", rays_[out]), arg("next_times", times_[out]),
                 arg("next_numbers", numbers_[out]));
        numbers_[out].read(std::span<std::uint32_t>(&count, 1));
    }
}

}  // namespace claray
