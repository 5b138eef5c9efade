// Sums of samples in device memory, and the image they make.
#pragma once

#include <glm/glm.hpp>

#include "claray/program.hpp"
#include "claray/shared/path.h"

namespace claray {

class Film {
public:
    Film(const Device& device, std::uint32_t pixels);

    struct Kernels {
        explicit Kernels(const Device& device);
        Kernel accumulate, resolve, noise;
    };

    /// Adds the radiance (3 floats a path) of a batch; enqueued.
    void accumulate(const Batch& batch, const Buffer<float>& radiance);
    /// Mean radiance of every pixel. Blocks.
    [[nodiscard]] std::vector<glm::vec3> resolve() const;

    /// The sums themselves, and back. Block.
    [[nodiscard]] std::vector<FilmPixel> pixels() const { return pixels_.read(); }
    void set_pixels(const std::vector<FilmPixel>& pixels) { pixels_.write(pixels); }

    struct Noise {
        double relative = 0;  ///< as in RenderProgress
        std::uint64_t dropped = 0;
    };
    /// Blocks.
    [[nodiscard]] Noise noise() const;
    [[nodiscard]] std::uint64_t bytes() const { return pixels_.bytes() + sums_.bytes(); }

private:
    Device device_;
    Buffer<FilmPixel> pixels_;
    Buffer<NoiseSums> sums_;
    mutable Kernels kernels_;
};

}  // namespace claray
