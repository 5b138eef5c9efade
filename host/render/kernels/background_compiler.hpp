// Compiles kernels in a process of low priority while a render uses other kernels.
#pragma once

#include <sys/stat.h>

#include <mutex>
#include <string>

#include "host/compute/programs/kernel_set.hpp"

namespace claray {

/// Starts `claray compile` for these programs, then for those that can wait, in a separate process that has low
/// priority from its start and reads both sets from its standard input. It continues after this process ends, so that
/// the next render finds its results, but not for long (CompilerWatch). One runs at a time per cache folder: returns
/// false if another is running; call again later. Does nothing and returns true if the program cannot be started or the
/// cache cannot be written.
[[nodiscard]] bool start_compiler(const std::string& program, const Device& device, const KernelSet& programs,
                                  const KernelSet& later);

/// Whether a compiler runs that this process has started.
[[nodiscard]] bool is_compiling();

/// In such a process: tells when it must end. Renders that asked for a compiler hold `renders.lock` in the cache folder
/// until they end, and touch it when they ask while another compiler runs. Two threads may use it.
class CompilerWatch {
public:
    CompilerWatch();
    ~CompilerWatch();
    CompilerWatch(const CompilerWatch&) = delete;
    CompilerWatch& operator=(const CompilerWatch&) = delete;

    /// From now on the work can wait: it must end as soon as another render asks for a compiler.
    void let_others_compile();
    /// Whether it must end at this time, in seconds from any origin: because of that, or because no render has lived
    /// for `seconds_after_renders`. To be called often, since a render is noticed only if it lives at that time.
    [[nodiscard]] bool must_end(double now);

    static constexpr double seconds_after_renders = 45;

private:
    [[nodiscard]] bool is_asked() const;

    int file_;
    std::mutex mutex_;  // of what follows
    bool can_wait_ = false;
    double last_render_ = -1;        // when one was alive; negative: not looked yet
    struct timespec last_asked_ {};  // when it began to wait
};

}  // namespace claray
