#include "host/compute/read_back.hpp"

#include <algorithm>
#include <cstring>

#include "host/base/in_parallel.hpp"
#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"

namespace claray::detail {
namespace {

constexpr std::size_t most_parts = 12, least_bytes = 1u << 20;  // a thread starts in the time of some 100 kB
constexpr std::size_t most_locked = 64u << 20;                  // bytes of page-locked memory that a device keeps

std::size_t parts_of(std::size_t bytes) { return std::clamp<std::size_t>(bytes / least_bytes, 1, most_parts); }

/// Copies parts of neighbouring bytes by several threads, each once `wait(part)` says that it is there.
template <class Wait>
void copy_parts(const std::uint8_t* from, std::uint8_t* to, std::size_t bytes, std::size_t parts, const Wait& wait) {
    in_parallel(parts, [&](std::size_t part) {
        if (!wait(part)) return;
        const std::size_t begin = HostMemory::begin_of_part(bytes, parts, part);
        std::memcpy(to + begin, from + begin, HostMemory::begin_of_part(bytes, parts, part + 1) - begin);
    });
}

/// Of at most as many bytes as the memory has.
void read_once(const Device& device, const HostMemory& locked, const cl::Buffer& from, std::size_t offset,
               std::uint8_t* to, std::size_t bytes) {
    const std::size_t parts = parts_of(bytes);
    const std::vector<cl::Event> read = locked.read_in_parts(device, from, offset, bytes, parts);
    copy_parts(locked.data(), to, bytes, parts,
               [&](std::size_t part) { return clWaitForEvents(1, &read[part]()) == CL_SUCCESS; });
    for (const cl::Event& event : read)
        if (const int status = event.getInfo<CL_EVENT_COMMAND_EXECUTION_STATUS>(); status != CL_COMPLETE)
            throw cl::Error(status, "clEnqueueReadBuffer");
}

/// Returns false if there is not so much.
bool has_locked(const Device& device, std::size_t bytes) {
    Device::State& state = state_of(device);
    if (state.locked_bytes >= bytes) return true;
    state.locked_bytes = 0, state.locked.reset();
    try {
        state.locked = std::make_shared<HostMemory>(device, bytes), state.locked_bytes = bytes;
    } catch (const Error&) {  // page-locked memory is scarce
        return false;
    }
    return true;
}

}  // namespace

void read_by_locked_memory(const Device& device, const cl::Buffer& from, void* to, std::size_t bytes) try {
    Device::State& state = state_of(device);
    const std::lock_guard lock(state.locked_mutex);
    if (!has_locked(device, std::min(bytes, most_locked))) return read(device, from, 0, to, bytes);
    for (std::size_t at = 0; at < bytes; at += state.locked_bytes)
        read_once(device, *state.locked, from, at, static_cast<std::uint8_t*>(to) + at,
                  std::min(state.locked_bytes, bytes - at));
} catch (const cl::Error& error) {
    throw_device_error(device, "read a buffer", error);
}

void read_back(const Device& device, const cl::Buffer& from, void* to, std::size_t bytes) {
    if (bytes < least_bytes) return read(device, from, 0, to, bytes);
    if (device.info().type != DeviceType::cpu) return read_by_locked_memory(device, from, to, bytes);
    view(device, from, bytes, [&](const void* mapped) {
        copy_parts(static_cast<const std::uint8_t*>(mapped), static_cast<std::uint8_t*>(to), bytes, parts_of(bytes),
                   [](std::size_t) { return true; });
    });
}

}  // namespace claray::detail
