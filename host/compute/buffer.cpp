#include "claray/buffer.hpp"

#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/fork.hpp"
#include "host/compute/memory.hpp"

#include <algorithm>
#include <cstdlib>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace claray::detail {
namespace {

/// On CPUs a large buffer lies in pages of 2 MiB, where the system has them: else rays in any order wait for the tables
/// of 4 KiB pages. Embree asks for them, too.
cl::Buffer make_buffer(const Device& device, std::size_t bytes) {
#if defined(__linux__)
    constexpr std::size_t page = std::size_t(2) << 20;
    void* memory = nullptr;
    if (device.info().type == DeviceType::cpu && bytes >= 2 * page && posix_memalign(&memory, page, bytes) == 0) {
        static_cast<void>(madvise(memory, bytes / page * page, MADV_HUGEPAGE));  // only advice
        try {
            cl::Buffer buffer(device.context(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, memory);
            buffer.setDestructorCallback([](cl_mem, void* of) { std::free(of); }, memory);
            return buffer;
        } catch (const cl::Error&) {
            std::free(memory);
            throw;
        }
    }
#endif
    return {device.context(), CL_MEM_READ_WRITE, bytes};
}

/// The host is asked about large buffers only, since that takes as long as a small one.
std::uint64_t bytes_left_for(const Device& device, std::size_t bytes) {
    constexpr std::size_t large = std::size_t(16) << 20;
    if (bytes >= large) return bytes_available(device);
    return device.info().memory - std::min(device.info().memory, bytes_in_use(device));
}

constexpr std::size_t guard_bytes = 1024;
constexpr cl_uchar guard = 0xff;

/// Other queues may use the buffer at once.
void fill_with_guard(const Device& device, const cl::Buffer& buffer, std::size_t bytes) {
    device.queue().enqueueFillBuffer(buffer, guard, 0, bytes);
    device.queue().finish();
}

bool is_overrun(const cl::CommandQueue& queue, const cl::Buffer& buffer, std::size_t bytes) try {
    std::vector<cl_uchar> behind(guard_bytes);
    queue.enqueueReadBuffer(buffer, CL_TRUE, bytes, guard_bytes, behind.data());
    return std::ranges::any_of(behind, [](cl_uchar byte) { return byte != guard; });
} catch (const cl::Error&) {  // the device is lost
    return false;
}

}  // namespace

std::shared_ptr<cl::Buffer> allocate(const Device& device, std::size_t bytes) {
    refuse_if_forked();
    const DeviceInfo& info = device.info();
    if (MemoryPlan* plan = state_of(device).plan; plan != nullptr) {
        plan->add(bytes);
        return {};
    }
    const auto refuse = [&](const std::string& why) {
        throw OutOfMemory("out of device memory: a buffer of " + size_text(bytes) + " does not fit on " + info.name +
                              ", which " + why,
                          "use a smaller scene or image, or another device");
    };
    if (const std::uint64_t left = bytes_left_for(device, bytes); bytes > left)
        refuse("has " + size_text(left) + " of its " + size_text(info.memory) + " left");
    const auto in_use = state_of(device).in_use;
    const auto overruns = state_of(device).overruns;
    const std::size_t with_guard = bytes + (overruns ? guard_bytes : 0);
    try {
        fail_if_asked(state_of(device).failing_allocation, CL_MEM_OBJECT_ALLOCATION_FAILURE);
        // The driver decides about sizes above CL_DEVICE_MAX_MEM_ALLOC_SIZE.
        auto made = std::make_unique<cl::Buffer>(make_buffer(device, with_guard));
        if (overruns) fill_with_guard(device, *made, with_guard);
        if (state_of(device).commits) device.queue().enqueueFillBuffer(*made, cl_uchar(0), 0, 1);
        in_use->add(bytes);
        return {made.release(), [in_use, bytes, overruns,
                                 queue = overruns ? device.queue() : cl::CommandQueue()](const cl::Buffer* buffer) {
                    if (overruns && is_overrun(queue, *buffer, bytes)) ++*overruns;
                    in_use->now -= bytes;
                    delete buffer;
                }};
    } catch (const cl::Error& error) {
        refuse(bytes > info.max_allocation ? "allocates at most " + size_text(info.max_allocation) + " per buffer"
                                           : "refuses it (OpenCL error " + std::to_string(error.err()) + ")");
    }
    return {};
}

std::shared_ptr<cl::Buffer> part(const cl::Buffer& whole, std::size_t offset, std::size_t bytes) try {
    if (whole() == nullptr) return {};  // during a MemoryPlan
    cl_buffer_region region{offset, bytes};
    return std::make_shared<cl::Buffer>(
        cl::Buffer(whole).createSubBuffer(CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION, &region));
} catch (const cl::Error& error) {
    throw Error(ErrorKind::usage, "a sub-buffer cannot begin at byte " + std::to_string(offset) + " (OpenCL error " +
                                      std::to_string(error.err()) + ")");
}

std::shared_ptr<cl::Buffer> adopt(const Device& device, cl_mem memory, std::size_t bytes) {
    if (memory == nullptr) throw Error(ErrorKind::usage, "cannot adopt a buffer that is null");
    try {
        auto adopted = std::make_shared<cl::Buffer>(memory, true);
        if (adopted->getInfo<CL_MEM_CONTEXT>()() != device.context()())
            throw Error(ErrorKind::usage, "cannot adopt the buffer: it belongs to another context",
                        "create it in the context of the device, or adopt that context");
        if (const auto size = adopted->getInfo<CL_MEM_SIZE>(); size < bytes)
            throw Error(ErrorKind::usage, "cannot adopt the buffer: it has " + std::to_string(size) + " bytes, and " +
                                              std::to_string(bytes) + " are needed");
        return adopted;
    } catch (const cl::Error& error) {
        throw Error(ErrorKind::usage,
                    std::string("cannot adopt the buffer: ") + error.what() + " gave " + std::to_string(error.err()));
    }
}

std::shared_ptr<cl::Buffer> in_place(const Device& device, const void* host, std::size_t bytes) {
    refuse_if_forked();
    constexpr std::uintptr_t alignment = 16;  // kernels read rays as float4
    if (device.info().type != DeviceType::cpu || reinterpret_cast<std::uintptr_t>(host) % alignment != 0) return {};
    try {
        return std::make_shared<cl::Buffer>(device.context(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes,
                                            const_cast<void*>(host));
    } catch (const cl::Error&) {  // CL_INVALID_BUFFER_SIZE: the driver takes no buffer of this size
        return {};
    }
}

void view(const Device& device, const cl::Buffer& buffer, std::size_t bytes,
          const std::function<void(const void*)>& use) try {
    refuse_if_forked();
    void* mapped = nullptr;
    device.profiler().record("map_buffer", [&](cl::Event* event) {
        mapped = device.queue().enqueueMapBuffer(buffer, CL_TRUE, CL_MAP_READ, 0, bytes, nullptr, event);
    });
    try {
        use(mapped);
    } catch (...) {
        device.queue().enqueueUnmapMemObject(buffer, mapped);
        throw;
    }
    device.queue().enqueueUnmapMemObject(buffer, mapped);
    device.queue().finish();  // the host may free the memory now
} catch (const cl::Error& error) {
    throw_device_error(device, "read a buffer", error);
}

void write(const Device& device, const cl::Buffer& buffer, std::size_t offset, const void* data,
           std::size_t bytes) try {
    refuse_if_forked();
    device.profiler().record("write_buffer", [&](cl::Event* event) {
        device.queue().enqueueWriteBuffer(buffer, CL_TRUE, offset, bytes, data, nullptr, event);
    });
} catch (const cl::Error& error) {
    throw_device_error(device, "write a buffer", error);
}

void read(const Device& device, const cl::Buffer& buffer, std::size_t offset, void* data, std::size_t bytes) try {
    refuse_if_forked();
    device.profiler().record("read_buffer", [&](cl::Event* event) {
        device.queue().enqueueReadBuffer(buffer, CL_TRUE, offset, bytes, data, nullptr, event);
    });
} catch (const cl::Error& error) {
    throw_device_error(device, "read a buffer", error);
}

void copy(const Device& device, const cl::Buffer& from, const cl::Buffer& to, std::size_t bytes,
          std::size_t offset) try {
    refuse_if_forked();
    device.profiler().record("copy_buffer", [&](cl::Event* event) {
        device.queue().enqueueCopyBuffer(from, to, 0, offset, bytes, nullptr, event);
    });
} catch (const cl::Error& error) {
    throw_device_error(device, "copy a buffer", error);
}

void fill_bytes(const Device& device, const cl::Buffer& buffer, unsigned pattern, std::size_t bytes) try {
    refuse_if_forked();
    device.profiler().record("fill_buffer", [&](cl::Event* event) {
        device.queue().enqueueFillBuffer(buffer, cl_uint(pattern), 0, bytes, nullptr, event);
    });
} catch (const cl::Error& error) {
    throw_device_error(device, "fill a buffer", error);
}

}  // namespace claray::detail
