#include "claray/device.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include "host/base/did_you_mean.hpp"
#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/drivers/driver_setup.hpp"
#include "host/compute/drivers/icd.hpp"
#include "host/compute/fork.hpp"
#include "host/compute/tuning.hpp"

namespace claray {
namespace {

std::string trimmed(std::string text) {
    while (!text.empty() && (text.back() == '\0' || std::isspace(static_cast<unsigned char>(text.back()))))
        text.pop_back();
    const auto first = std::find_if_not(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c); });
    return {first, text.end()};
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

DeviceType type_of(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_GPU) return DeviceType::gpu;
    if (type & CL_DEVICE_TYPE_CPU) return DeviceType::cpu;
    return DeviceType::other;
}

/// CLARAY_NO_FP64 simulates a device without double precision.
bool without_fp64() {
    const char* environment = std::getenv("CLARAY_NO_FP64");
    return environment != nullptr && *environment != '\0' && std::string(environment) != "0";
}

DeviceInfo describe(const cl::Device& device, std::size_t index) {
    DeviceInfo info;
    info.index = index;
    info.platform = trimmed(cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()).getInfo<CL_PLATFORM_NAME>());
    info.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
    info.vendor = trimmed(device.getInfo<CL_DEVICE_VENDOR>());
    info.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
    info.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
    info.type = type_of(device.getInfo<CL_DEVICE_TYPE>());
    info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
    info.memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    info.max_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    info.local_memory = device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
    info.max_work_group = device.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
    std::istringstream extensions(device.getInfo<CL_DEVICE_EXTENSIONS>());
    for (std::string extension; extensions >> extension;) info.extensions.push_back(extension);
    if (without_fp64()) std::erase(info.extensions, "cl_khr_fp64");
    info.fp64 = info.has("cl_khr_fp64");
    info.exact_divide = device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
    return info;
}

std::vector<cl::Device> all_devices() {
    refuse_if_forked();
    note_forks();
    set_up_drivers();
    std::vector<cl::Platform> platforms;
    try {
        cl::Platform::get(&platforms);
    } catch (const cl::Error&) {  // CL_PLATFORM_NOT_FOUND_KHR: an ICD loader without any driver
    }
    if (platforms.empty()) throw Error(ErrorKind::device, "no OpenCL platform on this machine", no_device_remedy());
    std::vector<cl::Device> devices;
    for (const cl::Platform& platform : platforms) {
        std::vector<cl::Device> of_platform;
        try {
            const auto start = [&] { platform.getDevices(CL_DEVICE_TYPE_ALL, &of_platform); };
            if (platform.getInfo<CL_PLATFORM_NAME>() == "Portable Computing Language")
                bind_threads_started_by(start);
            else
                start();
        } catch (const cl::Error&) {  // CL_DEVICE_NOT_FOUND: a platform whose hardware is absent
        }
        devices.insert(devices.end(), of_platform.begin(), of_platform.end());
    }
    return devices;
}

std::vector<DeviceInfo> described(const std::vector<cl::Device>& devices) {
    std::vector<DeviceInfo> infos;
    for (const cl::Device& device : devices) infos.push_back(describe(device, infos.size()));
    return infos;
}

std::string listing(const std::vector<DeviceInfo>& infos) {
    std::string text;
    for (const DeviceInfo& info : infos) {
        if (!text.empty()) text += ", ";
        text += std::to_string(info.index) + " = " + info.name + " (" + to_string(info.type) + ")";
    }
    return text.empty() ? "none" : text;
}

bool matches(const DeviceInfo& info, const std::string& selector) {
    const std::string wanted = lower(selector);
    if (wanted == "cpu") return info.type == DeviceType::cpu;
    if (wanted == "gpu") return info.type == DeviceType::gpu;
    if (std::all_of(wanted.begin(), wanted.end(), [](unsigned char c) { return std::isdigit(c); }))
        return std::to_string(info.index) == wanted;
    return lower(info.name).find(wanted) != std::string::npos;
}

/// Words that name a device.
std::vector<std::string> selectors_of(const std::vector<DeviceInfo>& infos) {
    std::vector<std::string> words = {"cpu", "gpu", "all"};
    for (const DeviceInfo& info : infos) {
        std::istringstream name(info.name);
        words.insert(words.end(), std::istream_iterator<std::string>(name), {});
    }
    return words;
}

std::size_t select(const std::vector<DeviceInfo>& infos, const std::string& selector) {
    if (infos.empty())
        throw Error(ErrorKind::device, "no OpenCL device: platforms exist but none has a device", no_device_remedy());
    if (selector.empty()) {
        const auto gpu = std::find_if(infos.begin(), infos.end(), [](auto& i) { return i.type == DeviceType::gpu; });
        return gpu == infos.end() ? 0 : std::size_t(gpu - infos.begin());
    }
    std::vector<std::size_t> found;
    for (const DeviceInfo& info : infos)
        if (matches(info, selector)) found.push_back(info.index);
    const std::vector<std::string> failing = found.empty() ? failing_drivers() : std::vector<std::string>();
    if (found.size() != 1)
        throw Error(ErrorKind::usage,
                    (found.empty() ? "no device matches '" : "several devices match '") + selector + "'" +
                        (found.empty() ? did_you_mean(selector, selectors_of(infos)) : ""),
                    "available: " + listing(infos) + (failing.empty() ? "" : "; " + failing.front()));
    return found[0];
}

void tune(Device::State& state) {
    Tuning tuning = tuning_for(state.info);
    state.tuning = std::move(tuning.values);
    state.tuning_warnings = std::move(tuning.warnings);
}

/// The CPU last, because the first device leads (RenderGroup); without CPUs of a second platform, which would be the
/// same processor again.
std::vector<std::string> select_all(const std::vector<DeviceInfo>& infos) {
    std::string platform;
    std::vector<std::string> all, cpus;
    for (const DeviceInfo& info : infos) {
        if (info.type == DeviceType::cpu && platform.empty()) platform = info.platform;
        if (info.type != DeviceType::cpu)
            all.push_back(std::to_string(info.index));
        else if (info.platform == platform)
            cpus.push_back(std::to_string(info.index));
    }
    all.insert(all.end(), cpus.begin(), cpus.end());
    return all;
}

std::vector<std::string> parts_of(const std::string& list) {
    std::vector<std::string> parts;
    std::istringstream text(list);
    for (std::string part; std::getline(text, part, ',');) parts.push_back(part);
    if (list.ends_with(',')) parts.emplace_back();
    return parts;
}

std::string selector_or_environment(const std::string& selector) {
    if (!selector.empty()) return selector;
    const char* environment = std::getenv("CLARAY_DEVICE");
    return environment == nullptr ? std::string() : environment;
}

/// A thread for each GPU and one for the group. With 14 of 16 cores an H200 and its host's CPU reached 0.97 of the sum
/// of their speeds, with 16 cores 0.94 (docs/scale.md). Processors with few cores leave none.
unsigned units_beside_gpus(unsigned units, unsigned gpus) {
    const unsigned threads = gpus + 1;
    return gpus > 0 && units >= 4 * threads ? units - threads : units;
}

}  // namespace

bool DeviceInfo::has(const std::string& extension) const {
    return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

const char* to_string(DeviceType type) noexcept {
    switch (type) {
        case DeviceType::cpu: return "cpu";
        case DeviceType::gpu: return "gpu";
        default: return "other";
    }
}

std::vector<DeviceInfo> list_devices() try { return described(all_devices()); } catch (const cl::Error& error) {
    throw Error(ErrorKind::device, std::string("cannot list the OpenCL devices: ") + error.what() + " gave " +
                                       std::to_string(error.err()));
}

Device Device::open(const std::string& selector) try {
    const std::vector<cl::Device> devices = all_devices();
    const std::vector<DeviceInfo> infos = described(devices);
    const std::size_t index = select(infos, selector_or_environment(selector));

    auto state = std::make_shared<State>();
    state->info = infos[index];
    state->device = devices[index];
    state->context = cl::Context(state->device);
    state->queue = cl::CommandQueue(state->context, state->device, CL_QUEUE_PROFILING_ENABLE);
    state->owns_queue = true;
    tune(*state);
    return Device(std::move(state));
} catch (const cl::Error& error) {
    throw Error(ErrorKind::device,
                std::string("cannot open the OpenCL device: ") + error.what() + " gave " + std::to_string(error.err()));
}

std::vector<Device> Device::open_several(const std::string& selectors) {
    const std::string wanted = selector_or_environment(selectors);
    std::vector<std::string> parts = lower(wanted) == "all" ? select_all(list_devices()) : parts_of(wanted);
    if (parts.size() < 2) return {open(parts.empty() ? wanted : parts.front())};
    std::vector<Device> devices;
    for (const std::string& part : parts) {
        if (part.empty())
            throw Error(ErrorKind::usage, "'" + wanted + "' is not a list of devices", "write gpu,cpu or all");
        Device device = open(part);
        for (const Device& other : devices)
            if (other.info().index == device.info().index)
                throw Error(ErrorKind::usage, "'" + wanted + "' names the device " + device.info().name + " twice",
                            "name each device once; claray devices lists them");
        devices.push_back(std::move(device));
    }
    const auto is_cpu = [](const Device& device) { return device.info().type == DeviceType::cpu; };
    const auto gpus = unsigned(devices.size() - std::count_if(devices.begin(), devices.end(), is_cpu));
    for (Device& device : devices)
        if (const unsigned units = units_beside_gpus(device.info().compute_units, gpus);
            is_cpu(device) && units < device.info().compute_units)
            device = device.with_units(units);
    return devices;
}

Device Device::with_units(unsigned units) const try {
    refuse_if_forked();
    auto state = std::make_shared<State>();
    cl::Device whole = state_->device;
    const cl_device_partition_property by_counts[] = {
        CL_DEVICE_PARTITION_BY_COUNTS, cl_device_partition_property(units), CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
    std::vector<cl::Device> parts;
    whole.createSubDevices(by_counts, &parts);
    state->device = parts.at(0);
    state->info = describe(state->device, state_->info.index);
    state->context = cl::Context(state->device);
    state->queue = cl::CommandQueue(state->context, state->device, CL_QUEUE_PROFILING_ENABLE);
    state->owns_queue = true;
    tune(*state);
    return Device(std::move(state));
} catch (const cl::Error&) {
    return *this;
}

Device Device::adopt(cl_context context, cl_command_queue queue) try {
    refuse_if_forked();
    auto state = std::make_shared<State>();
    state->context = cl::Context(context, true);
    state->queue = cl::CommandQueue(queue, true);
    if (state->queue.getInfo<CL_QUEUE_CONTEXT>()() != context)
        throw Error(ErrorKind::usage, "cannot adopt the queue: it belongs to another context");
    if (state->queue.getInfo<CL_QUEUE_PROPERTIES>() & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE)
        throw Error(ErrorKind::usage, "cannot adopt the queue: it is an out-of-order queue",
                    "create an in-order queue");
    state->device = state->queue.getInfo<CL_QUEUE_DEVICE>();
    const std::vector<cl::Device> devices = all_devices();
    const auto found = std::find_if(devices.begin(), devices.end(), [&](auto& d) { return d() == state->device(); });
    state->info = describe(state->device, std::size_t(found - devices.begin()));
    state->profiler.enable(state->queue.getInfo<CL_QUEUE_PROPERTIES>() & CL_QUEUE_PROFILING_ENABLE);
    tune(*state);
    return Device(std::move(state));
} catch (const cl::Error& error) {
    throw Error(ErrorKind::device, std::string("cannot adopt the OpenCL context: ") + error.what() + " gave " +
                                       std::to_string(error.err()));
}

Device Device::with_new_queue() const try {
    refuse_if_forked();
    auto state = std::make_shared<State>();
    state->info = state_->info;
    state->device = state_->device;
    state->context = state_->context;
    state->queue = cl::CommandQueue(state->context, state->device, CL_QUEUE_PROFILING_ENABLE);
    state->owns_queue = true;
    state->programs = state_->programs;
    state->parameters = state_->parameters;
    state->in_use = state_->in_use;
    state->tuning = state_->tuning;
    state->tuning_warnings = state_->tuning_warnings;
    return Device(std::move(state));
} catch (const cl::Error& error) {
    throw_device_error(*this, "create another queue", error);
}

void Device::wait_for(std::span<const cl::Event> events) const try {
    refuse_if_forked();
    if (events.empty()) return;
    const std::vector<cl::Event> list(events.begin(), events.end());
    state_->queue.enqueueBarrierWithWaitList(&list);
} catch (const cl::Error& error) {
    throw_device_error(*this, "wait for events", error);
}

cl::Event Device::event() const try {
    refuse_if_forked();
    cl::Event event;
    state_->queue.enqueueMarkerWithWaitList(nullptr, &event);
    state_->queue.flush();
    return event;
} catch (const cl::Error& error) {
    throw_device_error(*this, "enqueue a marker", error);
}

const DeviceInfo& Device::info() const noexcept { return state_->info; }
const cl::Context& Device::context() const noexcept { return state_->context; }
const cl::CommandQueue& Device::queue() const noexcept { return state_->queue; }
Profiler& Device::profiler() const noexcept { return state_->profiler; }

unsigned Device::tuning(const std::string& kernel, const std::string& parameter) const {
    const auto row = state_->tuning.find(kernel + " " + parameter);
    if (row == state_->tuning.end())
        throw Error(ErrorKind::usage, "no row '" + kernel + " " + parameter + "' in kernels/tuning.txt");
    return row->second;
}

void Device::set_tuning(const std::string& kernel, const std::string& parameter, unsigned value) const {
    state_->tuning[kernel + " " + parameter] = value;
}

Device::State::~State() {
    locked.reset();
    if (owns_queue && !is_forked()) clFinish(queue());
}

void Device::finish() const try {
    refuse_if_forked();
    state_->queue.finish();
    state_->profiler.collect();
} catch (const cl::Error& error) {
    throw_device_error(*this, "finish the work", error);
}

}  // namespace claray
