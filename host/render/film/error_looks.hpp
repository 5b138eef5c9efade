// The knowledge of a render about its error, from all estimates so far.
#pragma once

#include <cstdint>

namespace claray {

/// Decides where a render stops; therefore checkpoints store it.
struct ErrorLooks {
    double square = 0;   // squared error of the image by all looks so far
    double degrees = 0;  // degrees of freedom of that
    double last = 0;     // squared error by the last look only
    double halves = 0;   // that of the halves' difference, at the last look
    double power = 0;    // of the samples, by which it falls
    std::uint32_t spp = 0, count = 0;

    /// Adds a look after more samples per pixel; a repeated look changes nothing. `of_halves`: squared half difference
    /// of the halves.
    void add(double of_halves, double its_degrees, std::uint32_t samples);
    /// A bound that the error exceeds in about one image of a hundred.
    [[nodiscard]] double bound() const;
    /// The samples per pixel after which to look again; those of the last look if they suffice.
    [[nodiscard]] std::uint32_t next(double error) const;

private:
    [[nodiscard]] double excess_of_halves(double of_halves, std::uint32_t samples);
};

}  // namespace claray
