// Sums of samples in device memory, and the image they make.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "claray/program.hpp"
#include "claray/shared/path.h"
#include "claray/shared/picture.h"
#include "host/compute/memory.hpp"
#include "host/compute/programs/kernel_set.hpp"

namespace claray {

class Film {
public:
    /// `sample_clamp` is RenderConfig::sample_clamp.
    Film(const Device& device, std::uint32_t pixels, float sample_clamp = 0);

    struct Kernels {
        explicit Kernels(const Device& device) { load(device, requests(), *this); }
        [[nodiscard]] static KernelsOf<Kernels> requests();
        Kernel accumulate, resolve, measure;
    };

    /// Loads the kernels again.
    void reload_kernels() { kernels_ = Kernels(device_); }

    /// Adds the radiance (3 floats per path) of a batch; asynchronous. The pixels of a listed batch begin at word
    /// `listed` of `tables`.
    void accumulate(const Batch& batch, const Buffer<float>& radiance, const Buffer<std::uint32_t>& tables = {},
                    std::uint32_t listed = 0);
    /// Discards all samples. Does not touch the memory: the first batch of a pixel overwrites its sums.
    void clear();
    /// Mean radiance of each pixel, 3 floats each, in memory that the next call overwrites; asynchronous. An image of
    /// another size than the film's is interpolated.
    [[nodiscard]] const Buffer<float>& resolve(const ImageSizes& size) const;
    /// The same on the host, in memory that the next call overwrites. Blocks.
    [[nodiscard]] std::span<const glm::vec3> radiance(const ImageSizes& size) const;
    /// A copy of it.
    [[nodiscard]] std::vector<glm::vec3> image(const ImageSizes& size) const;
    /// Into memory of that size.
    void image(const ImageSizes& size, std::span<glm::vec3> to) const;
    /// In the film's own size.
    [[nodiscard]] std::vector<glm::vec3> image() const { return image({count_, 1, count_, 1}); }

    /// Reads and writes the sums from pixel `first` on. Both block.
    void read_sums(std::span<FilmPixel> to, std::uint32_t first = 0) const;
    void set_sums(std::span<const FilmPixel> sums, std::uint32_t first = 0);
    /// Of all pixels.
    [[nodiscard]] std::vector<FilmPixel> sums() const;
    [[nodiscard]] const Buffer<FilmPixel>& pixels() const {
        begin_all();
        return pixels_;
    }

    /// Enqueues the measurement that noise() reads, unless it is known. It waits for it.
    void look() const;

    struct Noise {
        double relative = 0;  ///< as in RenderProgress
        std::uint64_t dropped = 0;
    };
    /// Blocks.
    [[nodiscard]] Noise noise() const;

    /// The variance of each pixel's mean luminance over the square of the image's mean: the root of the mean of all
    /// pixels that have two samples is Noise::relative. 0 for other pixels. Blocks.
    [[nodiscard]] std::vector<float> noise_map() const;
    /// For adaptive sampling: the variance over the root of the luminance, relative to the image's mean (at least
    /// 0.05), as the mean over half h of tile t in element 2 t + h, of a film with rows of `width` pixels. Tiles have
    /// CLARAY_TILE_SIDE pixels per side; their halves are the two colours of a checkerboard, that of the first pixel
    /// first. Blocks.
    [[nodiscard]] std::vector<float> gain_per_sample(std::uint32_t width) const;

    [[nodiscard]] std::uint64_t bytes() const { return buffer_bytes(pixels_, sums_, dropped_, image_); }

private:
    /// NoiseSums of all pixels.
    struct Totals {
        double variance = 0, luminance = 0, pixels = 0;
        std::uint64_t dropped = 0;
    };
    /// Page-locked memory of at least this size.
    [[nodiscard]] const HostMemory& on_host(std::size_t bytes) const;
    void add(const Batch& batch, const Buffer<float>& radiance, const Buffer<std::uint32_t>& tables,
             std::uint32_t listed, bool begins) const;
    /// Sets the pixels without samples to 0.
    void begin_all() const;
    void forget_look();
    void measure() const;
    template <class... Args>
    [[nodiscard]] std::vector<float> variances(const char* name, std::uint32_t items, const Args&... args) const;
    [[nodiscard]] Totals measured() const;
    [[nodiscard]] const Totals& totals() const;

    Device device_;
    std::uint32_t count_;
    float sample_clamp_;
    std::uint32_t items_;  // that sum up pixels
    Buffer<FilmPixel> pixels_;
    Buffer<NoiseSums> sums_;
    Buffer<std::uint32_t> dropped_;                // samples, of batches that begin their pixels
    bool has_single_samples_ = true;               // no pixel has more than one sample
    mutable Buffer<float> image_;                  // once it was asked for
    mutable std::shared_ptr<HostMemory> on_host_;  // likewise
    mutable std::uint64_t room_on_host_ = 0;       // bytes
    mutable Kernels kernels_;
    mutable std::uint32_t begun_ = 0;       // the sums of pixels from here on are older than clear()
    mutable std::optional<Totals> totals_;  // of the current samples, once requested
    mutable bool looks_ = false;            // a measurement is enqueued
    mutable float scale_ = 1;               // a power of two by which radiance is multiplied for measuring
};

}  // namespace claray
