// claray.h: errors and devices.
#include "host/capi/capi.hpp"

namespace claray::capi {
namespace {
thread_local std::string last_error;
}

claray_status fail(claray_status status, const std::string& text) noexcept {
    try {
        last_error = text.substr(0, text.find('\n'));  // without the report
    } catch (...) {
        last_error.clear();
    }
    return status;
}

}  // namespace claray::capi

using namespace claray;
using namespace claray::capi;

const char* claray_last_error(void) { return last_error.c_str(); }
const char* claray_version(void) { return CLARAY_VERSION; }

claray_status claray_device_open(const char* selector, claray_device** device) {
    return guarded(
        [&] { hand_out(device, "device", [&] { return new claray_device{Device::open(selector ? selector : "")}; }); });
}

claray_status claray_device_adopt_create(void* context, void* queue, claray_device** device) {
    return guarded([&] {
        if (context == nullptr || queue == nullptr) throw Error(ErrorKind::usage, "context or queue is NULL");
        hand_out(device, "device", [&] {
            return new claray_device{
                Device::adopt(static_cast<cl_context>(context), static_cast<cl_command_queue>(queue))};
        });
    });
}

claray_status claray_device_new_queue_create(claray_device* device, claray_device** with_queue) {
    return guarded([&] {
        hand_out(with_queue, "with_queue",
                 [&] { return new claray_device{required(device, "device").device.with_new_queue()}; });
    });
}

const char* claray_device_name(const claray_device* device) { return device ? device->device.info().name.c_str() : ""; }
void* claray_device_context(const claray_device* device) { return device ? device->device.context()() : nullptr; }
void* claray_device_queue(const claray_device* device) { return device ? device->device.queue()() : nullptr; }

claray_status claray_device_finish(claray_device* device) {
    return guarded([&] { required(device, "device").device.finish(); });
}

void claray_device_release(claray_device* device) { delete device; }
