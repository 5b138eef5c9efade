// What a render has learned about its error from the estimates so far.
#pragma once

#include <cstdint>

namespace claray {

/// Decides where a render stops; therefore checkpoints store it.
struct ErrorLooks {
    double square = 0;   // of the image's error, as the looks so far tell it
    double degrees = 0;  // of freedom that this has
    double last = 0;     // the square as the last look alone tells it
    std::uint32_t spp = 0, count = 0;

    /// After more samples a pixel; a look that was taken already changes nothing.
    void add(double estimated_square, double its_degrees, std::uint32_t samples);
    /// What the error exceeds in hardly one image of a hundred.
    [[nodiscard]] double bound() const;
    /// After how many samples a pixel a render to an error looks again; those of the last look where they suffice.
    [[nodiscard]] std::uint32_t next(double error) const;
};

}  // namespace claray
