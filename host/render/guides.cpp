#include "host/render/guides.hpp"

#include <algorithm>

namespace claray {
namespace {

constexpr std::uint32_t least_samples = 4, most_samples = 8;  // of every pixel
constexpr std::uint32_t edge_factor = 4, least_at_edges = 16, most_at_edges = 1024;
constexpr std::uint64_t edge_rays_per_pixel = 8;  // of the image, at most
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
      length_(device, 1),
      rays_count_(device, 1) {
    const Defines defines = defines_for(scene, sampler);
    rays_kernel_ = load_kernel(device, file, "guide_rays", defines);
    write_ = load_kernel(device, file, "write_guides", defines);
    list_edges_ = load_kernel(device, file, "list_edges", defines);
}

const Buffer<Guide>& Guides::trace(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t spp) {
    const std::uint32_t pixels = frame.width * frame.height;
    guides_.reserve(device_, pixels), list_.reserve(device_, pixels);
    trace_pixels(frame, film, pixels, std::clamp(spp, least_samples, most_samples), false);
    const std::uint32_t edges = find_edges(frame);
    if (edges == 0) return guides_;
    const std::uint64_t affordable = std::uint64_t(pixels) * (edge_rays_per_pixel + spp / 2) / edges;
    const auto samples = std::uint32_t(
        std::min<std::uint64_t>(std::clamp(edge_factor * spp, least_at_edges, most_at_edges), affordable));
    if (samples > spp) trace_pixels(frame, film, edges, samples, true);
    return guides_;
}

std::uint32_t Guides::find_edges(const FrameData& frame) {
    length_.fill(0);
    list_edges_.run({std::size_t(frame.width) * frame.height, 64}, frame.width, frame.height, guides_, arg("list", list_), arg("edges", length_));
    return length_.read()[0];
}

void Guides::trace_pixels(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t count,
                          std::uint32_t samples, bool listed) {
    const std::uint32_t at_once = std::min(count, std::max(1u, capacity_ / samples));
    const std::size_t most = std::size_t(at_once) * samples;
    if (rays_.size() < most || !rays_.allocated()) {
        rays_ = Buffer<Ray>(device_, most);
        hits_ = SceneHits(scene_.structure, most);
        if (scene_.structure.moves()) times_ = Buffer<float>(device_, most);
    }
    for (std::uint32_t first = 0; first < count; first += at_once) {
        const Batch batch{first, std::min(at_once, count - first), 0, samples};
        const std::uint32_t rays = batch.pixels * samples;
        rays_kernel_.run({rays, 64}, batch, frame, std::uint32_t(listed), list_, rays_, times_);
        rays_count_.fill(rays);
        query_.closest(rays_, hits_, rays, rays_count_, times_);
        write_.run({batch.pixels, 64}, batch, frame, std::uint32_t(listed), arg("list", list_), film, scene_, rays_,
                   hits_, arg("times", times_), guides_);
    }
}

}  // namespace claray
