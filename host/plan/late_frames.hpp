// Which frames of a fixed rate were late, and when the next must do less.
#pragma once

namespace claray {

class LateFrames {
public:
    /// `budget`: seconds for a frame.
    explicit LateFrames(double budget) : budget_(budget) {}

    /// Called after each frame. Returns true if this is the second late frame of a few: the next must be lighter.
    [[nodiscard]] bool lighten_after(double seconds) {
        ++frame_;
        if (seconds <= tight * budget_) return false;
        const bool again = last_late_ > 0 && frame_ - last_late_ < watched;
        last_late_ = frame_;
        return again;
    }

private:
    static constexpr double tight = 0.95;    // of the budget: longer frames count as late, before the rate is missed
    static constexpr unsigned watched = 50;  // frames within which two are late

    double budget_;
    unsigned frame_ = 0, last_late_ = 0;
};

}  // namespace claray
