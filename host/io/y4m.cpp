#include "host/io/y4m.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "claray/error.hpp"

namespace claray {
namespace {

/// "24:1", "30000:1001"
std::string fraction_of(double rate) {
    for (const std::int64_t below : {std::int64_t(1), std::int64_t(1001)}) {
        const double above = rate * double(below);
        const double whole = below == 1 ? std::round(above) : 1000 * std::round(above / 1000);
        if (whole >= 1 && std::abs(above - whole) < 1e-4 * double(below))
            return std::to_string(std::int64_t(whole)) + ":" + std::to_string(below);
    }
    const std::int64_t above = std::max<std::int64_t>(1, std::llround(1000 * rate)),
                       divisor = std::gcd(above, std::int64_t(1000));
    return std::to_string(above / divisor) + ":" + std::to_string(1000 / divisor);
}

std::uint8_t byte_of(float value) { return std::uint8_t(glm::clamp(std::lround(value), 0l, 255l)); }

}  // namespace

Y4mVideo::Y4mVideo(const std::filesystem::path& path, unsigned width, unsigned height, double rate)
    : width_(width),
      height_(height),
      header_("YUV4MPEG2 W" + std::to_string(width) + " H" + std::to_string(height) + " F" + fraction_of(rate) +
              " Ip A1:1 C444\n"),
      file_(path) {}

void Y4mVideo::add(const std::vector<glm::vec3>& pixels, float exposure, ToneMap tone_map) {
    const std::size_t count = std::size_t(width_) * height_;
    if (pixels.size() != count)
        throw Error(ErrorKind::usage,
                    "a frame of " + std::to_string(pixels.size()) + " pixels in a video of " + std::to_string(count));
    const float gain = std::exp2(exposure);
    std::string frame = std::exchange(header_, {}) + "FRAME\n";
    const std::size_t begin = frame.size();
    frame.resize(begin + 3 * count);
    for (std::size_t i = 0; i < count; ++i) {
        glm::vec3 c;
        for (int k = 0; k < 3; ++k) c[k] = float(srgb_from_linear(tone_mapped(gain * pixels[i][k], tone_map))) / 255.f;
        const float luma = 0.299f * c.r + 0.587f * c.g + 0.114f * c.b;  // ITU-R BT.601
        frame[begin + i] = char(byte_of(16 + 219 * luma));
        frame[begin + count + i] = char(byte_of(128 + 224 * (c.b - luma) / 1.772f));
        frame[begin + 2 * count + i] = char(byte_of(128 + 224 * (c.r - luma) / 1.402f));
    }
    file_.write(frame.data(), frame.size());
}

void Y4mVideo::commit() {
    file_.write(header_.data(), header_.size());
    file_.commit();
}

}  // namespace claray
