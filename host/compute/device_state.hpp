// What the copies of a Device share. Internal to host/compute.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "claray/device.hpp"

namespace claray {

struct Device::State {
    DeviceInfo info;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
    Profiler profiler;
    std::map<std::string, cl::Program> programs;  // by file, options and, for a user's source, its text
    std::map<std::string, unsigned> tuning;       // "kernel parameter" -> value, as resolved for this device
    cl::Buffer ray_queue;                         // see host/trace/query_kernel.hpp; made when first used
};

}  // namespace claray
