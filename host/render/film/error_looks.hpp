// The knowledge of a render about its error, from all estimates so far.
#pragma once

#include <cstdint>

namespace claray {

/// Decides where a render stops; therefore checkpoints store it.
struct ErrorLooks {
    double square = 0;   // squared error of the image by all looks so far
    double degrees = 0;  // degrees of freedom of that
    double last = 0;     // squared error by the last look only
    std::uint32_t spp = 0, count = 0;

    /// Adds a look after more samples per pixel; a repeated look changes nothing.
    void add(double estimated_square, double its_degrees, std::uint32_t samples);
    /// A bound that the error exceeds in about one image of a hundred.
    [[nodiscard]] double bound() const;
    /// The samples per pixel after which to look again; those of the last look if they suffice.
    [[nodiscard]] std::uint32_t next(double error) const;
};

}  // namespace claray
