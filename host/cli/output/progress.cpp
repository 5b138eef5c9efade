#include "host/cli/output/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>

#include "host/base/format.hpp"

namespace claray::cli {
namespace {

constexpr int bar_width = 30;
constexpr double seconds_between_lines = 2;

volatile std::sig_atomic_t interrupt = 0;  // number of the signal
bool interrupts_are_commands = false;

extern "C" void note_interrupt(int signal_number) { interrupt = signal_number; }

extern "C" void tell_and_end(int signal_number) {
    constexpr char text[] = "claray: interrupted before the first sample: no image was written\n";
    if (::write(STDERR_FILENO, text, sizeof text - 1) < 0) return;
    std::raise(signal_number);  // as if there were no handler, which is gone by now
}

void handle(int signal_number, void (*handler)(int)) {
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = int(SA_RESETHAND | SA_RESTART);
    sigaction(signal_number, &action, nullptr);
}

/// All signals that ask the program to end. SIGHUP stays ignored under `nohup`.
void handle_all(void (*handler)(int)) {
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
        struct sigaction now = {};
        sigaction(signal_number, nullptr, &now);
        if (signal_number == SIGHUP && now.sa_handler == SIG_IGN) continue;
        handle(signal_number, handler);
    }
}

std::string noise_text(const RenderProgress& progress) {
    if (progress.noise <= 0) return {};
    if (progress.error_bound > 0) return printed(", error below %.2f %%", 100 * progress.error_bound);
    return printed(", noise %.2f %%", 100 * progress.noise);
}

std::string time_text(double seconds) {
    return ", " + (seconds < 120 ? printed("%.1f s", seconds) : duration_text(seconds)) + " left";
}

std::string time_left(const RenderProgress& progress, double fraction) {
    if (fraction < 1e-4 || fraction >= 1) return {};
    return time_text(progress.seconds * (1 - fraction) / fraction);
}

}  // namespace

double FrameCount::steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void FrameCount::finish_one() {
    const std::lock_guard lock(mutex_);
    if (++done_ == 1) first_end_ = clock_();
}

double FrameCount::fraction(double part) const {
    const std::lock_guard lock(mutex_);
    return std::min(1.0, (done_ + part) / frames_);
}

double FrameCount::seconds_left(double part) const {
    const std::lock_guard lock(mutex_);
    const bool skips_first = done_ > 1;
    const double counted = done_ + part - skips_first, since = skips_first ? first_end_ : begin_;
    return counted > 0 ? std::max(0.0, frames_ - done_ - part) * (clock_() - since) / counted : 0;
}

std::string FrameCount::text() const {
    const std::lock_guard lock(mutex_);
    return "frame " + std::to_string(std::min(done_ + 1, frames_)) + "/" + std::to_string(frames_);
}

bool FrameCount::line_is_due() {
    const std::lock_guard lock(mutex_);
    const double now = clock_() - begin_;
    if (now < next_line_) return false;
    next_line_ = now + seconds_between_lines;
    return true;
}

double fraction_done(const RenderProgress& progress, const RenderConfig& config) {
    double fraction = config.spp > 0 ? double(progress.spp) / config.spp : 0;
    if (config.seconds > 0) fraction = std::max(fraction, progress.seconds / config.seconds);
    if (config.noise > 0 && progress.noise > 0) {
        const double ratio = config.noise / progress.noise;
        fraction = std::max(fraction, ratio * ratio);
    }
    if (config.error > 0 && progress.error_bound > 0) {
        const double ratio = config.error / progress.error_bound;
        fraction = std::max(fraction, ratio * ratio * progress.spp / std::max(progress.error_spp, 1u));
    }
    return std::clamp(fraction, 0.0, 1.0);
}

ProgressStyle progress_style(bool quiet) {
    if (quiet) return ProgressStyle::none;
    const char* const terminal = std::getenv("TERM");
    const bool erases_lines = terminal != nullptr && *terminal != '\0' && std::strcmp(terminal, "dumb") != 0;
    return erases_lines && ::isatty(STDERR_FILENO) == 1 ? ProgressStyle::bar : ProgressStyle::lines;
}

void ProgressDisplay::show(const RenderProgress& progress) {
    if (style_ == ProgressStyle::none) return;
    const double fraction = fraction_done(progress, config_);
    const bool by_samples = config_.error <= 0 && config_.spp < 1u << 24;
    const std::string facts = (frames_ ? frames_->text() + ", " : std::string()) + std::to_string(progress.spp) +
                              (by_samples ? "/" + std::to_string(config_.spp) : std::string()) + " spp" +
                              (progress.waits_for_kernels ? ", waiting for the scene's kernels"
                                                          : left_of_all(progress, fraction) + noise_text(progress));
    if (progress.waits_for_kernels && !waits_) next_line_ = 0;  // at once
    waits_ = progress.waits_for_kernels;
    if (style_ == ProgressStyle::bar) {
        const int filled = int(fraction_of_all(fraction) * bar_width);
        const std::string bar =
            std::string(std::size_t(filled), '=') + std::string(std::size_t(bar_width - filled), ' ');
        std::fprintf(output_, "\r[%s] %3.0f %%  %s\x1b[K", bar.c_str(), 100 * fraction_of_all(fraction), facts.c_str());
        line_open_ = true;
    } else if (line_is_due(progress)) {
        std::fprintf(output_, "%3.0f %%  %s\n", 100 * fraction_of_all(fraction), facts.c_str());
    }
    std::fflush(output_);
}

void ProgressDisplay::finish(const RenderProgress& progress) {
    next_line_ = 0;
    show(progress);
    leave_line();
}

bool ProgressDisplay::line_is_due(const RenderProgress& progress) {
    if (frames_) return frames_->line_is_due();
    if (progress.seconds < next_line_) return false;
    next_line_ = progress.seconds + seconds_between_lines;
    return true;
}

double ProgressDisplay::fraction_of_all(double fraction) const {
    return frames_ ? frames_->fraction(fraction) : fraction;
}

std::string ProgressDisplay::left_of_all(const RenderProgress& progress, double fraction) const {
    if (!frames_) return time_left(progress, fraction);
    const double seconds = frames_->seconds_left(fraction);
    return seconds > 0 ? time_text(seconds) : std::string();
}

void ProgressDisplay::leave_line() {
    if (line_open_) std::fputs(frames_ ? "\r\x1b[K" : "\n", output_);
    line_open_ = false;
}

void tell_of_signals_until_guarded() { handle_all(tell_and_end); }

InterruptGuard::InterruptGuard(Interrupts are) {
    interrupt = 0;
    interrupts_are_commands = are == Interrupts::commands;
    handle_all(note_interrupt);
}

InterruptGuard::~InterruptGuard() { handle_all(SIG_DFL); }

bool InterruptGuard::interrupted() { return interrupt != 0; }

void end_by_interrupt() {
    if (interrupt == 0 || interrupts_are_commands) return;
    std::signal(interrupt, SIG_DFL);
    std::raise(interrupt);
}

}  // namespace claray::cli
