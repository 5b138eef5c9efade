#include "host/compute/drivers/known_faults.hpp"

namespace claray {

std::string known_fault(const DeviceInfo& device) {
    if (device.platform == "rusticl" && device.name.starts_with("llvmpipe"))
        return "the driver rusticl " + device.driver +
               " on llvmpipe ends loops after 65,535 iterations: sorts, trees and images are wrong; install another "
               "driver, for example by apt-get install pocl-opencl-icd";
    return {};
}

}  // namespace claray
