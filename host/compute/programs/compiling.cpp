#include "host/compute/programs/compiling.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <utility>

namespace claray {
namespace {

std::mutex compiling_mutex;
CompileProgress sums;  // of all threads
TellCompiling listener;

void tell() {
    if (listener) listener(sums);
}

/// A line on a terminal, or several elsewhere.
class Lines {
public:
    explicit Lines(std::FILE* to) : to_(to), is_terminal_(::isatty(::fileno(to)) == 1) {}

    void print(const CompileProgress& progress) {
        const bool ends = progress.done == progress.total;
        if (is_terminal_)
            std::fprintf(to_, ends ? "\r\x1b[K" : "\rclaray: %s\x1b[K", text_of(progress).c_str());
        else if (!ends && is_due())
            std::fprintf(to_, "claray: %s\n", text_of(progress).c_str());
        std::fflush(to_);
    }

private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] bool is_due() {
        constexpr std::chrono::seconds between(5);
        if (Clock::now() < next_) return false;
        next_ = Clock::now() + between;
        return true;
    }

    std::FILE* to_;
    bool is_terminal_;
    Clock::time_point next_;  // the epoch: the first at once
};

}  // namespace

void on_compiling(TellCompiling tell) {
    const std::lock_guard lock(compiling_mutex);
    listener = std::move(tell);
}

std::string text_of(const CompileProgress& progress) {
    return "compiling " + std::to_string(std::min(progress.done + 1, progress.total)) + " of " +
           std::to_string(progress.total) + " kernels, once for this device";
}

TellCompiling compiling_lines(std::FILE* to) {
    return [lines = std::make_shared<Lines>(to)](const CompileProgress& progress) { lines->print(progress); };
}

Compiling::Compiling(unsigned kernels) : left_(kernels) {
    const std::lock_guard lock(compiling_mutex);
    sums.total += kernels;
    if (kernels > 0) tell();
}

Compiling::~Compiling() {
    const std::lock_guard lock(compiling_mutex);
    if (left_ == 0) return;
    sums.done += left_;
    tell();
}

void Compiling::one_done() {
    const std::lock_guard lock(compiling_mutex);
    if (left_ == 0) return;
    --left_, ++sums.done;
    tell();
}

}  // namespace claray
