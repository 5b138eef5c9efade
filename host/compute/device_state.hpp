// What the copies of a Device share. Internal to host/compute.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <string>

#include "claray/device.hpp"

namespace claray {

class MemoryPlan;
struct KernelRequest;

struct Device::State {
    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    /// Waits for the commands of a queue of its own. PoCL compiles a kernel in a thread when it first runs, and crashes
    /// if the process exits meanwhile.
    ~State();

    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
    bool owns_queue = false;
    Profiler profiler;
    bool store_programs = true;                      // in the cache on disk; PoCL compiles them a second time for that
    std::map<std::string, cl::Program> programs;     // by file, options and, for a user's source, its text
    std::map<cl_program, std::string> parameters;    // of their kernels, see Kernel::check_arguments
    std::vector<std::string> slow_programs;          // keys of those that are there for a quick start only
    std::vector<KernelRequest>* requests = nullptr;  // where set, kernels are not loaded but noted down
    MemoryPlan* plan = nullptr;                      // where set, buffers are not made but added up
    std::shared_ptr<std::atomic<std::uint64_t>> in_use = std::make_shared<std::atomic<std::uint64_t>>(0);  // bytes
    unsigned failing_allocation = 0, failing_command = 0;  // for tests: see host/compute/memory.hpp
    std::map<std::string, unsigned> tuning;                // "kernel parameter" -> value, as resolved for this device
    std::vector<std::string> tuning_warnings;              // see claray/tuning.hpp
    std::shared_ptr<cl::Buffer> ray_queue;                 // see host/trace/query_kernel.hpp; made when first used
};

}  // namespace claray
