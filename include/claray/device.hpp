// Devices: find them, open one, adopt one that the host program already uses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "claray/error.hpp"
#include "claray/opencl.hpp"
#include "claray/profiler.hpp"

namespace claray {

enum class DeviceType { cpu, gpu, other };

/// What OpenCL says of one device. Sizes in bytes.
struct DeviceInfo {
    std::size_t index = 0;  ///< position in `list_devices()`, over all platforms
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
    bool exact_divide = false;  ///< accepts -cl-fp32-correctly-rounded-divide-sqrt
    std::vector<std::string> extensions;

    [[nodiscard]] bool has(const std::string& extension) const;
};

/// "cpu", "gpu" or "other".
[[nodiscard]] const char* to_string(DeviceType type) noexcept;

/// Every device of every platform, in the platforms' order. Throws ErrorKind::device where there is no platform at all.
[[nodiscard]] std::vector<DeviceInfo> list_devices();

/// An open device: a context, an in-order queue, and the kernels compiled for it. Cheap to copy; copies share all.
class Device {
public:
    /// Opens a device by "cpu", "gpu", an index of `list_devices()` or a part of its name (case ignored). Without a
    /// selector $CLARAY_DEVICE decides, and without that the first GPU, else the first device. Throws ErrorKind::usage
    /// naming what exists when nothing or more than one device matches.
    [[nodiscard]] static Device open(const std::string& selector = {});

    /// Uses a context and an in-order queue of the host program. Both are retained. Times are profiled only where the
    /// queue was made with CL_QUEUE_PROFILING_ENABLE.
    [[nodiscard]] static Device adopt(cl_context context, cl_command_queue queue);

    [[nodiscard]] const DeviceInfo& info() const noexcept;
    [[nodiscard]] const cl::Context& context() const noexcept;
    [[nodiscard]] const cl::CommandQueue& queue() const noexcept;
    [[nodiscard]] Profiler& profiler() const noexcept;

    /// A value of the tuning table (kernels/tuning.txt) for this device: the row of the most particular device pattern.
    [[nodiscard]] unsigned tuning(const std::string& kernel, const std::string& parameter) const;
    /// Overrides a tuning value for this device from now on; programs compiled later see it.
    void set_tuning(const std::string& kernel, const std::string& parameter, unsigned value) const;

    /// Blocks until all that was enqueued is done, and hands the measured times to the profiler.
    void finish() const;

    struct State;
    [[nodiscard]] State& state() const noexcept { return *state_; }

private:
    explicit Device(std::shared_ptr<State> state) : state_(std::move(state)) {}
    std::shared_ptr<State> state_;
};

/// Rows of the user's tuning tables that were ignored when the device was opened, since they name no tuning parameter,
/// or a value that does not work: file, line and remedy, a line each.
[[nodiscard]] std::vector<std::string> tuning_warnings(const Device& device);

}  // namespace claray
