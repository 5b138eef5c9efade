#include "host/cli/output/progress.hpp"

#include <unistd.h>

#include <algorithm>
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

std::string time_left(const RenderProgress& progress, double fraction) {
    if (fraction < 1e-4 || fraction >= 1) return {};
    const double seconds = progress.seconds * (1 - fraction) / fraction;
    return ", " + (seconds < 120 ? printed("%.1f s", seconds) : duration_text(seconds)) + " left";
}

}  // namespace

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
    const std::string facts = std::to_string(progress.spp) +
                              (by_samples ? "/" + std::to_string(config_.spp) : std::string()) + " spp" +
                              (progress.waits_for_kernels ? ", waiting for the scene's kernels"
                                                          : time_left(progress, fraction) + noise_text(progress));
    if (progress.waits_for_kernels && !waits_) next_line_ = 0;  // at once
    waits_ = progress.waits_for_kernels;
    if (style_ == ProgressStyle::bar) {
        const int filled = int(fraction * bar_width);
        const std::string bar =
            std::string(std::size_t(filled), '=') + std::string(std::size_t(bar_width - filled), ' ');
        std::fprintf(output_, "\r[%s] %3.0f %%  %s\x1b[K", bar.c_str(), 100 * fraction, facts.c_str());
        line_open_ = true;
    } else if (progress.seconds >= next_line_) {
        std::fprintf(output_, "%3.0f %%  %s\n", 100 * fraction, facts.c_str());
        next_line_ = progress.seconds + seconds_between_lines;
    }
    std::fflush(output_);
}

void ProgressDisplay::finish(const RenderProgress& progress) {
    next_line_ = 0;
    show(progress);
    leave_line();
}

void ProgressDisplay::leave_line() {
    if (line_open_) std::fprintf(output_, "\n");
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
