#include "host/compute/drivers/known_faults.hpp"

namespace claray {

std::string known_fault(const DeviceInfo& device) {
    if (device.platform == "rusticl" && device.name.starts_with("llvmpipe"))
        return "the driver rusticl " + device.driver +
               " on llvmpipe ends loops after 65,535 iterations: sorts, trees and images are wrong; install another "
               "driver, for example by apt-get install pocl-opencl-icd";
    if (device.platform == "Portable Computing Language" && device.driver.starts_with("3.0-rc2"))
        return "the driver PoCL 3.0-rc2 of PyPI's pocl-binary-distribution crashed in the first build of a tree on an "
               "AMD EPYC; install another driver: pip install intel-opencl-rt intel-cmplr-lib-rt";
    return {};
}

}  // namespace claray
