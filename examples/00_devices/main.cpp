// Example 0: what can compute here? Lists every OpenCL device of every platform, and opens one.
#include <claray/device.hpp>
#include <cstdio>

int main() try {
    for (const claray::DeviceInfo& info : claray::list_devices())
        std::printf("%zu  %s  (%s, %u compute units, %.1f GB, driver %s)\n", info.index, info.name.c_str(),
                    claray::to_string(info.type), info.compute_units, double(info.memory) * 1e-9, info.driver.c_str());

    // Device::open takes "cpu", "gpu", an index or a part of the name. Without any it looks at $CLARAY_DEVICE, and
    // without that it prefers a GPU.
    const claray::Device device = claray::Device::open();
    std::printf("claray would use %s\n", device.info().name.c_str());
    return 0;
} catch (const claray::Error& error) {  // one line: what, where, and what to do
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.kind());
}
