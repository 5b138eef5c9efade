// The state shared by copies of a Device. Internal to host/compute.
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
    /// Waits for the commands of its own queue. PoCL compiles a kernel in a thread when it first runs, and crashes if
    /// the process exits meanwhile.
    ~State();

    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
    bool owns_queue = false;
    Profiler profiler;
    bool store_programs = true;                      // in the cache on disk; PoCL compiles them again to do so
    std::map<std::string, cl::Program> programs;     // by file, options and, for user sources, text
    std::map<cl_program, std::string> parameters;    // of their kernels, see Kernel::check_arguments
    std::size_t programs_of_all_asked = 0;           // their number when none of those asked for at once was missing
    std::vector<std::string> slow_programs;          // keys of programs that are only for a quick start
    std::vector<KernelRequest>* requests = nullptr;  // if set, kernels are recorded instead of loaded
    MemoryPlan* plan = nullptr;                      // if set, buffers are added up instead of created
    std::shared_ptr<std::atomic<std::uint64_t>> in_use = std::make_shared<std::atomic<std::uint64_t>>(0);  // bytes
    unsigned failing_allocation = 0, failing_command = 0;  // for tests: see host/compute/memory.hpp
    std::map<std::string, unsigned> tuning;                // "kernel parameter" -> value, as resolved for this device
    std::vector<std::string> tuning_warnings;              // see claray/tuning.hpp
    std::shared_ptr<cl::Buffer> ray_queue;                 // see host/trace/query_kernel.hpp; made when first used
};

}  // namespace claray
