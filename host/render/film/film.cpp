#include "host/render/film/film.hpp"

#include <algorithm>
#include <cmath>

#include "host/compute/read_back.hpp"

namespace claray {
KernelsOf<Film::Kernels> Film::Kernels::requests() {
    return {{&Kernels::accumulate, {"render/accumulate_film.cl", "accumulate_film", {}}},
            {&Kernels::resolve, {"render/resolve_film.cl", "resolve_film", {}}},
            {&Kernels::measure, {"render/measure_film.cl", "measure_film", {}}}};
}

Film::Film(const Device& device, std::uint32_t pixels, float sample_clamp)
    : device_(device),
      count_(pixels),
      sample_clamp_(sample_clamp),
      items_(std::min(CLARAY_SUM_ITEMS, pixels)),
      pixels_(device, pixels),
      sums_(device, (items_ + CLARAY_SUM_GROUP - 1) / CLARAY_SUM_GROUP),
      dropped_(device, 1),
      kernels_(device) {
    clear();
}

void Film::accumulate(const Batch& batch, const Buffer<float>& radiance, const Buffer<std::uint32_t>& tables,
                      std::uint32_t listed) {
    const bool begins = !batch.listed && batch.first_pixel == begun_;
    if (begins)
        begun_ += batch.pixels;
    else if (batch.listed || batch.first_pixel + batch.pixels > begun_)
        begin_all();
    has_single_samples_ = has_single_samples_ && begins && batch.samples == 1;
    add(batch, radiance, tables, listed, begins);
    forget_look();
}

void Film::add(const Batch& batch, const Buffer<float>& radiance, const Buffer<std::uint32_t>& tables,
               std::uint32_t listed, bool begins) const {
    const auto flag = std::uint32_t(begins);
    kernels_.accumulate.run({batch.pixels, 64}, batch, arg("tables", tables), listed, flag, sample_clamp_, radiance,
                            pixels_, arg("dropped", dropped_));
}

void Film::begin_all() const {
    if (begun_ < count_) add({begun_, count_ - begun_, 0, 0, 0}, {}, {}, 0, true);
    begun_ = count_;
}

void Film::forget_look() {
    totals_.reset();
    looks_ = false;
}

void Film::clear() {
    begun_ = 0;
    has_single_samples_ = true;
    dropped_.fill(0);
    forget_look();
}

std::vector<FilmPixel> Film::sums() const {
    std::vector<FilmPixel> sums(count_);
    read_sums(sums);
    return sums;
}

void Film::read_sums(std::span<FilmPixel> to, std::uint32_t first) const {
    begin_all();
    pixels_.read(to, first);
}

void Film::set_sums(std::span<const FilmPixel> sums, std::uint32_t first) {
    begin_all();
    has_single_samples_ = false;
    pixels_.write(sums, first);
    forget_look();
}

const Buffer<float>& Film::resolve(const ImageSizes& size) const {
    const std::uint32_t pixels = size.image_width * size.image_height;
    begin_all();
    image_.reserve(device_, 3 * std::size_t(pixels));
    kernels_.resolve.run({pixels, 64}, pixels_, size, image_);
    return image_;
}

const HostMemory& Film::on_host(std::size_t bytes) const {
    if (room_on_host_ < bytes) on_host_ = std::make_shared<HostMemory>(device_, bytes), room_on_host_ = bytes;
    return *on_host_;
}

std::span<const glm::vec3> Film::radiance(const ImageSizes& size) const {
    const Buffer<float>& image = resolve(size);
    const std::size_t pixels = std::size_t(size.image_width) * size.image_height;
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && std::is_trivially_copyable_v<glm::vec3>);
    return {reinterpret_cast<const glm::vec3*>(on_host(image.bytes()).read(image, 3 * pixels).data()), pixels};
}

std::vector<glm::vec3> Film::image(const ImageSizes& size) const {
    VectorRoom<glm::vec3> pixels(std::size_t(size.image_width) * size.image_height);
    image(size, pixels.span());
    return pixels.take();
}

void Film::image(const ImageSizes& size, std::span<glm::vec3> to) const { read_back(resolve(size), to); }

void Film::look() const {
    if (totals_ || looks_ || has_single_samples_) return;
    measure();
    looks_ = true;
}

void Film::measure() const {
    begin_all();
    kernels_.measure.run({items_, CLARAY_SUM_GROUP}, pixels_, count_, scale_, items_, sums_);
}

/// Sums the results of the kernel enqueued last.
Film::Totals Film::measured() const {
    Totals total;
    for (const NoiseSums& sums : sums_.read()) {
        total.variance += sums.variance, total.luminance += sums.luminance;
        total.pixels += sums.pixels, total.dropped += sums.dropped;
    }
    return total;
}

/// Measured once per state of the film. If squares of radiance leave the range of float32, it is measured
/// again in another unit, with which the next look begins.
const Film::Totals& Film::totals() const {
    if (totals_) return *totals_;
    if (!looks_) measure();
    totals_ = measured();
    looks_ = false;
    const double mean = totals_->luminance / totals_->pixels;
    if (mean > 0 && (mean < 0x1p-10 || mean > 0x1p10)) {
        scale_ = float(std::clamp(scale_ * std::exp2(-std::round(std::log2(mean))), 0x1p-120, 0x1p120));
        measure();
        totals_ = measured();
    }
    return *totals_;
}

/// A frame of one sample per pixel has no noise to measure: looking at all pixels would take longer than their sums.
Film::Noise Film::noise() const {
    if (has_single_samples_) return {0, dropped_.read()[0]};
    const Totals& total = totals();
    Noise noise;
    noise.dropped = total.dropped;
    if (total.luminance > 0)
        noise.relative = std::sqrt(total.variance / total.pixels) / (total.luminance / total.pixels);
    return noise;
}

/// `name`: a kernel of measure_film.cl that writes one variance per item.
template <class... Args>
std::vector<float> Film::variances(const char* name, std::uint32_t items, const Args&... args) const {
    const Totals& total = totals();
    const double mean = total.luminance / total.pixels;
    if (!(mean > 0)) return std::vector<float>(items);
    const Buffer<float> found(device_, items);
    load_kernel(device_, "render/measure_film.cl", name)
        .run({items, 64}, pixels_, args..., float(scale_ / mean), found);
    return read_back(found);
}

std::vector<float> Film::noise_map() const { return variances("map_noise", count_, count_); }

std::vector<float> Film::gain_per_sample(std::uint32_t width) const {
    const auto along = [](std::uint32_t side) { return (side + CLARAY_TILE_SIDE - 1) / CLARAY_TILE_SIDE; };
    const std::uint32_t height = count_ / width;
    return variances("map_gain", 2 * along(width) * along(height), width, height);
}

}  // namespace claray
