#include "claray/program.hpp"

#include <algorithm>
#include <sstream>

#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/fork.hpp"
#include "host/compute/memory.hpp"
#include "host/compute/programs/compile_program.hpp"
#include "host/compute/programs/effect_macros.hpp"

namespace claray {
namespace {

/// Throws ErrorKind::usage, with the names that there are, for an unknown one.
cl::Kernel kernel_called(const std::string& function, const cl::Program& program, const std::string& path) try {
    return {program, function.c_str()};
} catch (const cl::Error& error) {
    if (error.err() != CL_INVALID_KERNEL_NAME) throw;
    std::string names = program.getInfo<CL_PROGRAM_KERNEL_NAMES>();
    for (std::size_t at = 0; (at = names.find(';', at)) != std::string::npos; at += 2) names.replace(at, 1, ", ");
    throw Error(ErrorKind::usage, "'" + path + "' has no kernel '" + function + "'",
                names.empty() ? "write 'kernel void' before its name" : "its kernels are " + names);
}

Kernel kernel_of(const Device& device, const KernelSource& main, const std::string& function, const Defines& defines,
                 Math math, bool user_source) try {
    const std::string options = build_options(device, defines, math);
    const std::string key = key_in_memory(main, options, user_source);
    auto& programs = state_of(device).programs;
    auto found = programs.find(key);
    if (found == programs.end()) {
        const TimeOfCompiling timed;
        found = programs.emplace(key, compile_program(device, main, options)).first;
    }
    const cl::Program& program = found->second;
    return state_of(device).kernels->take(device, program, function, [&] {
        Kernel kernel(device, kernel_called(function, program, main.path), function);
        if (!user_source) kernel.check_arguments(state_of(device).parameters[program()]);
        return kernel;
    });
} catch (const cl::Error& error) {
    throw_device_error(device, "load the kernel " + function + " of " + main.path, error);
}

/// A kernel's file and options, or nothing if they are no longer known.
std::string compiled_with(const Device& device, const cl::Kernel& kernel) try {
    const auto program = kernel.getInfo<CL_KERNEL_PROGRAM>();
    for (const auto& [key, known] : state_of(device).programs) {
        if (known() != program()) continue;
        const std::size_t path = key.find('\n');
        return key.substr(0, path) + ' ' + key.substr(path + 1, key.find('\n', path + 1) - path - 1);
    }
    return {};
} catch (const cl::Error&) {
    return {};
}

}  // namespace

void Kernel::check_arguments(const std::string& lines) {
    std::vector<Parameter> parameters;
    std::istringstream rows(lines);
    for (std::string row; std::getline(rows, row);) {
        const std::size_t name = row.find(' ') + 1, type = row.find(' ', name) + 1;
        if (row.substr(0, name - 1) == name_)
            parameters.push_back({row.substr(name, type - 1 - name), row.substr(type)});
    }
    if (parameters.empty()) return;
    for (Parameter& one : parameters)
        one.ambiguous =
            one.type.ends_with('*') && 1 < std::count_if(parameters.begin(), parameters.end(),
                                                         [&](const Parameter& p) { return p.type == one.type; });
    parameters_ = std::make_shared<const std::vector<Parameter>>(std::move(parameters));
}

namespace {
/// Returns whether a parameter points to this type or, like float4*, to vectors of it.
bool points_to(std::string_view parameter, std::string_view type) {
    return parameter.starts_with(type) && parameter.find_first_of("0123456789*", type.size()) == type.size();
}
}  // namespace

void Kernel::check_buffer(unsigned index, const char* type) {
    if (!parameters_ || index >= parameters_->size()) return;
    const Parameter& parameter = (*parameters_)[index];
    const auto place = [&] { return "argument " + std::to_string(index) + " of the kernel " + name_; };
    if (type != nullptr && !points_to(parameter.type, type))
        throw Error(ErrorKind::usage,
                    place() + " is a buffer of " + type + ", but '" + parameter.name + "' is a " + parameter.type);
    if (parameter.ambiguous && name_of_argument_ == nullptr)
        throw Error(ErrorKind::usage, place() + " needs its name, since the kernel has several buffers of its type",
                    "write arg(\"" + parameter.name + "\", ...)");
}

void Kernel::check_context(unsigned index, const Device& of_buffer) const {
    if (!device_ || of_buffer.context()() == device_->context()()) return;
    const std::string name = name_of_argument_ ? "'" + std::string(name_of_argument_) + "'" : std::to_string(index);
    throw Error(ErrorKind::usage, "argument " + name + " of the kernel " + name_ + " is a buffer of another context",
                "make it with the device on which the kernel runs");
}

void Kernel::check_name(unsigned index) {
    const char* name = std::exchange(name_of_argument_, nullptr);
    if (name == nullptr || !parameters_ || index >= parameters_->size() || (*parameters_)[index].name == name) return;
    throw Error(ErrorKind::usage, "argument " + std::to_string(index) + " of the kernel " + name_ + " is called '" +
                                      (*parameters_)[index].name + "', not '" + name + "'");
}

void Kernel::set_argument(unsigned index, std::size_t bytes, const void* value) {
    check_name(index);
    if (!device_) throw Error(ErrorKind::usage, "cannot bind an argument of a kernel that was never loaded");
    const cl_int status = clSetKernelArg(kernel_(), index, bytes, value);
    if (status != CL_SUCCESS)
        throw Error(ErrorKind::usage, "argument " + std::to_string(index) + " of the kernel " + name_ +
                                          " has the wrong size or type (OpenCL error " + std::to_string(status) + ")");
}

void Kernel::enqueue(Range range, unsigned arguments) try {
    if (!device_) throw Error(ErrorKind::usage, "cannot run a kernel that was never loaded");
    refuse_if_forked();
    const auto expected = kernel_.getInfo<CL_KERNEL_NUM_ARGS>();
    if (arguments != expected)
        throw Error(ErrorKind::usage, "the kernel " + name_ + " takes " + std::to_string(expected) + " arguments, " +
                                          std::to_string(arguments) + " were given");
    if (range.global == 0) return;
    std::size_t global = range.global;
    if (range.local != 0) global = (global + range.local - 1) / range.local * range.local;
    fail_if_asked(state_of(*device_).failing_command, state_of(*device_).failing_with);
    if (std::set<std::string>* const names = state_of(*device_).kernels_run)
        names->insert(kernel_.getInfo<CL_KERNEL_FUNCTION_NAME>());
    device_->profiler().record(name_, [&](cl::Event* event) {
        device_->queue().enqueueNDRangeKernel(kernel_, cl::NullRange, cl::NDRange(global),
                                              range.local ? cl::NDRange(range.local) : cl::NullRange, nullptr, event);
    });
} catch (const cl::Error& error) {
    // Drivers may delay an allocation until the buffer is first used, and other programs may use memory, too.
    if (error.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE || error.err() == CL_OUT_OF_HOST_MEMORY)
        throw OutOfMemory("out of device memory: " + device_->info().name + " has no memory left for the kernel " +
                              name_ + ", where claray uses " + size_text(bytes_in_use(*device_)) + " of its " +
                              size_text(device_->info().memory) + " (OpenCL error " + std::to_string(error.err()) + ")",
                          "close other programs that use its memory, or use a smaller scene");
    throw_device_error(*device_, "run the kernel " + name_, error, compiled_with(*device_, kernel_));
}

Kernel load_kernel(const Device& device, const std::string& file, const std::string& function, const Defines& defines,
                   Math math) {
    return kernel_of(device, kernel_source(file), function, macros_of(device, file, defines), math, false);
}

Kernel compile_kernel(const Device& device, const std::string& source, const std::string& function,
                      const Defines& defines, Math math, const std::string& name) {
    const std::vector<const KernelSource*> headers = included_sources(source);
    Defines all = defines;
    add_effect_macros(all, [&](const std::string& macro) {
        return std::any_of(headers.begin(), headers.end(),
                           [&](const KernelSource* header) { return mentions(*header, macro); });
    });
    Kernel kernel = kernel_of(device, {name, source}, function, all, math, true);
    kernel.remember(defines);
    return kernel;
}

void Kernel::require(const Defines& macros) const {
    if (!macros_) return;
    for (const auto& macro : macros)
        if (std::find(macros_->begin(), macros_->end(), macro) == macros_->end())
            throw Error(ErrorKind::usage,
                        "the kernel " + name_ + " was not compiled for this structure: it lacks " + macro.first + "=" +
                            macro.second,
                        "pass the structure's defines() to compile_kernel");
}

}  // namespace claray
