#include "host/compute/programs/compile_program.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <sstream>

#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/drivers/pocl_folder.hpp"
#include "host/compute/programs/build_report.hpp"
#include "host/compute/programs/compiling.hpp"
#include "host/compute/programs/effect_macros.hpp"
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

}  // namespace

Defines macros_of(const Device& device, const std::string& file, const Defines& defines) {
    Defines macros = with_tuning(device, file.substr(0, file.rfind('.')), defines);
    const KernelSource& main = kernel_source(file);
    std::erase_if(macros,
                  [&](const auto& macro) { return !macro.first.starts_with("CLARAY_") && !needs(main, macro.first); });
    add_effect_macros(macros, [&](const std::string& macro) { return needs(main, macro); });
    return macros;
}

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

std::string cache_identity(const Device& device, const KernelSource& main, const std::string& options) {
    const DeviceInfo& info = device.info();
    return info.platform + '\n' + info.name + '\n' + info.driver + '\n' + info.version + '\n' + options + '\n' +
           main.path + '\n' + digest_of_texts(main) + '\n';
}

namespace {

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

/// The first line of a compiler's log that tells of an error, after ": "; empty if none does. Cut to one that a
/// terminal shows.
std::string first_error(const std::string& log) {
    const std::size_t at = log.find("error:");
    if (at == std::string::npos) return {};
    const std::size_t begin = log.rfind('\n', at) + 1;  // npos + 1 is the begin of the log
    return ": " + log.substr(begin, std::min<std::size_t>(log.find('\n', at) - begin, 160));
}

[[noreturn]] void throw_build_error(const Device& device, const KernelSource& main, const std::string& options,
                                    const std::string& log) {
    if (is_pocl(device) && pocl_disk_is_full())
        throw Error(ErrorKind::device, "cannot compile the kernel " + main.path + ": the disk of PoCL's folder is full",
                    "free some space, or set POCL_CACHE_DIR to a folder with more");
    const std::string named = with_file_names(log, main);
    throw Error(ErrorKind::device,
                "cannot compile the kernel " + main.path + " for " + device.info().name + first_error(named), {},
                failure_report(device, main.path + ' ' + options) + "log:\n" + named);
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

struct Compiled {
    cl::Program program;
    std::string parameters;
    bool by_one_call;
};

/// By the driver. The caller holds the lock of `alone_if_needed`.
Compiled compile_by_driver(const Device& device, const KernelSource& main, const std::string& options) {
    const std::optional<cl::Program> by_one_call = compile_by_one_call(device, main, options);
    const cl::Program program = by_one_call ? *by_one_call : compile_from_source(device, main, options);
    statistics.change([](CompileStatistics& s) { ++s.compiled; });
    const std::string parameters = parameters_of(program);
    remember_parameters(device, program, parameters);
    return {program, parameters, by_one_call.has_value()};
}

void note_error_of_cache(const std::string& error) {
    if (!error.empty()) statistics.change([&](CompileStatistics& s) { s.cache_error = error; });
}

}  // namespace

cl::Program compile_program(const Device& device, const KernelSource& main, const std::string& options,
                            unsigned kernels) {
    const std::string identity = cache_identity(device, main, options);
    // Loading the same program waits, too: NVIDIA's driver assembles a loaded program and keeps it for the next
    // process.
    std::optional<Compiling> told;  // also where another process compiles it
    const CacheLock lock("programs", hash128(identity), [&] { told.emplace(kernels); });
    if (const auto program = load_from_cache(device, identity)) return *program;
    if (!told) told.emplace(kernels);
    const std::unique_lock<std::mutex> alone = alone_if_needed(device);
    const Compiled compiled = compile_by_driver(device, main, options);
    const auto binaries = compiled.program.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.empty()) return compiled.program;
    // NVIDIA's driver keeps the machine code of a linked program under another key than that of its binary, which the
    // next process would assemble again.
    if (!compiled.by_one_call && device.tuning("compute/programs", "ONE_CALL") != 0 && !binaries[0].empty())
        (void)build_from_binary(device, binaries[0], compiled.parameters);
    note_error_of_cache(store_cached_program(identity, with_parameters(compiled.parameters, binaries[0])));
    return compiled.program;
}

cl::Program compile_for_now(const Device& device, const KernelSource& main, const std::string& options,
                            unsigned kernels) {
    const Compiling told(kernels);
    const std::unique_lock<std::mutex> alone = alone_if_needed(device);
    const cl::Program program = compile_by_driver(device, main, options).program;
    note_error_of_cache(store_cached_program({}, {}));  // where another process will store
    return program;
}

std::string key_in_memory(const KernelSource& main, const std::string& options, bool user_source) {
    return main.path + '\n' + options + '\n' + std::to_string(kernel_sources_replaced()) + '\n' +
           (user_source ? main.text : "");
}

TimeOfCompiling::~TimeOfCompiling() {
    const double took = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin_).count();
    statistics.change([&](CompileStatistics& s) { s.milliseconds += took; });
}

CompileStatistics compile_statistics() { return statistics.get(); }

BuildReport report_build(const Device& device, const std::string& file, const Defines& defines) try {
    KernelSource source = kernel_source(file);
    // A new declaration makes the source unknown to the driver's own cache.
    const auto now = std::chrono::system_clock::now().time_since_epoch().count();
    source.text += "\nvoid claray_never_seen_" + std::to_string(now) + "(void);\n";
    std::string options = build_options(device, macros_of(device, file, defines)), log;
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

}  // namespace claray
