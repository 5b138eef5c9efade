#include "host/compute/device_error.hpp"

#include "host/compute/programs/kernel_sources.hpp"

namespace claray {

std::string failure_report(const Device& device, const std::string& options) {
    const DeviceInfo& info = device.info();
    std::string report = "device: " + info.name + "\nplatform: " + info.platform + "\ndriver: " + info.driver +
                         "\nversion: " + info.version + "\nkernel sources: " + hash_of_kernel_sources() + '\n';
    if (!options.empty()) report += "compiled from and with: " + options + '\n';
    return report;
}

void throw_device_error(const Device& device, const std::string& doing, const cl::Error& error,
                        const std::string& options) {
    throw Error(
        ErrorKind::device,
        "cannot " + doing + " on " + device.info().name + ": " + error.what() + " gave " + std::to_string(error.err()),
        {}, failure_report(device, options));
}

}  // namespace claray
