// How far a render has come, and the signal that stops it.
#pragma once

#include <cstdio>

#include "claray/renderer.hpp"

namespace claray::cli {

/// Share of the work done, 0..1: of the samples, of the time, or of the way down to the noise level (noise falls with
/// the square root of the samples), whichever ends the render first.
[[nodiscard]] double fraction_done(const RenderProgress& progress, const RenderConfig& config);

enum class ProgressStyle {
    none,
    lines,  ///< a line now and then
    bar     ///< one line, drawn again and again
};
/// A bar on a terminal that can erase a line ($TERM), lines elsewhere, nothing for the quiet.
[[nodiscard]] ProgressStyle progress_style(bool quiet);

/// Shows how much is done, the time left, and the noise.
class ProgressDisplay {
public:
    ProgressDisplay(const RenderConfig& config, ProgressStyle style, std::FILE* output = stderr)
        : config_(config), style_(style), output_(output) {}
    ~ProgressDisplay() { leave_line(); }
    ProgressDisplay(const ProgressDisplay&) = delete;
    ProgressDisplay& operator=(const ProgressDisplay&) = delete;

    void show(const RenderProgress& progress);
    /// Shows where the render ended, for certain.
    void finish(const RenderProgress& progress);

private:
    void leave_line();

    const RenderConfig config_;
    const ProgressStyle style_;
    std::FILE* const output_;
    bool line_open_ = false;
    double next_line_ = 0;  // seconds
};

/// Before there is anything to save SIGINT, SIGTERM, SIGHUP and SIGQUIT end the program as usual, even while a driver
/// compiles, but not without a word. SIGHUP stays ignored where it is.
void tell_of_signals_until_guarded();

/// From its construction on these signals only set a flag; a second one of a kind ends the program as usual.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
    [[nodiscard]] static bool interrupted();
};

}  // namespace claray::cli
