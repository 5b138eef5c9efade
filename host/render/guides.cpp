#include "host/render/guides.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/wavefront.hpp"

namespace claray {
namespace {

constexpr std::uint32_t samples_of_all = 4;  // camera rays of every pixel
constexpr std::uint32_t most_at_edges = 4096;
/// Rays at edges, per pixel of the image.
std::uint64_t edge_rays_per_pixel(std::uint32_t spp) { return getenv("EDGE") ? atoi(getenv("EDGE")) : 2 + spp / 8; }
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

using EdgeCounts = std::array<std::uint32_t, CLARAY_EDGE_CLASSES>;

/// Rays for each pixel of a class: in proportion to its difference, since that is the noise of one ray. Classes for
/// which there would be `too_few` get none.
EdgeCounts share_rays(const EdgeCounts& pixels, double rays, std::uint32_t too_few) {
    EdgeCounts samples{};
    for (std::size_t lowest = 0; lowest < pixels.size(); ++lowest) {
        double sum = 0, left = rays;
        for (std::size_t i = lowest; i < pixels.size(); ++i) sum += pixels[i] * std::pow(4.0, double(i));
        for (std::size_t i = pixels.size(); i-- > lowest;) {
            const double weight = std::pow(4.0, double(i));
            samples[i] = pixels[i] == 0 ? 0 : std::uint32_t(std::min(double(most_at_edges), left * weight / sum));
            left -= double(samples[i]) * pixels[i], sum -= weight * pixels[i];
        }
        while (lowest < pixels.size() && pixels[lowest] == 0) ++lowest;
        if (lowest == pixels.size() || samples[lowest] > too_few) break;
        samples[lowest] = 0;
    }
    return samples;
}

/// At most a 16th of the device's memory, as the wavefront, but the most rays of one pixel.
std::uint32_t choose_capacity(const Device& device) {
    constexpr std::uint64_t bytes_per_ray =
        2 * (sizeof(Ray) + sizeof(float) + sizeof(std::uint32_t)) + sizeof(InstanceHit) + sizeof(Sight);
    const std::uint64_t tuned = device.tuning("render/wavefront", "PATHS");
    const std::uint64_t memory = device.info().memory / share_of_wavefront / bytes_per_ray;
    return std::uint32_t(std::max<std::uint64_t>(most_at_edges, std::min(tuned, memory)));
}

}  // namespace

Guides::Guides(const Device& device, const SceneBuffers& scene, Sampler sampler)
    : device_(device),
      scene_(scene),
      capacity_(choose_capacity(device)),
      bounces_per_look_(std::max(1u, device.tuning("render/wavefront", "BOUNCES_PER_LOOK"))),
      query_(scene.structure, QueryKernel::Kind::closest, camera_rays(scene), "trace_guide_rays"),
      counts_(device, CLARAY_EDGE_CLASSES),
      ends_(device, CLARAY_EDGE_CLASSES) {
    const Defines defines = defines_for(scene, sampler);
    start_ = load_kernel(device, file, "guide_rays", defines);
    see_ = load_kernel(device, file, "see_surfaces", defines);
    write_ = load_kernel(device, file, "write_guides", defines);
    find_edges_ = load_kernel(device, file, "find_edges", defines);
    list_edges_ = load_kernel(device, file, "list_edges", defines);
}

const Buffer<Guide>& Guides::trace(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t spp) {
    const std::uint32_t pixels = frame.width * frame.height;
    guides_.reserve(device_, pixels), list_.reserve(device_, pixels), classes_.reserve(device_, pixels);
    trace_pixels(frame, film, {0, pixels}, samples_of_all, false);
    counts_.fill(0);
    find_edges_.run({pixels, 64}, frame.width, frame.height, guides_, classes_, counts_);
    EdgeCounts counts{}, starts{};
    counts_.read(std::span(counts));
    for (std::size_t i = 1; i < counts.size(); ++i) starts[i] = starts[i - 1] + counts[i - 1];
    const double rays = double(pixels) * double(edge_rays_per_pixel(spp));
    const EdgeCounts samples = share_rays(counts, rays, std::max(spp + spp / 2, 2 * samples_of_all));
    if (samples == EdgeCounts{}) return guides_;
    ends_.write(std::span<const std::uint32_t>(starts));
    list_edges_.run({pixels, 64}, pixels, classes_, arg("list", list_), arg("ends", ends_));
    for (std::size_t i = 0; i < counts.size(); ++i)
        if (samples[i] > 0) trace_pixels(frame, film, {starts[i], counts[i]}, samples[i], true);
    return guides_;
}

std::uint64_t Guides::bytes() const {
    std::uint64_t bytes = hits_.bytes() + sights_.bytes() + classes_.bytes() + list_.bytes() + counts_.bytes() +
                          ends_.bytes() + guides_.bytes();
    for (int i = 0; i < 2; ++i) bytes += rays_[i].bytes() + times_[i].bytes() + numbers_[i].bytes();
    return bytes;
}

void Guides::make_room(std::size_t rays) {
    if (sights_.allocated() && sights_.size() >= rays) return;
    for (int i = 0; i < 2; ++i) {
        rays_[i] = Buffer<Ray>(device_, rays), numbers_[i] = Buffer<std::uint32_t>(device_, 1 + rays);
        lengths_[i] = Buffer<std::uint32_t>(numbers_[i], 0, 1);
        if (scene_.structure.moves()) times_[i] = Buffer<float>(device_, rays);
    }
    hits_ = SceneHits(scene_.structure, rays);
    sights_ = Buffer<Sight>(device_, rays);
}

void Guides::trace_pixels(const FrameData& frame, const Buffer<FilmPixel>& film, Elements range, std::uint32_t samples,
                          bool listed) {
    const std::uint32_t at_once = std::min(range.count, std::max(1u, capacity_ / samples)),
                        end = range.first + range.count;
    make_room(std::size_t(at_once) * samples);
    for (std::uint32_t first = range.first; first < end; first += at_once) {
        const std::uint32_t pixels = std::min(at_once, end - first);
        const Batch batch{first, pixels, 0, samples, 0};
        const GuideStep guide{{batch, frame, 0, pixels * samples, 0, 0}, std::uint32_t(listed)};
        see(guide);
        write_.run({pixels, 64}, guide, list_, film, sights_, guides_);
    }
}

void Guides::see(GuideStep guide) {
    std::uint32_t& count = guide.step.capacity;
    const bool cpu = device_.info().type == DeviceType::cpu;
    start_.run({cpu ? (count + 15) / 16 : count, 64}, guide, list_, rays_[0], times_[0]);
    lengths_[0].fill(count);
    while (count != 0) {
        const int in = guide.step.depth % 2, out = 1 - in;
        query_.closest(rays_[in], hits_, count, numbers_[in], times_[in]);
        lengths_[out].fill(0);
        see_.run({count, 64}, guide, arg("list", list_), scene_, arg("rays", rays_[in]), hits_,
                 arg("numbers", numbers_[in]), sights_, arg("next_rays", rays_[out]), arg("next_times", times_[out]),
                 arg("next_numbers", numbers_[out]));
        if (++guide.step.depth % bounces_per_look_ == 0) lengths_[out].read(std::span<std::uint32_t>(&count, 1));
    }
}

}  // namespace claray
