#include "host/compute/drivers/driver_setup.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <vector>

#include "host/base/process/environment.hpp"
#include "host/compute/drivers/icd.hpp"
#include "host/compute/drivers/pocl_folder.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

void give_threads_a_stack() {
#ifdef __GLIBC__
    constexpr std::size_t needed = std::size_t(8) << 20;
    pthread_attr_t attributes;
    std::size_t now = 0;
    if (::pthread_getattr_default_np(&attributes) != 0) return;
    if (::pthread_attr_getstacksize(&attributes, &now) == 0 && now < needed &&
        ::pthread_attr_setstacksize(&attributes, needed) == 0)
        ::pthread_setattr_default_np(&attributes);
    ::pthread_attr_destroy(&attributes);
#endif
}

#ifdef __linux__
/// In the order in which they started, unless their numbers wrapped around.
std::vector<pid_t> threads_of_process() {
    std::vector<pid_t> threads;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator("/proc/self/task", none))
        threads.push_back(pid_t(std::strtol(entry.path().filename().c_str(), nullptr, 10)));
    std::ranges::sort(threads);
    return threads;
}

/// Binds each of the threads to a processor of its own, if there are as many as the process may use.
void bind_to_processors(const std::vector<pid_t>& threads) {
    cpu_set_t allowed;
    if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0 || std::size_t(CPU_COUNT(&allowed)) != threads.size())
        return;
    std::size_t processor = 0;
    for (const pid_t thread : threads) {
        while (!CPU_ISSET(processor, &allowed)) ++processor;
        cpu_set_t own;
        CPU_ZERO(&own);
        CPU_SET(processor++, &own);
        if (::sched_setaffinity(thread, sizeof own, &own) == 0) continue;
        for (const pid_t bound : threads) ::sched_setaffinity(bound, sizeof allowed, &allowed);  // all as they were
        return;
    }
}
#endif

/// PoCL compiles a kernel again for each size of work-group and for grids of at least 2^16 items. No kernel of claray
/// gains by it (bench/notebook/rendering.md, "Rendering on CPUs"), and a first render waits a third longer.
void compile_kernels_once() { ::setenv("POCL_WORK_GROUP_SPECIALIZATION", "0", 0); }

bool pocl_can_write = true;

}  // namespace

void set_up_drivers() {
    static std::once_flag once;
    std::call_once(once, [] {
        pocl_can_write = give_pocl_a_folder();
        give_threads_a_stack();
        compile_kernels_once();
        leave_out_crashing_drivers();
    });
}

void bind_threads_started_by(const std::function<void()>& start) {
#ifdef __linux__
    static std::atomic<bool> started = false;
    if (!started.exchange(true) && environment("POCL_AFFINITY").empty()) {
        const std::vector<pid_t> before = threads_of_process();
        start();
        std::vector<pid_t> threads = threads_of_process();
        std::erase_if(threads, [&](pid_t thread) { return std::ranges::binary_search(before, thread); });
        return bind_to_processors(threads);
    }
#endif
    start();
}

std::string no_device_remedy() {
    const std::vector<std::string> failing = failing_drivers();
    if (!failing.empty()) return failing.front();
    if (!pocl_can_write)
        return "PoCL has no folder: set POCL_CACHE_DIR, HOME or TMPDIR to one that is writable and has 32 MB";
    return "install a driver, for example for CPUs: apt-get install pocl-opencl-icd";
}

}  // namespace claray
