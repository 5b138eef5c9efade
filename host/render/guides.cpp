#include "host/render/guides.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/wavefront/queues.hpp"

namespace claray {
namespace {

constexpr std::uint32_t samples_of_all = 4;  // camera rays of every pixel
/// Rays at edges are traced in two passes: the first tells where the noise is.
constexpr double share_of_first_pass = 0.25;
/// Further rays of a pixel at an edge that are no more than the film's samples do not pay.
std::uint32_t too_few(std::uint32_t spp) { return std::max(spp, samples_of_all); }
constexpr std::uint32_t most_at_edges = 4096;
/// Rays at edges, per pixel of the image.
double edge_rays_per_pixel(std::uint32_t spp) { return 1 + spp / 8.0; }
constexpr const char* file = "render/write_guides.cl";

Defines defines_for(const SceneBuffers& scene, EffectSet effects, Sampler sampler) {
    Defines defines = defines_of(effects, Stage::generate);
    for (const auto& more : {defines_of(effects, Stage::shade), scene.structure.defines()})
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

/// Rays for each pixel of a class: in proportion to the deviation of one ray, which gives the least squared error.
/// Classes for which there would be `too_few` get none.
EdgeCounts share_rays(const EdgeCounts& pixels, double rays, std::uint32_t too_few) {
    EdgeCounts samples{};
    for (std::size_t lowest = 0; lowest < pixels.size(); ++lowest) {
        double sum = 0, left = rays;
        for (std::size_t i = lowest; i < pixels.size(); ++i) sum += pixels[i] * std::exp2(0.5 * double(i));
        for (std::size_t i = pixels.size(); i-- > lowest;) {
            const double weight = std::exp2(0.5 * double(i));
            if (pixels[i] == 0) continue;
            const double each = std::min(double(most_at_edges), left * weight / sum);
            samples[i] = std::uint32_t(each);
            left -= each * pixels[i], sum -= weight * pixels[i];
        }
        while (lowest < pixels.size() && pixels[lowest] == 0) ++lowest;
        if (lowest == pixels.size() || samples[lowest] > too_few) break;
        samples[lowest] = 0;
    }
    return samples;
}

/// At most a 16th of the device's memory, as the wavefront, but at least the most rays of one pixel.
std::uint32_t choose_capacity(const Device& device) {
    constexpr std::uint64_t bytes_per_ray =
        2 * (sizeof(Ray) + sizeof(float) + sizeof(std::uint32_t)) + sizeof(InstanceHit) + sizeof(Sight);
    const std::uint64_t tuned = device.tuning("render/wavefront", "PATHS");
    const std::uint64_t memory = device.info().memory / share_of_wavefront / bytes_per_ray;
    return std::uint32_t(std::max<std::uint64_t>(most_at_edges, std::min(tuned, memory)));
}

}  // namespace

Guides::Guides(const Device& device, const SceneBuffers& scene, EffectSet effects, Sampler sampler)
    : device_(device),
      scene_(scene),
      capacity_(choose_capacity(device)),
      bounces_per_look_(std::max(1u, device.tuning("render/wavefront", "BOUNCES_PER_LOOK"))),
      query_(scene.structure, QueryKernel::Kind::closest, camera_rays(scene), "trace_guide_rays"),
      runs_(device, CLARAY_EDGE_CLASSES),
      counts_(device, CLARAY_EDGE_CLASSES),
      ends_(device, CLARAY_EDGE_CLASSES) {
    for (Buffer<std::uint32_t>& ray_count : ray_counts_) ray_count = Buffer<std::uint32_t>(device, 1);
    const Defines defines = defines_for(scene, effects, sampler);
    start_ = load_kernel(device, file, "guide_rays", defines);
    see_ = load_kernel(device, file, "see_surfaces", defines);
    write_ = load_kernel(device, file, "write_guides", defines);
    find_edges_ = load_kernel(device, file, "find_edges", defines);
    list_edges_ = load_kernel(device, file, "list_edges", defines);
}

const Buffer<Guide>& Guides::trace(const FrameData& frame, const Buffer<FilmPixel>& film, std::uint32_t spp) {
    const std::uint32_t pixels = frame.width * frame.height;
    guides_.reserve(device_, pixels), glows_.reserve(device_, pixels), list_.reserve(device_, 2 * std::size_t(pixels)),
        classes_.reserve(device_, pixels);
    trace_runs(frame, film, {{pixels, samples_of_all}}, 0, false);
    const double rays = double(pixels) * edge_rays_per_pixel(spp);
    const double first = trace_edges(frame, film, share_of_first_pass * rays, rays, spp);
    if (first > 0 && first < rays) (void)trace_edges(frame, film, rays - first, rays - first, spp);
    return guides_;
}

double Guides::trace_edges(const FrameData& frame, const Buffer<FilmPixel>& film, double wanted_rays, double most_rays,
                           std::uint32_t spp) {
    const std::uint32_t pixels = frame.width * frame.height;
    counts_.fill(0);
    find_edges_.run({pixels, 64}, frame.width, frame.height, glows_, classes_, counts_);
    EdgeCounts counts{}, starts{};
    counts_.read(std::span(counts));
    for (std::size_t i = 1; i < counts.size(); ++i) starts[i] = starts[i - 1] + counts[i - 1];
    EdgeCounts samples = share_rays(counts, wanted_rays, too_few(spp));
    if (samples == EdgeCounts{}) samples = share_rays(counts, most_rays, too_few(spp));
    if (samples == EdgeCounts{}) return 0;
    ends_.write(std::span<const std::uint32_t>(starts));
    list_edges_.run({pixels, 64}, pixels, glows_, classes_, arg("list", list_), arg("ends", ends_));
    std::vector<Run> runs;
    std::uint32_t without = 0;  // pixels of the lowest classes
    double rays = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        rays += double(samples[i]) * counts[i];
        samples[i] > 0 ? runs.push_back({counts[i], samples[i]}) : void(without += counts[i]);
    }
    trace_runs(frame, film, runs, without, true);
    return rays;
}

std::uint64_t Guides::bytes() const {
    std::uint64_t bytes = hits_.bytes() + sights_.bytes() + classes_.bytes() + list_.bytes() + counts_.bytes() +
                          ends_.bytes() + guides_.bytes() + glows_.bytes() + runs_.bytes();
    for (int i = 0; i < 2; ++i) bytes += rays_[i].bytes() + times_[i].bytes() + numbers_[i].bytes();
    for (const Buffer<std::uint32_t>& ray_count : ray_counts_) bytes += ray_count.bytes();
    return bytes;
}

void Guides::make_room(std::size_t rays) {
    if (sights_.allocated() && sights_.size() >= rays) return;
    for (int i = 0; i < 2; ++i) {
        rays_[i] = Buffer<Ray>(device_, rays), numbers_[i] = Buffer<std::uint32_t>(device_, rays);
        if (scene_.structure.moves()) times_[i] = Buffer<float>(device_, rays);
    }
    hits_ = SceneHits(scene_.structure, rays);
    sights_ = Buffer<Sight>(device_, rays);
}

/// Pixels of a list have many rays: on CPUs few of them make a work-group, elsewhere many work-items take one.
Range Guides::range_of_writing(std::uint32_t pixels, bool listed) const {
    if (device_.info().type == DeviceType::cpu) return {pixels, 4};
    return {std::size_t(listed ? CLARAY_LANES_OF_EDGE : 1) * pixels, CLARAY_GUIDE_GROUP};
}

/// As many pixels at a time as there is room for.
void Guides::trace_runs(const FrameData& frame, const Buffer<FilmPixel>& film, const std::vector<Run>& runs,
                        std::uint32_t first_pixel, bool listed) {
    std::uint64_t all = 0;
    for (const Run& run : runs) all += std::uint64_t(run.pixels) * run.samples;
    make_room(std::min<std::uint64_t>(all, capacity_));
    GuideStep guide{{{first_pixel, 0, 0, 0, 0}, frame, 0, 0, 0, 0}, std::uint32_t(listed), 0};
    std::vector<GuideRun> batch_runs;
    Batch& batch = guide.step.batch;
    const auto trace_batch = [&] {
        guide.run_count = std::uint32_t(batch_runs.size());
        runs_.write(std::span<const GuideRun>(batch_runs));
        see(guide);
        write_.run(range_of_writing(batch.pixels, listed), guide, runs_, list_, film, sights_, guides_, glows_);
        batch.first_pixel += batch.pixels, batch.pixels = 0, guide.step.capacity = 0;
        batch_runs.clear();
    };
    for (const Run& run : runs)
        for (std::uint32_t left = run.pixels; left != 0;) {
            const std::uint32_t pixels = std::min(left, (capacity_ - guide.step.capacity) / run.samples);
            if (pixels == 0) {
                trace_batch();
                continue;
            }
            batch_runs.push_back({batch.pixels, guide.step.capacity, run.samples});
            batch.pixels += pixels, guide.step.capacity += pixels * run.samples, left -= pixels;
        }
    if (batch.pixels != 0) trace_batch();
}

void Guides::see(GuideStep guide) {
    std::uint32_t& count = guide.step.capacity;
    const bool cpu = device_.info().type == DeviceType::cpu;
    start_.run({cpu ? (count + 15) / 16 : count, 64}, guide, runs_, arg("list", list_), arg("rays", rays_[0]),
               arg("times", times_[0]), arg("ray_count", ray_counts_[0]), arg("next_count", ray_counts_[1]));
    while (count != 0) {
        const std::uint32_t depth = guide.step.depth, in = depth % 2, out = 1 - in;
        const Buffer<std::uint32_t>&ray_count = ray_counts_[depth % 3], &next_count = ray_counts_[(depth + 1) % 3];
        query_.closest(rays_[in], hits_, count, ray_count, times_[in]);
        see_.run(cpu ? Range{(count + 15) / 16, 4} : Range{count, 64}, guide, runs_, arg("list", list_), scene_,
                 arg("rays", rays_[in]), hits_, arg("numbers", numbers_[in]), sights_, arg("next_rays", rays_[out]),
                 arg("next_times", times_[out]), arg("next_numbers", numbers_[out]), arg("ray_count", ray_count),
                 arg("next_count", next_count), arg("count_after_next", ray_counts_[(depth + 2) % 3]));
        if (++guide.step.depth % bounces_per_look_ == 0) next_count.read(std::span<std::uint32_t>(&count, 1));
    }
}

}  // namespace claray
