// The progress of a render, and the signals that stop it.
#pragma once

#include <cstdio>
#include <functional>
#include <mutex>
#include <string>

#include "claray/renderer.hpp"

namespace claray::cli {

/// Fraction of the work done, 0..1: of the samples, the time or the noise limit, whichever ends the render first. Noise
/// falls with the square root of the samples.
[[nodiscard]] double fraction_done(const RenderProgress& progress, const RenderConfig& config);

enum class ProgressStyle {
    none,
    lines,  ///< a line now and then
    bar     ///< one line, drawn again and again
};
/// A bar on a terminal that can erase a line ($TERM), else lines; nothing if quiet.
[[nodiscard]] ProgressStyle progress_style(bool quiet);

/// How many frames of an animation are done. May be used from several threads.
class FrameCount {
public:
    /// `clock`: seconds from any time on.
    explicit FrameCount(unsigned frames, std::function<double()> clock = steady_seconds)
        : frames_(frames), clock_(std::move(clock)), begin_(clock_()) {}

    /// A frame is done, here or on another machine.
    void finish_one();
    /// Of all frames, 0..1, if `part` of the next one is done.
    [[nodiscard]] double fraction(double part) const;
    /// Seconds until all frames are done; 0 if nothing tells. The first frame, which may wait for kernels, counts only
    /// as long as there is no other.
    [[nodiscard]] double seconds_left(double part) const;
    /// "frame 3/48"
    [[nodiscard]] std::string text() const;
    /// True now and then, at first at once: for displays by lines.
    [[nodiscard]] bool line_is_due();

    [[nodiscard]] static double steady_seconds();

private:
    const unsigned frames_;
    const std::function<double()> clock_;
    const double begin_;
    mutable std::mutex mutex_;
    unsigned done_ = 0;
    double first_end_ = 0, next_line_ = 0;
};

/// Shows how much is done, the time left, and the noise, or that the render waits for kernels.
class ProgressDisplay {
public:
    /// `frames`: the picture is a frame of these, and what is done and left is that of all frames; null: it is alone.
    ProgressDisplay(const RenderConfig& config, ProgressStyle style, std::FILE* output = stderr,
                    FrameCount* frames = nullptr)
        : config_(config), style_(style), output_(output), frames_(frames) {}
    ~ProgressDisplay() { leave_line(); }
    ProgressDisplay(const ProgressDisplay&) = delete;
    ProgressDisplay& operator=(const ProgressDisplay&) = delete;

    void show(const RenderProgress& progress);
    /// Shows the last state; of frames, whose bar vanishes for the next one's, only if a line is due.
    void finish(const RenderProgress& progress);

private:
    void leave_line();
    /// How much of all work is done, and the time left.
    [[nodiscard]] double fraction_of_all(double fraction) const;
    [[nodiscard]] std::string left_of_all(const RenderProgress& progress, double fraction) const;
    [[nodiscard]] bool line_is_due(const RenderProgress& progress);

    const RenderConfig config_;
    const ProgressStyle style_;
    std::FILE* const output_;
    FrameCount* const frames_;
    bool line_open_ = false, waits_ = false;
    double next_line_ = 0;  // seconds
};

/// Until there is an image to save, SIGINT, SIGTERM, SIGHUP and SIGQUIT print a message and end the program as usual,
/// even while a driver compiles. SIGHUP stays ignored if it was.
void tell_of_signals_until_guarded();

/// What these signals mean to a program that handles them.
enum class Interrupts {
    failures,  ///< it does not do all that it was asked for
    commands   ///< they are the way to end it
};

/// While it exists, these signals set a flag; a second signal of the same kind ends the program as usual.
class InterruptGuard {
public:
    explicit InterruptGuard(Interrupts are = Interrupts::failures);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
    [[nodiscard]] static bool interrupted();
};

/// After all is written: if a guard caught a signal that is a failure, the program dies of it, as if it had not been
/// caught. Shells end a loop only then (Cracauer 1998, "Proper handling of SIGINT/SIGQUIT").
void end_by_interrupt();

}  // namespace claray::cli
