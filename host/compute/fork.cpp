#include "host/compute/fork.hpp"

#include <pthread.h>

#include <atomic>
#include <mutex>

#include "claray/error.hpp"

namespace claray {
namespace {

std::atomic<bool> forked{false};

}  // namespace

void note_forks() {
    static std::once_flag once;
    std::call_once(once, [] { ::pthread_atfork(nullptr, nullptr, [] { forked = true; }); });
}

bool is_forked() noexcept { return forked.load(std::memory_order_relaxed); }

void refuse_if_forked() {
    if (!is_forked()) return;
    throw Error(
        ErrorKind::usage,
        "this process was made by fork() after OpenCL was used, and the driver's threads do not exist in it",
        "use spawn instead, as multiprocessing.get_context('spawn') of Python does, or fork before the first use");
}

}  // namespace claray
