#include "host/compute/programs/compiler_processes.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "host/base/in_parallel.hpp"
#include "host/base/process.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray {
namespace {

std::string compiler_program;

/// Each process opens a context, which takes about half a gigabyte of a GPU's memory.
unsigned most_processes(const Device& device) {
    constexpr unsigned bytes_per_process_log2 = 30;
    const unsigned fit = unsigned(std::min<std::uint64_t>(device.info().memory >> bytes_per_process_log2, 1024));
    return std::min({device.tuning("compute/programs", "PROCESSES"), fit, std::thread::hardware_concurrency()});
}

/// The processes of all threads.
class Processes {
public:
    void compile(const std::string& key, unsigned most, const std::vector<std::string>& command) {
        std::unique_lock lock(mutex_);
        if (keys_.contains(key)) {
            changed_.wait(lock, [&] { return !keys_.contains(key); });
            return;
        }
        keys_.insert(key);
        changed_.wait(lock, [&] { return running_ < most; });
        ++running_;
        lock.unlock();
        if (const pid_t id = start_silently(command); id != 0) wait_for_process(id);
        lock.lock();
        --running_;
        keys_.erase(key);
        changed_.notify_all();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::set<std::string> keys_;
    unsigned running_ = 0;
};

Processes processes;

}  // namespace

void set_compiler_program(const std::string& path) { compiler_program = path; }

bool has_compiler_processes(const Device& device) {
    return !compiler_program.empty() && device.state().store_programs && kernel_sources_replaced() == 0 &&
           most_processes(device) > 1;
}

void compile_in_processes(const Device& device, const std::vector<ProgramRequest>& programs) {
    const std::string number = std::to_string(device.info().index);
    in_parallel(programs.size(), [&](std::size_t i) {
        const auto& [file, options] = programs[i];
        processes.compile(
            number + ' ' + file + ' ' + options, most_processes(device),
            {compiler_program, "compile", "--quiet", "--device", number, "--program", file, "--options", options});
    });
}

}  // namespace claray
