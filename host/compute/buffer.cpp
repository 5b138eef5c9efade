#include "claray/buffer.hpp"

#include "host/compute/device_state.hpp"

namespace claray::detail {
namespace {

std::string megabytes(std::uint64_t bytes) { return std::to_string((bytes + 999'999) / 1'000'000) + " MB"; }

[[noreturn]] void fail(const Device& device, const char* doing, const cl::Error& error) {
    throw Error(ErrorKind::device, std::string("cannot ") + doing + " on " + device.info().name + ": " + error.what() +
                                       " gave " + std::to_string(error.err()));
}

}  // namespace

cl::Buffer allocate(const Device& device, std::size_t bytes) {
    const DeviceInfo& info = device.info();
    if (bytes > info.max_allocation)
        throw Error(ErrorKind::device,
                    "out of device memory: " + info.name + " gives at most " + megabytes(info.max_allocation) +
                        " in one buffer, " + megabytes(bytes) + " are needed",
                    "use a smaller scene or image, or another device");
    try {
        return cl::Buffer(device.context(), CL_MEM_READ_WRITE, bytes);
    } catch (const cl::Error& error) {
        throw Error(ErrorKind::device,
                    "out of device memory: " + info.name + " cannot give " + megabytes(bytes) + " of its " +
                        megabytes(info.memory) + " (OpenCL error " + std::to_string(error.err()) + ")",
                    "use a smaller scene or image, or another device");
    }
}

void write(const Device& device, const cl::Buffer& buffer, std::size_t offset, const void* data,
           std::size_t bytes) try {
    cl::Event event;
    device.queue().enqueueWriteBuffer(buffer, CL_TRUE, offset, bytes, data, nullptr, &event);
    device.profiler().add("write_buffer", event);
} catch (const cl::Error& error) {
    fail(device, "write a buffer", error);
}

void read(const Device& device, const cl::Buffer& buffer, std::size_t offset, void* data, std::size_t bytes) try {
    cl::Event event;
    device.queue().enqueueReadBuffer(buffer, CL_TRUE, offset, bytes, data, nullptr, &event);
    device.profiler().add("read_buffer", event);
} catch (const cl::Error& error) {
    fail(device, "read a buffer", error);
}

void copy(const Device& device, const cl::Buffer& from, const cl::Buffer& to, std::size_t bytes) try {
    cl::Event event;
    device.queue().enqueueCopyBuffer(from, to, 0, 0, bytes, nullptr, &event);
    device.profiler().add("copy_buffer", event);
} catch (const cl::Error& error) {
    fail(device, "copy a buffer", error);
}

void fill_bytes(const Device& device, const cl::Buffer& buffer, unsigned pattern, std::size_t bytes) try {
    cl::Event event;
    device.queue().enqueueFillBuffer(buffer, cl_uint(pattern), 0, bytes, nullptr, &event);
    device.profiler().add("fill_buffer", event);
} catch (const cl::Error& error) {
    fail(device, "fill a buffer", error);
}

}  // namespace claray::detail
