#include "claray/program.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <mutex>

#include "host/base/in_parallel.hpp"
#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/drivers/pocl_folder.hpp"
#include "host/compute/fork.hpp"
#include "host/compute/memory.hpp"
#include "host/compute/programs/build_report.hpp"
#include "host/compute/programs/compiler_processes.hpp"
#include "host/compute/programs/compiling.hpp"
#include "host/compute/programs/effect_macros.hpp"
#include "host/compute/programs/joint_program.hpp"
#include "host/compute/programs/kernel_sources.hpp"
#include "host/compute/programs/program_cache.hpp"
#include "host/compute/tuning.hpp"

namespace claray {
namespace {

/// Statistics of all threads.
class Statistics {
public:
    template <class Change>
    void change(const Change& by) {
        const std::lock_guard lock(mutex_);
        by(statistics_);
    }
    [[nodiscard]] CompileStatistics get() const {
        const std::lock_guard lock(mutex_);
        return statistics_;
    }

private:
    mutable std::mutex mutex_;
    CompileStatistics statistics_;
};

Statistics statistics;

/// For `claray verify --compare`, which measures its gain: geometry compiled with fast math.
const std::pair<std::string, std::string> fast_math = {"CLARAY_FAST_MATH", "1"};

bool is_nvidia(const Device& device) { return device.info().vendor.find("NVIDIA") != std::string::npos; }

bool is_pocl(const Device& device) { return device.info().platform == "Portable Computing Language"; }
/// For Kernel::check_arguments; only PoCL is asked.
constexpr const char* tell_parameters = "-cl-kernel-arg-info";

const std::string limit_registers = " -cl-nv-maxrregcount=";

std::string build_options(const Device& device, const Defines& defines, Math math) {
    if (std::find(defines.begin(), defines.end(), fast_math) != defines.end()) math = Math::fast;
    std::string options = "-cl-std=CL1.2 -w";  // PoCL prints the number of warnings
    if (is_pocl(device)) options += std::string(" ") + tell_parameters;
    if (math == Math::fast)
        options += " -cl-fast-relaxed-math";
    else if (device.info().exact_divide)
        options += " -cl-fp32-correctly-rounded-divide-sqrt";
    options += std::string(" -DCLARAY_STRICT=") + (math == Math::strict ? "1" : "0");
    // The schedule that suits the device: see kernels/compute/portable.clh.
    options += std::string(" -DCLARAY_CPU=") + (device.info().type == DeviceType::cpu ? "1" : "0");
    if (is_nvidia(device)) options += " -DCLARAY_NVIDIA=1";
    if (!device.info().fp64) options += " -DCLARAY_NO_FP64=1";
    for (const auto& [name, value] : defines) {
        options += " -D" + name + "=" + value;
        if (name == "MAX_REGISTERS" && is_nvidia(device)) options += limit_registers + value;
    }
    return options;
}

/// Everything on which a binary depends; of the sources their digest.
std::string cache_identity(const Device& device, const KernelSource& main, const std::string& options) {
    const DeviceInfo& info = device.info();
    std::string texts = main.text + '\n';
    for (const KernelSource* source : included_sources(main.text)) texts += source->path + '\n' + source->text + '\n';
    return info.platform + '\n' + info.name + '\n' + info.driver + '\n' + info.version + '\n' + options + '\n' +
           main.path + '\n' + hash128(texts) + '\n';
}

std::string build_log(const cl::Program& program, const cl::Device& device) {
    try {
        return program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device);
    } catch (const cl::Error&) {
        return "(the driver gives no log)";
    }
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, from.size(), to);
}

/// Makes the compiler's messages name the file instead of a temporary one. NVIDIA's ignores the directive and would
/// count one line too many.
std::string name_line(const Device& device, const KernelSource& main) {
    return is_nvidia(device) ? std::string() : "#line 1 \"" + main.path + "\"\n";
}

/// NVIDIA's compiler calls the main file <kernel>.
std::string with_file_names(std::string log, const KernelSource& main) {
    replace_all(log, "<kernel>:", main.path + ":");
    replace_all(log, names_apart, "");
    return log;
}

[[noreturn]] void throw_build_error(const Device& device, const KernelSource& main, const std::string& options,
                                    const std::string& log) {
    if (is_pocl(device) && pocl_disk_is_full())
        throw Error(ErrorKind::device, "cannot compile the kernel " + main.path + ": the disk of PoCL's folder is full",
                    "free some space, or set POCL_CACHE_DIR to a folder with more");
    throw Error(
        ErrorKind::device,
        "cannot compile the kernel " + main.path + " for " + device.info().name + " with options '" + options + "'", {},
        failure_report(device, main.path + ' ' + options) + "log:\n" + with_file_names(log, main));
}

/// Compiles with the included files as named headers, so that #include works on every driver and messages keep file and
/// line. Only the files needed: PoCL writes each to a file (30 ms for 70). CLHPP's Program::compile takes no headers
/// (as of 3.0), hence the C call.
cl::Program compile_from_source(const Device& device, const KernelSource& main, const std::string& options,
                                std::string* log = nullptr) {
    const cl::Context& context = device.context();
    const cl_device_id id = state_of(device).device();
    std::vector<cl::Program> headers;
    std::vector<cl_program> handles;
    std::vector<std::string> paths;
    for (const KernelSource& source : headers_apart(main.text)) {
        headers.emplace_back(context, source.text);
        handles.push_back(headers.back()());
        paths.push_back(source.path);
    }
    std::vector<const char*> names;
    for (const std::string& path : paths) names.push_back(path.c_str());
    const cl::Program program(context, name_line(device, main) + with_names_apart(main.text));
    const cl_int compiled = clCompileProgram(program(), 1, &id, options.c_str(), cl_uint(handles.size()),
                                             handles.empty() ? nullptr : handles.data(),
                                             names.empty() ? nullptr : names.data(), nullptr, nullptr);
    if (compiled != CL_SUCCESS) throw_build_error(device, main, options, build_log(program, state_of(device).device));
    cl_int linked = CL_SUCCESS;
    const cl_program object = program();
    const cl_program result =
        clLinkProgram(context(), 1, &id, is_pocl(device) ? tell_parameters : "", 1, &object, nullptr, nullptr, &linked);
    if (linked != CL_SUCCESS)
        throw_build_error(device, main, options,
                          result ? build_log(cl::Program(result), state_of(device).device) : "the link step failed");
    const cl::Program linked_program(result);
    if (log)
        *log = build_log(program, state_of(device).device) + '\n' + build_log(linked_program, state_of(device).device);
    return linked_program;
}

/// The same by one call. NVIDIA's driver (580) keeps the machine code of such a program for its binary, but keeps that
/// of a linked program under another key: its binary is assembled again when another process loads it for the first
/// time, which takes 58 s for all effects. Not with a limit of registers: the second start took 0.43 s longer (H200).
/// Nothing if it fails: compile_from_source reports the reason.
std::optional<cl::Program> compile_by_one_call(const Device& device, const KernelSource& main,
                                               const std::string& options) {
    if (device.tuning("compute/programs", "ONE_CALL") == 0 || options.find(limit_registers) != std::string::npos)
        return {};
    const HeaderFolder headers(headers_apart(main.text));
    if (headers.path().empty()) return {};
    cl::Program program(device.context(), name_line(device, main) + with_names_apart(main.text));
    try {
        program.build({state_of(device).device}, (options + " -I " + headers.path().string()).c_str());
        return program;
    } catch (const cl::Error&) {
        return {};
    }
}

/// Whether a program has all kernels of these parameters.
bool has_kernels(const cl::Program& program, const std::string& parameters) {
    const std::string names = ';' + program.getInfo<CL_PROGRAM_KERNEL_NAMES>() + ';';
    std::istringstream lines(parameters);
    for (std::string line; std::getline(lines, line);)
        if (names.find(';' + line.substr(0, line.find(' ')) + ';') == std::string::npos) return false;
    return true;
}

/// Nothing if the driver refuses its own binary (for example after an update that kept the version string), or if it is
/// of other kernels.
std::optional<cl::Program> build_from_binary(const Device& device, const std::vector<unsigned char>& binary,
                                             const std::string& parameters) try {
    cl::Program program(device.context(), {state_of(device).device}, {binary});
    program.build({state_of(device).device}, "");
    return has_kernels(program, parameters) ? std::optional(program) : std::nullopt;
} catch (const cl::Error&) {
    return {};
}

/// Several threads may call this at once, for programs that are compiled in parallel.
void remember_parameters(const Device& device, const cl::Program& program, const std::string& parameters) {
    static std::mutex mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    state_of(device).parameters[program()] = parameters;
}

std::optional<cl::Program> load_from_cache(const Device& device, const std::string& identity) {
    const auto cached = load_cached_program(identity);
    if (!cached) return {};
    const auto end =
        std::find(cached->begin(), cached->end(), '\0');  // end of the parameters, which precede the binary
    if (end == cached->end()) return {};
    const std::string parameters(cached->begin(), end);
    auto program = build_from_binary(device, {end + 1, cached->end()}, parameters);
    if (program) remember_parameters(device, *program, parameters);
    if (program) statistics.change([](CompileStatistics& s) { ++s.from_cache; });
    return program;
}

/// PoCL 3.1 lists its cache folder while it returns a binary, and crashes on temporary folders that other threads have
/// removed meanwhile: one thread compiles at a time.
std::unique_lock<std::mutex> alone_if_needed(const Device& device) {
    static std::mutex mutex;
    return is_pocl(device) ? std::unique_lock(mutex) : std::unique_lock<std::mutex>();
}

/// Names and types of the parameters of a program's kernels, one line each. They are stored with binaries, which do not
/// contain them. Empty if the driver does not report them.
std::string parameters_of(const cl::Program& program) try {
    std::vector<cl::Kernel> kernels;
    cl::Program(program).createKernels(&kernels);
    std::string lines;
    for (const cl::Kernel& kernel : kernels)
        for (cl_uint i = 0; i < kernel.getInfo<CL_KERNEL_NUM_ARGS>(); ++i)
            lines += kernel.getInfo<CL_KERNEL_FUNCTION_NAME>() + ' ' + kernel.getArgInfo<CL_KERNEL_ARG_NAME>(i) + ' ' +
                     kernel.getArgInfo<CL_KERNEL_ARG_TYPE_NAME>(i) + '\n';
    return lines;
} catch (const cl::Error&) {
    return {};
}

std::vector<unsigned char> with_parameters(const std::string& parameters, const std::vector<unsigned char>& binary) {
    std::vector<unsigned char> all(parameters.begin(), parameters.end());
    all.push_back('\0');
    all.insert(all.end(), binary.begin(), binary.end());
    return all;
}

/// `kernels`: how many are told to be compiled if the cache does not have the program; 0 if they were told before.
cl::Program compile(const Device& device, const KernelSource& main, const std::string& options, unsigned kernels) {
    const std::string identity = cache_identity(device, main, options);
    // Loading the same program waits, too: NVIDIA's driver assembles a loaded program and keeps it for the next
    // process.
    std::optional<Compiling> told;  // also where another process compiles it
    const CacheLock lock("programs", hash128(identity), [&] { told.emplace(kernels); });
    if (const auto program = load_from_cache(device, identity)) return *program;
    if (!told) told.emplace(kernels);
    const std::unique_lock<std::mutex> alone = alone_if_needed(device);
    const std::optional<cl::Program> by_one_call = compile_by_one_call(device, main, options);
    cl::Program program = by_one_call ? *by_one_call : compile_from_source(device, main, options);
    statistics.change([](CompileStatistics& s) { ++s.compiled; });
    // Also tests whether the cache is writable if nothing is stored, because another process will store.
    const auto binaries = state_of(device).store_programs ? program.getInfo<CL_PROGRAM_BINARIES>()
                                                          : std::vector<std::vector<unsigned char>>(1);
    const std::string parameters = parameters_of(program);
    remember_parameters(device, program, parameters);
    // NVIDIA's driver keeps the machine code of a linked program under another key than that of its binary, which the
    // next process would assemble again.
    if (!by_one_call && device.tuning("compute/programs", "ONE_CALL") != 0 && !binaries.empty() && !binaries[0].empty())
        (void)build_from_binary(device, binaries[0], parameters);
    const std::string error =
        binaries.empty() ? "" : store_cached_program(identity, with_parameters(parameters, binaries[0]));
    if (!error.empty()) statistics.change([&](CompileStatistics& s) { s.cache_error = error; });
    return program;
}

/// The key in Device::State::programs.
std::string key_in_memory(const KernelSource& main, const std::string& options, bool user_source) {
    return main.path + '\n' + options + '\n' + std::to_string(kernel_sources_replaced()) + '\n' +
           (user_source ? main.text : "");
}

void add_milliseconds_since(std::chrono::steady_clock::time_point begin) {
    const double took = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    statistics.change([&](CompileStatistics& s) { s.milliseconds += took; });
}

cl::Program timed_compile(const Device& device, const KernelSource& main, const std::string& options,
                          unsigned kernels = 1) {
    const auto begin = std::chrono::steady_clock::now();
    cl::Program program = compile(device, main, options, kernels);
    add_milliseconds_since(begin);
    return program;
}

/// Throws ErrorKind::usage, with the names that there are, for an unknown one.
cl::Kernel kernel_called(const std::string& function, const cl::Program& program, const std::string& path) try {
    return {program, function.c_str()};
} catch (const cl::Error& error) {
    if (error.err() != CL_INVALID_KERNEL_NAME) throw;
    std::string names = program.getInfo<CL_PROGRAM_KERNEL_NAMES>();
    replace_all(names, ";", ", ");
    throw Error(ErrorKind::usage, "'" + path + "' has no kernel '" + function + "'",
                names.empty() ? "write 'kernel void' before its name" : "its kernels are " + names);
}

Kernel kernel_of(const Device& device, const KernelSource& main, const std::string& function, const Defines& defines,
                 Math math, bool user_source) try {
    const std::string options = build_options(device, defines, math);
    const std::string key = key_in_memory(main, options, user_source);
    auto& programs = state_of(device).programs;
    auto found = programs.find(key);
    if (found == programs.end()) found = programs.emplace(key, timed_compile(device, main, options)).first;
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

/// Those given to a kernel file and its rows of the tuning table, without the macros that its text does not need: what
/// the host alone reads must not compile a kernel again. CLARAY_... are switches of whole programs, such as fast math.
Defines macros_of(const Device& device, const std::string& file, const Defines& defines) {
    Defines macros = with_tuning(device, file.substr(0, file.rfind('.')), defines);
    const KernelSource& main = kernel_source(file);
    std::erase_if(macros,
                  [&](const auto& macro) { return !macro.first.starts_with("CLARAY_") && !needs(main, macro.first); });
    add_effect_macros(macros, [&](const std::string& macro) { return needs(main, macro); });
    return macros;
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

BuildReport report_build(const Device& device, const std::string& file, const Defines& defines) try {
    KernelSource source = kernel_source(file);
    // A new declaration makes the source unknown to the driver's own cache.
    const auto now = std::chrono::system_clock::now().time_since_epoch().count();
    source.text += "\nvoid claray_never_seen_" + std::to_string(now) + "(void);\n";
    std::string options = build_options(device, macros_of(device, file, defines), Math::strict), log;
    if (is_nvidia(device)) options += " -cl-nv-verbose";
    BuildReport report;
    const auto begin = std::chrono::steady_clock::now();
    const cl::Program program = compile_from_source(device, source, options, &log);
    statistics.change([](CompileStatistics& s) { ++s.compiled; });
    (void)program.getInfo<CL_PROGRAM_BINARIES>();  // PoCL generates machine code only on request
    report.milliseconds = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
    read_build_log(log, report);
    return report;
} catch (const cl::Error& error) {
    throw_device_error(device, "compile " + file, error);
}

void read_build_log(const std::string& log, BuildReport& report) {
    const auto number_before = [&](std::size_t at) {
        const std::size_t end = log.find_last_of("0123456789", at);
        if (end == std::string::npos) return 0u;
        const std::size_t before = log.find_last_not_of("0123456789", end);
        return unsigned(std::stoul(log.substr(before + 1, end - before)));
    };
    const auto largest = [&](const std::string& words, std::optional<unsigned>& value) {
        for (std::size_t at = 0; (at = log.find(words, at)) != std::string::npos; at += words.size())
            value = std::max(value.value_or(0), number_before(at));
    };
    largest(" registers", report.registers);
    largest(" bytes spill stores", report.spill_bytes);
}

Kernel load_kernel(const Device& device, const std::string& file, const std::string& function, const Defines& defines,
                   Math math) {
    const Defines all = macros_of(device, file, defines);
    if (state_of(device).requests == nullptr) return kernel_of(device, kernel_source(file), function, all, math, false);
    if (math == Math::strict) state_of(device).requests->push_back({file, all});
    return Kernel(device, {}, function);
}

namespace {

/// The requests of `load`.
std::vector<KernelRequest> requests_of(const Device& device, const std::function<void()>& load) {
    struct Noted {
        const Device& device;
        std::vector<KernelRequest> requests;
        explicit Noted(const Device& on) : device(on) { state_of(device).requests = &requests; }
        ~Noted() { state_of(device).requests = nullptr; }
    } noted(device);
    load();
    return noted.requests;
}

}  // namespace

void compile_jointly(const Device& device, const std::function<void()>& load, bool optimized) {
    const JointSource joint = join(requests_of(device, load));
    if (joint.members.size() < 2) return;
    try {
        const std::string joint_options =
            build_options(device, {}, Math::strict) + (optimized ? "" : " -cl-opt-disable -DCLARAY_UNOPTIMIZED=1");
        const cl::Program program = timed_compile(device, joint.source, joint_options, unsigned(joint.members.size()));
        for (const KernelRequest& member : joint.members) {
            const std::string options = build_options(device, member.defines, Math::strict);
            const std::string key = key_in_memory(kernel_source(member.file), options, false);
            const bool is_new = state_of(device).programs.emplace(key, program).second;
            if (is_new && !optimized) state_of(device).slow_programs.push_back(key);
        }
    } catch (const Error&) {
        return;  // each file is then compiled separately, with its own error
    }
}

namespace {

/// The request of load_kernel and its key in Device::State::programs.
struct Wanted {
    std::string file, options, key;
    std::optional<cl::Program> program;
};

/// Those that `load` requests and that the device does not have yet.
std::vector<Wanted> wanted_by(const Device& device, const std::function<void()>& load) {
    std::vector<Wanted> wanted;
    const auto& programs = state_of(device).programs;
    for (const KernelRequest& request : requests_of(device, load)) {
        const std::string options = build_options(device, request.defines, Math::strict);
        const std::string key = key_in_memory(kernel_source(request.file), options, false);
        const auto same = [&](const Wanted& other) { return other.key == key; };
        if (programs.contains(key) || std::any_of(wanted.begin(), wanted.end(), same)) continue;
        wanted.push_back({request.file, options, key, {}});
    }
    return wanted;
}

/// Nothing if it is not in the cache.
std::optional<cl::Program> load_if_cached(const Device& device, const Wanted& one) {
    const std::string identity = cache_identity(device, kernel_source(one.file), one.options);
    std::optional<Compiling> told;
    const CacheLock lock("programs", hash128(identity), [&] { told.emplace(1); });  // as in `compile`
    return load_from_cache(device, identity);
}

/// Has programs put into the cache. A single one compiles in this process without the start of another, unless threads
/// with other contexts compile, too.
void compile_in_processes(const Device& device, const std::vector<ProgramRequest>& missing, bool alone,
                          Compiling& told) {
    if (missing.empty() || (alone && missing.size() == 1)) return;
    const auto& [file, options] = missing.front();
    const bool can_store = store_cached_program(cache_identity(device, kernel_source(file), options), {}).empty();
    if (can_store) compile_in_processes(device, missing, [&] { told.one_done(); });
}

/// Calls `work` for each of `count` numbers, in parallel threads or one after the other.
void for_each(std::size_t count, bool in_threads, const std::function<void(std::size_t)>& work) {
    if (in_threads) return in_parallel(count, work);
    for (std::size_t i = 0; i < count; ++i) work(i);
}

}  // namespace

void compile_for_cache(const Device& device, const ProgramRequest& program) {
    static_cast<void>(compile(device, kernel_source(program.file), program.options, 1));
}

void compile_side_by_side(const Device& device, const std::function<void()>& load) {
    if (state_of(device).requests != nullptr) return load();  // part of what another call compiles
    const bool side_by_side = device.tuning("compute/programs", "SIDE_BY_SIDE") != 0;
    const bool in_processes = has_compiler_processes(device), in_threads = side_by_side || in_processes;
    auto& programs = state_of(device).programs;
    const bool seems_complete = !programs.empty() && programs.size() == state_of(device).programs_of_all_asked;
    if (!in_threads && (seems_complete || !is_told_of_compiling())) return;  // load_kernel does the same
    std::vector<Wanted> wanted = wanted_by(device, load);
    if (wanted.empty()) state_of(device).programs_of_all_asked = programs.size();
    const auto begin = std::chrono::steady_clock::now();
    for_each(wanted.size(), in_threads, [&](std::size_t i) { wanted[i].program = load_if_cached(device, wanted[i]); });
    std::vector<ProgramRequest> missing;
    for (const Wanted& one : wanted)
        if (!one.program) missing.push_back({one.file, one.options});
    Compiling told(unsigned(missing.size()));
    if (in_processes) compile_in_processes(device, missing, side_by_side, told);
    for_each(wanted.size(), in_threads, [&](std::size_t i) {
        if (wanted[i].program) return;
        try {
            wanted[i].program = compile(device, kernel_source(wanted[i].file), wanted[i].options, 0);
        } catch (const std::exception&) {  // load_kernel will report the reason
        }
        if (!in_processes) told.one_done();
    });
    add_milliseconds_since(begin);
    for (const Wanted& one : wanted)
        if (one.program) programs.emplace(one.key, *one.program);
}

void forget_slow_programs(const Device& device) {
    auto& programs = state_of(device).programs;
    for (const std::string& key : state_of(device).slow_programs)
        if (const auto slow = programs.find(key); slow != programs.end()) {
            state_of(device).kernels->forget(slow->second);
            programs.erase(slow);
        }
    state_of(device).slow_programs.clear();
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

CompileStatistics compile_statistics() { return statistics.get(); }

}  // namespace claray
