// Sums of samples in device memory, and the image they make.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "claray/program.hpp"
#include "claray/shared/path.h"
#include "host/render/error_looks.hpp"

namespace claray {

class Film {
public:
    /// `films`: 1, or 2, of which the second has the samples of odd index once more: then the error can be told.
    Film(const Device& device, std::uint32_t pixels, std::uint32_t films = 1);

    struct Kernels {
        explicit Kernels(const Device& device);
        Kernel accumulate, resolve, measure;
    };

    /// Goes on with kernels that are loaded anew.
    void reload_kernels();

    /// Adds the radiance (3 floats a path) of a batch; enqueued.
    void accumulate(const Batch& batch, const Buffer<float>& radiance);
    /// Forgets all samples; enqueued.
    void clear();
    /// Mean radiance of every pixel. Blocks.
    [[nodiscard]] std::vector<glm::vec3> resolve() const;

    /// The sums themselves, film after film, and back. Block.
    [[nodiscard]] std::vector<FilmPixel> pixels() const { return pixels_.read(); }
    void set_pixels(const std::vector<FilmPixel>& pixels);

    /// Enqueues what noise() and error() tell from, where it is not known: they wait for it.
    void look() const;

    struct Noise {
        double relative = 0;  ///< as in RenderProgress
        std::uint64_t dropped = 0;
    };
    /// Blocks.
    [[nodiscard]] Noise noise() const;

    struct Error {
        double estimate = 0;  ///< root mean square of all channels over the mean; 0: nothing is known
        double bound = 0;     ///< which the error exceeds in hardly one image of a hundred
    };
    /// Where there are two films: by a look after so many samples a pixel, and by those before; see docs/accuracy.md.
    /// Blocks.
    [[nodiscard]] Error error(ErrorLooks& looks, std::uint32_t spp) const;
    [[nodiscard]] std::uint64_t bytes() const { return pixels_.bytes() + sums_.bytes(); }

private:
    /// FilmSums of all pixels.
    struct Totals {
        double noise_variance = 0, luminance = 0, noise_pixels = 0;
        double variance = 0, squares = 0, value = 0, pixels = 0;
        std::uint64_t dropped = 0;
    };
    void load_second();
    void forget_look();
    void measure() const;
    [[nodiscard]] Totals measured() const;
    [[nodiscard]] const Totals& totals() const;
    [[nodiscard]] std::uint32_t second() const { return films_ < 2 ? 0 : count_; }

    Device device_;
    std::uint32_t count_, films_, group_, items_;
    Buffer<FilmPixel> pixels_;
    Buffer<FilmSums> sums_;
    mutable Kernels kernels_;
    Kernel accumulate_odd_;                 // where there are two films
    mutable std::optional<Totals> totals_;  // of the samples there are, where somebody asked
    mutable bool looks_ = false;            // they are under way
    mutable float scale_ = 1;               // a power of two, by which radiance is multiplied to be measured
};

}  // namespace claray
