#include "tests/support/device.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

namespace claray::test {
namespace {

Device open_device() {
    const char* selector = std::getenv("CLARAY_DEVICE");
    if (selector != nullptr && *selector != '\0') return Device::open();
    for (const DeviceInfo& info : list_devices())
        if (info.type == DeviceType::cpu) return Device::open(std::to_string(info.index));
    return Device::open();
}

/// Waits for the last test's commands. PoCL compiles a kernel in a thread when it first runs, and crashes if the
/// process exits meanwhile: by then the compiler's own static objects are gone.
class WaitForDevice : public testing::Environment {
public:
    void TearDown() override {
        if (is_open) device().finish();
    }
    static inline bool is_open = false;
};
[[maybe_unused]] const auto* const wait_for_device = testing::AddGlobalTestEnvironment(new WaitForDevice);

}  // namespace

Device& device() {
    static Device opened = open_device();
    WaitForDevice::is_open = true;
    return opened;
}

}  // namespace claray::test
