// claray devices: the OpenCL devices of this machine.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "claray/device.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/output/messages.hpp"
#include "host/cli/output/table.hpp"
#include "host/compute/drivers/icd.hpp"
#include "host/compute/drivers/known_faults.hpp"

namespace claray::cli {
namespace {

/// Extensions that claray can use, and their short names in the table.
constexpr std::pair<const char*, const char*> extensions_that_matter[] = {
    {"cl_khr_fp64", "fp64"},           {"cl_khr_fp16", "fp16"},
    {"cl_khr_subgroups", "subgroups"}, {"cl_khr_int64_base_atomics", "int64 atomics"},
    {"cl_khr_il_program", "SPIR-V"},   {"cl_khr_gl_sharing", "GL sharing"},
};

std::string short_extensions(const DeviceInfo& info) {
    std::string text;
    for (const auto& [extension, name] : extensions_that_matter)
        if (info.has(extension)) text += (text.empty() ? "" : ", ") + std::string(name);
    return text;
}

std::string gigabytes(std::uint64_t bytes) { return fixed(double(bytes) * 1e-9, 1) + " GB"; }

void print_as_table(const std::vector<DeviceInfo>& infos) {
    std::vector<Row> rows = {{"index", "name", "type", "platform", "driver", "memory", "max allocation", "extensions"}};
    for (const DeviceInfo& info : infos)
        rows.push_back({std::to_string(info.index), info.name, to_string(info.type), info.platform, info.driver,
                        gigabytes(info.memory), gigabytes(info.max_allocation), short_extensions(info)});
    print_table(rows);
}

void print_as_json(const std::vector<DeviceInfo>& infos) {
    nlohmann::ordered_json devices = nlohmann::ordered_json::array();
    for (const DeviceInfo& info : infos)
        devices.push_back({{"index", info.index},
                           {"name", info.name},
                           {"type", to_string(info.type)},
                           {"vendor", info.vendor},
                           {"platform", info.platform},
                           {"driver", info.driver},
                           {"version", info.version},
                           {"compute_units", info.compute_units},
                           {"memory_bytes", info.memory},
                           {"max_allocation_bytes", info.max_allocation},
                           {"local_memory_bytes", info.local_memory},
                           {"max_work_group", info.max_work_group},
                           {"exact_divide", info.exact_divide},
                           {"extensions", info.extensions}});
    print_json(devices);
}

void print_lines(const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings) print_warning(warning);
}

void warn_of(const Device& device) {
    if (const std::string fault = known_fault(device.info()); !fault.empty()) print_warning(fault);
    print_lines(tuning_warnings(device));
}

}  // namespace

Device open_device(const std::string& selector) {
    Device device = Device::open(selector);
    print_lines(crashing_drivers());
    warn_of(device);
    return device;
}

std::vector<Device> open_devices(const std::string& selectors) {
    std::vector<Device> devices = Device::open_several(selectors);
    print_lines(crashing_drivers());
    for (const Device& device : devices) warn_of(device);
    return devices;
}

void add_devices_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("devices", "List the OpenCL devices for --device");
    auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "Print as JSON, with all extensions");
    command->callback([&action, json] {
        action = [json] {
            *json ? print_as_json(list_devices()) : print_as_table(list_devices());
            print_lines(failing_drivers());
        };
    });
}

}  // namespace claray::cli
