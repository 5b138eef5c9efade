#include "host/cli/open_device.hpp"

#include <cstdio>

#include "claray/device.hpp"

namespace claray::cli {

Device open_device(const std::string& selector) {
    Device device = Device::open(selector);
    for (const std::string& warning : tuning_warnings(device))
        std::fprintf(stderr, "claray: warning: %s\n", warning.c_str());
    return device;
}

}  // namespace claray::cli
