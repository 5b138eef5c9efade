// The state shared by copies of a Device. Internal to host/compute.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "claray/device.hpp"
#include "host/compute/programs/kernel_pool.hpp"
#include "host/compute/state_of.hpp"

namespace claray {

class HostMemory;
class MemoryPlan;

/// Bytes of all buffers together.
struct MemoryUse {
    std::atomic<std::uint64_t> now = 0, most = 0;

    void add(std::uint64_t bytes) {
        const std::uint64_t after = now += bytes;
        for (std::uint64_t before = most; before < after && !most.compare_exchange_weak(before, after);) continue;
    }
};

struct Device::State {
    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    /// Waits for the commands of its own queue. PoCL compiles a kernel in a thread when it first runs, and crashes if
    /// the process exits meanwhile.
    ~State();

    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
    bool owns_queue = false;
    Profiler profiler;
    std::map<std::string, cl::Program> programs;   // by file, options and, for user sources, text
    std::map<cl_program, std::string> parameters;  // of their kernels, see Kernel::check_arguments
    std::shared_ptr<KernelPool> kernels = std::make_shared<KernelPool>();
    std::vector<std::string> slow_programs;  // keys of programs that are only for a quick start
    MemoryPlan* plan = nullptr;              // if set, buffers are added up instead of created
    bool commits = false;                    // see MemoryCommit
    std::shared_ptr<std::atomic<std::uint64_t>> overruns;  // if set, buffers are guarded: see GuardedMemory
    std::shared_ptr<MemoryUse> in_use = std::make_shared<MemoryUse>();
    unsigned failing_allocation = 0, failing_command = 0;  // for tests: see host/compute/memory.hpp
    int failing_with = 0;
    std::set<std::string>* kernels_run = nullptr;  // receives the functions of kernels: see verify::KernelsRun
    std::map<std::string, unsigned> tuning;        // "kernel parameter" -> value, as resolved for this device
    std::vector<std::string> tuning_warnings;      // see claray/tuning.hpp
    std::shared_ptr<cl::Buffer> ray_queue;         // see host/trace/query_kernel.hpp; made when first used
    std::mutex locked_mutex;                       // of the next two
    std::shared_ptr<HostMemory> locked;            // see host/compute/read_back.hpp; made when first used
    std::size_t locked_bytes = 0;
};

}  // namespace claray
