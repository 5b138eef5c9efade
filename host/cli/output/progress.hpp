// The progress of a render, and the signals that stop it.
#pragma once

#include <cstdio>

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

/// Shows how much is done, the time left, and the noise, or that the render waits for kernels.
class ProgressDisplay {
public:
    ProgressDisplay(const RenderConfig& config, ProgressStyle style, std::FILE* output = stderr)
        : config_(config), style_(style), output_(output) {}
    ~ProgressDisplay() { leave_line(); }
    ProgressDisplay(const ProgressDisplay&) = delete;
    ProgressDisplay& operator=(const ProgressDisplay&) = delete;

    void show(const RenderProgress& progress);
    /// Always shows the last state.
    void finish(const RenderProgress& progress);

private:
    void leave_line();

    const RenderConfig config_;
    const ProgressStyle style_;
    std::FILE* const output_;
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
