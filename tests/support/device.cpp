#include "tests/support/device.hpp"

#include <cstdlib>

namespace claray::test {
namespace {

Device open_device() {
    const char* selector = std::getenv("CLARAY_DEVICE");
    if (selector != nullptr && *selector != '\0') return Device::open();
    for (const DeviceInfo& info : list_devices())
        if (info.type == DeviceType::cpu) return Device::open(std::to_string(info.index));
    return Device::open();
}

}  // namespace

Device& device() {
    static Device opened = open_device();
    return opened;
}

}  // namespace claray::test
