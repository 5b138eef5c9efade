// Devices: list them, open one, or adopt one that the host program already uses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "claray/error.hpp"
#include "claray/opencl.hpp"
#include "claray/profiler.hpp"

#pragma GCC visibility push(default)
namespace claray {

enum class DeviceType { cpu, gpu, other };

/// Properties of one device, as reported by OpenCL. Sizes are in bytes.
struct DeviceInfo {
    std::size_t index = 0;  ///< position in `list_devices()`, counted over all platforms
    std::string platform;
    std::string name;
    std::string vendor;
    std::string driver;   ///< driver version
    std::string version;  ///< OpenCL version string
    DeviceType type = DeviceType::other;
    unsigned compute_units = 0;
    std::uint64_t memory = 0;          ///< global memory
    std::uint64_t max_allocation = 0;  ///< largest single buffer
    std::uint64_t local_memory = 0;
    std::size_t max_work_group = 0;
    bool fp64 = false;          ///< double precision in kernels
    bool exact_divide = false;  ///< supports -cl-fp32-correctly-rounded-divide-sqrt
    std::vector<std::string> extensions;

    [[nodiscard]] bool has(const std::string& extension) const;
};

/// "cpu", "gpu" or "other".
[[nodiscard]] const char* to_string(DeviceType type) noexcept;

/// Returns all devices of all platforms, in the order of the platforms. Throws ErrorKind::device if there is no OpenCL
/// platform.
[[nodiscard]] std::vector<DeviceInfo> list_devices();

/// An open device: a context, an in-order queue, and the kernels compiled for it. A handle: copies share everything.
class Device {
public:
    /// Opens a device by "cpu", "gpu", an index of `list_devices()` or a part of its name (case-insensitive). If
    /// `selector` is empty, $CLARAY_DEVICE is used. If that is unset, too, the first GPU is opened, or the first device
    /// if there is no GPU. Throws ErrorKind::usage, listing the devices, if no device or more than one matches.
    [[nodiscard]] static Device open(const std::string& selector = {});

    /// Opens several devices: selectors of `open`, separated by commas, or "all": every GPU and accelerator, and the
    /// CPU once, even if several platforms list it. A CPU beside GPUs leaves some of its compute units to the threads
    /// that keep the GPUs busy. Throws as `open` does, and ErrorKind::usage for a device that is named twice.
    [[nodiscard]] static std::vector<Device> open_several(const std::string& selectors = {});

    /// Uses a context and an in-order queue of the host program. Both are retained. Times are measured only if the
    /// queue was created with CL_QUEUE_PROFILING_ENABLE.
    [[nodiscard]] static Device adopt(cl_context context, cl_command_queue queue);

    /// Returns a part of the device with so many compute units, with a context of its own; the device itself if its
    /// driver cannot divide it.
    [[nodiscard]] Device with_units(unsigned units) const;

    /// Returns the same device and context with a new in-order queue and profiler of its own. Buffers belong to the
    /// context; a Query can run on any of its queues. Commands of two queues run in any order, unless events order
    /// them.
    [[nodiscard]] Device with_new_queue() const;

    [[nodiscard]] const DeviceInfo& info() const noexcept;
    [[nodiscard]] const cl::Context& context() const noexcept;
    [[nodiscard]] const cl::CommandQueue& queue() const noexcept;
    [[nodiscard]] Profiler& profiler() const noexcept;

    /// Returns a value of the tuning table (kernels/tuning.txt) for this device: from the last row whose pattern
    /// matches the device.
    [[nodiscard]] unsigned tuning(const std::string& kernel, const std::string& parameter) const;
    /// Overrides a tuning value for this device. It takes effect for programs compiled later.
    void set_tuning(const std::string& kernel, const std::string& parameter, unsigned value) const;

    /// Compiles ahead, into the cache on disk, what structures and queries need: trees of the builders `automatic` and
    /// `high`, instances, refits, rays and points. Blocks: up to a minute on a GPU where claray never ran, and less
    /// than a second later. See claray/program/compiling.hpp for its progress, and compile_kernels for the kernels of
    /// renders. Throws ErrorKind::device with the compiler's log.
    void prepare() const;

    /// Commands enqueued from now on wait for these events, which may be of any queue of the context. Asynchronous.
    void wait_for(std::span<const cl::Event> events) const;
    /// Returns an event that is complete when all commands enqueued so far are. Asynchronous: the commands are
    /// submitted.
    [[nodiscard]] cl::Event event() const;
    /// Blocks until all enqueued commands are finished, and passes the measured times to the profiler.
    void finish() const;

    struct State;  ///< not for users

private:
    friend struct Internals;
    explicit Device(std::shared_ptr<State> state) : state_(std::move(state)) {}
    std::shared_ptr<State> state_;
};

/// Returns the rows of the user's tuning tables that were ignored when the device was opened, because of an unknown
/// parameter or an invalid value. One line per row: file, line and remedy.
[[nodiscard]] std::vector<std::string> tuning_warnings(const Device& device);

}  // namespace claray
#pragma GCC visibility pop
