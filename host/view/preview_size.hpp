// How large a preview is: an image of fewer pixels, which answers a change in time.
#pragma once

#include <algorithm>
#include <cmath>

namespace claray::view {

/// Works in seconds. The time of a preview is in proportion to its pixels, up to what else the device does.
class PreviewSize {
public:
    /// `answer`: from a change to its picture, at most; 0: no preview is wanted.
    explicit PreviewSize(double answer) : wanted_(share_ * answer) {}

    /// Whether a sample for every pixel of the complete image takes too long.
    [[nodiscard]] bool is_smaller() const { return wanted_ > 0 && complete_ > wanted_; }
    /// Of each side of the image.
    [[nodiscard]] double scale() const { return std::clamp(std::sqrt(wanted_ / complete_), least_, 1.0); }

    void complete_took(double seconds) { complete_ = seconds; }
    /// The complete image gets so many times the pixels.
    void complete_grew(double times) { complete_ *= times; }
    /// The size is kept unless the time was much longer or shorter than wanted, so that pictures do not flicker.
    void preview_took(double seconds) {
        const double complete = seconds / (scale() * scale());
        if (seconds > longest_ * wanted_) complete_ = std::max(complete_, complete);
        if (seconds < shortest_ * wanted_) complete_ = std::min(complete_, std::sqrt(complete_ * complete));
    }

private:
    /// Of the time for an answer. The rest is for the picture, its way to a browser, and the browser.
    static constexpr double share_ = 0.2;
    static constexpr double least_ = 0.25;                    // of each side
    static constexpr double longest_ = 1.2, shortest_ = 0.6;  // of the wanted time
    double wanted_;
    double complete_ = 0;  // one sample for every pixel of the complete image
};

}  // namespace claray::view
