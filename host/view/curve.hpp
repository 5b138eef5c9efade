// How the noise of an image fell with time.
#pragma once

#include <vector>

namespace claray::view {

struct CurvePoint {
    double seconds = 0;  ///< of sampling
    unsigned spp = 0;
    double noise = 0;  ///< as RenderProgress::noise
};

/// Points at about equal distances on logarithmic axes; the last one is the newest.
class Curve {
public:
    /// `seconds`: of sampling since the last call. A noise of 0 is unknown, and one of fewer than four samples too
    /// often small: both halves of a few samples may be dark.
    void add(double seconds, unsigned spp, double noise) {
        seconds_ += seconds;
        if (!(noise > 0) || spp < least_spp_) return;
        if (points_.size() > 1 && spp < ratio_ * points_[points_.size() - 2].spp) points_.pop_back();
        points_.push_back({seconds_, spp, noise});
    }
    [[nodiscard]] const std::vector<CurvePoint>& points() const { return points_; }
    [[nodiscard]] double seconds() const { return seconds_; }

private:
    static constexpr unsigned least_spp_ = 4;
    static constexpr double ratio_ = 1.15;  // of the samples of two points
    std::vector<CurvePoint> points_;
    double seconds_ = 0;
};

}  // namespace claray::view
