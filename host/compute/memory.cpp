#include "host/compute/memory.hpp"

#include <algorithm>
#include <utility>

#include "host/base/format.hpp"
#include "host/base/host_memory.hpp"
#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"

namespace claray {

MemoryPlan::MemoryPlan(const Device& device) : device_(device) {
    if (state_of(device).plan != nullptr) throw Error(ErrorKind::usage, "a plan of memory within another one");
    state_of(device).plan = this;
}

MemoryPlan::~MemoryPlan() { state_of(device_).plan = nullptr; }

void MemoryPlan::add(std::uint64_t bytes) {
    bytes_ = bytes > UINT64_MAX - bytes_ ? UINT64_MAX : bytes_ + bytes;
    largest_ = std::max(largest_, bytes);
}

MemoryCommit::MemoryCommit(const Device& device) : device_(device) { state_of(device_).commits = true; }

MemoryCommit::~MemoryCommit() { state_of(device_).commits = false; }

GuardedMemory::GuardedMemory(const Device& device)
    : device_(device),
      overruns_(std::make_shared<std::atomic<std::uint64_t>>(0)),
      before_(std::exchange(state_of(device).overruns, overruns_)) {}

GuardedMemory::~GuardedMemory() { state_of(device_).overruns = before_; }

/// The memory of a buffer that the driver allocates on the host stays mapped: the documented way to page-locked memory
/// (NVIDIA, "OpenCL Best Practices Guide", 3.1.1).
HostMemory::HostMemory(const Device& device, std::size_t bytes) try {
    if (state_of(device).plan != nullptr) return;
    const cl::Buffer buffer(device.context(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
    void* const mapped = device.queue().enqueueMapBuffer(buffer, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes);
    data_ = {static_cast<std::uint8_t*>(mapped), [queue = device.queue(), buffer](std::uint8_t* data) {
                 try {
                     queue.enqueueUnmapMemObject(buffer, data);
                 } catch (const cl::Error&) {  // the device is lost, and the memory with it
                 }
             }};
} catch (const cl::Error& error) {
    throw_device_error(device, "allocate host memory", error);
}

std::vector<cl::Event> HostMemory::read_in_parts(const Device& device, const cl::Buffer& from, std::size_t offset,
                                                 std::size_t bytes, std::size_t parts) const try {
    std::vector<cl::Event> events(parts);
    for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t begin = begin_of_part(bytes, parts, part), end = begin_of_part(bytes, parts, part + 1);
        device.queue().enqueueReadBuffer(from, CL_FALSE, offset + begin, end - begin, data_.get() + begin, nullptr,
                                         &events[part]);
    }
    device.queue().flush();
    return events;
} catch (const cl::Error& error) {
    throw_device_error(device, "read a buffer", error);
}

std::uint64_t bytes_in_use(const Device& device) { return state_of(device).in_use->now; }
std::uint64_t most_bytes_in_use(const Device& device) { return state_of(device).in_use->most; }

std::uint64_t bytes_available(const Device& device) {
    const std::uint64_t all = device.info().memory, used = bytes_in_use(device), left = all > used ? all - used : 0;
    return device.info().type == DeviceType::cpu ? std::min(left, free_host_memory()) : left;
}

bool gives_buffer(const Device& device, std::uint64_t bytes) {
    if (bytes <= device.info().max_allocation) return true;
    if (bytes > bytes_available(device)) return false;
    cl_int status = CL_SUCCESS;
    const cl_mem memory = clCreateBuffer(device.context()(), CL_MEM_READ_WRITE, bytes, nullptr, &status);
    if (memory != nullptr) clReleaseMemObject(memory);
    return status == CL_SUCCESS;
}

void fail_allocation(const Device& device, unsigned nth) { state_of(device).failing_allocation = nth; }
void fail_command(const Device& device, unsigned nth) { fail_command_with(device, nth, CL_OUT_OF_RESOURCES); }
void fail_command_with(const Device& device, unsigned nth, int error) {
    state_of(device).failing_command = nth, state_of(device).failing_with = error;
}

void fail_if_asked(unsigned& countdown, int error) {
    if (countdown != 0 && --countdown == 0) throw cl::Error(error, "an injected failure");
}

std::string size_text(std::uint64_t bytes) {
    const bool large = bytes >= 1'000'000'000;
    return printed(large ? "%.2f GB" : "%.1f MB", double(bytes) * (large ? 1e-9 : 1e-6));
}

}  // namespace claray
