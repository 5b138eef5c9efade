// claray.h: errors, lines of text, and devices.
#include "claray/effects.hpp"
#include "host/capi/members.hpp"

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

struct claray_device_list {
    std::vector<DeviceInfo> devices;
    std::vector<std::string> extensions;
};

namespace {

std::string extensions_of(const DeviceInfo& device) {
    std::string all;
    for (const std::string& name : device.extensions) all += (all.empty() ? "" : " ") + name;
    return all;
}

claray_device* handle_of(Device&& device) {
    std::string extensions = extensions_of(device.info());
    return new claray_device{std::move(device), std::move(extensions)};
}

void give_info(claray_device_info* info, const DeviceInfo& device, const std::string& extensions) {
    auto known = put_into<claray_device_info>(device);
    known.extensions = extensions.c_str();
    give(info, known, "info");
}

template <class Rows>
std::vector<std::string> names_in(const Rows& rows) {
    std::vector<std::string> names;
    for (const auto& row : rows) names.emplace_back(row.name);
    return names;
}

std::vector<std::string> names_of_list(const std::string& list) {
    std::vector<std::string> names;
    if (list == "material kinds") return names_in(material_kinds);
    if (list == "light kinds") return names_in(light_kinds);
    if (list == "projections") return names_in(projections);
    if (list == "primitive kinds") return names_in(primitive_kind_names);
    if (list == "builders") return names_in(builders);
    if (list == "scenes") return {builtin_scene_names().begin(), builtin_scene_names().end()};
    if (list == "layers") {
        names = names_in(aov_rows);
        names.insert(names.end(), {"noise", "error", "voxels"});
        return names;
    }
    const std::string all = to_string(all_approximations());
    if (list == "approximations")
        for (std::size_t begin = 0, end; begin < all.size(); begin = end + 1) {
            end = std::min(all.find(',', begin), all.size());
            names.push_back(all.substr(begin, end - begin));
        }
    else if (list == "effects")
        for (const Effect effect : all_effects()) names.emplace_back(name_of(effect));
    else
        refuse("list is '" + list + "'",
               "use material kinds, light kinds, projections, primitive kinds, builders, scenes, effects, "
               "approximations or layers");
    return names;
}

}  // namespace

const char* claray_last_error(void) { return last_error.c_str(); }
const char* claray_version(void) { return CLARAY_VERSION; }

claray_status claray_names_create(const char* list, claray_lines** names) {
    return guarded(
        [&] { hand_out(names, "names", [&] { return new claray_lines{names_of_list(&required(list, "list"))}; }); });
}

size_t claray_lines_count(const claray_lines* lines) { return lines ? lines->lines.size() : 0; }
const char* claray_lines_at(const claray_lines* lines, size_t i) {
    return i < claray_lines_count(lines) ? lines->lines[i].c_str() : nullptr;
}
void claray_lines_release(claray_lines* lines) { delete lines; }

claray_status claray_device_open(const char* selector, claray_device** device) {
    return guarded([&] { hand_out(device, "device", [&] { return handle_of(Device::open(text_of(selector))); }); });
}

claray_status claray_device_open_several(const char* selectors, claray_device** devices, size_t room, size_t* count) {
    return guarded([&] {
        std::vector<Device> opened = Device::open_several(text_of(selectors));
        if (opened.size() > room)
            refuse("room is " + std::to_string(room) + ", and there are " + std::to_string(opened.size()) + " devices");
        required(count, "count") = opened.size();
        static_cast<void>(required(devices, "devices"));
        for (std::size_t i = 0; i < opened.size(); ++i) devices[i] = handle_of(std::move(opened[i]));
    });
}

claray_status claray_device_with_units_create(claray_device* device, uint32_t units, claray_device** part) {
    return guarded([&] {
        const Device& whole = required(device, "device").device;
        if (units == 0) refuse("units is 0", "use 1 or more");
        hand_out(part, "part", [&] { return handle_of(whole.with_units(units)); });
    });
}

claray_status claray_device_adopt_create(void* context, void* queue, claray_device** device) {
    return guarded([&] {
        if (context == nullptr || queue == nullptr) refuse("context or queue is NULL");
        hand_out(device, "device", [&] {
            return handle_of(Device::adopt(static_cast<cl_context>(context), static_cast<cl_command_queue>(queue)));
        });
    });
}

claray_status claray_device_new_queue_create(claray_device* device, claray_device** with_queue) {
    return guarded([&] {
        hand_out(with_queue, "with_queue",
                 [&] { return handle_of(required(device, "device").device.with_new_queue()); });
    });
}

claray_status claray_device_list_create(claray_device_list** list) {
    return guarded([&] {
        hand_out(list, "list", [&] {
            std::vector<DeviceInfo> devices = list_devices();
            std::vector<std::string> extensions;
            for (const DeviceInfo& device : devices) extensions.push_back(extensions_of(device));
            return new claray_device_list{std::move(devices), std::move(extensions)};
        });
    });
}
size_t claray_device_list_count(const claray_device_list* list) { return list ? list->devices.size() : 0; }
claray_status claray_device_list_get(const claray_device_list* list, size_t i, claray_device_info* info) {
    return guarded([&] {
        const DeviceInfo& device = element(required(list, "list").devices, i, "devices", "i");
        give_info(info, device, list->extensions[i]);
    });
}
void claray_device_list_release(claray_device_list* list) { delete list; }

claray_status claray_device_get(const claray_device* device, claray_device_info* info) {
    return guarded([&] {
        const claray_device& of = required(device, "device");
        give_info(info, of.device.info(), of.extensions);
    });
}

const char* claray_device_name(const claray_device* device) { return device ? device->device.info().name.c_str() : ""; }
void* claray_device_context(const claray_device* device) { return device ? device->device.context()() : nullptr; }
void* claray_device_queue(const claray_device* device) { return device ? device->device.queue()() : nullptr; }

claray_status claray_device_finish(claray_device* device) {
    return guarded([&] { required(device, "device").device.finish(); });
}

claray_status claray_device_wait_for(claray_device* device, const void* const* events, size_t count) {
    return guarded(
        [&] { required(device, "device").device.wait_for(events_of(array(events, count, "events"), "events")); });
}

claray_status claray_device_event(claray_device* device, void** event) {
    return guarded([&] {
        const Device& of = required(device, "device").device;
        hand_over(of.event(), required(event, "event"));
    });
}

claray_status claray_device_tuning(const claray_device* device, const char* kernel, const char* parameter,
                                   uint32_t* value) {
    return guarded([&] {
        const Device& of = required(device, "device").device;
        required(value, "value") = of.tuning(&required(kernel, "kernel"), &required(parameter, "parameter"));
    });
}

claray_status claray_device_set_tuning(claray_device* device, const char* kernel, const char* parameter,
                                       uint32_t value) {
    return guarded([&] {
        const Device& of = required(device, "device").device;
        of.set_tuning(&required(kernel, "kernel"), &required(parameter, "parameter"), value);
    });
}

claray_status claray_device_warnings_create(const claray_device* device, claray_lines** warnings) {
    return guarded([&] {
        const Device& of = required(device, "device").device;
        hand_out(warnings, "warnings", [&] { return new claray_lines{tuning_warnings(of)}; });
    });
}

void claray_device_release(claray_device* device) { delete device; }
