// Numbers that every device must find within rounding: they depend on functions whose rounding OpenCL leaves open, so
// that there is no hash of them.
#pragma once

#include <span>
#include <string>

#include "host/verify/run.hpp"

namespace claray::verify {

/// Four letters a number, whose relative error is at most 3e-6: infinities are above 1e9, NaN is 0.
[[nodiscard]] std::string packed(std::span<const float> values);

/// Sums of square blocks of an image, each channel by itself, so that few numbers tell of every pixel.
[[nodiscard]] std::vector<float> sums_of_blocks(std::span<const float> pixels, unsigned width, unsigned channels,
                                                unsigned side);

/// Collects comparisons with the committed values.
class Committed {
public:
    explicit Committed(Run& run) : run_(run) {}
    /// Names with other values are told with what was found, packed, which is what to commit once it is known to be
    /// right.
    void compare(const std::string& name, std::span<const float> values);
    /// The same for sums of blocks of 8 x 8 pixels.
    void compare_image(const std::string& name, std::span<const glm::vec3> image, unsigned width);
    /// Records the checks. A path whose last bit decides where it goes may differ between devices, and with it the
    /// values of a block: so many may in one image, and one value in 1000 of all.
    void check(const std::string& what, std::uint64_t of_one = 3) const;

private:
    Run& run_;
    std::uint64_t tried_ = 0, wrong_ = 0, most_wrong_ = 0;
};

}  // namespace claray::verify
