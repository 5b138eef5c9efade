#include "host/compute/programs/kernel_set.hpp"

#include <algorithm>
#include <exception>
#include <functional>
#include <optional>
#include <sstream>

#include "host/base/hash.hpp"
#include "host/base/in_parallel.hpp"
#include "host/compute/device_error.hpp"
#include "host/compute/device_state.hpp"
#include "host/compute/programs/compile_program.hpp"
#include "host/compute/programs/compiler_processes.hpp"
#include "host/compute/programs/compiling.hpp"
#include "host/compute/programs/joint_program.hpp"
#include "host/compute/programs/program_cache.hpp"
#include "host/compute/tuning.hpp"

namespace claray {
namespace {

constexpr char separator = '\t';  // of a file and its macros; none has one

std::string identity_of(const Device& device, const ProgramRequest& program) {
    return cache_identity(device, kernel_source(program.file), build_options(device, program.defines));
}

/// A program that the device does not have yet.
struct Missing {
    const ProgramRequest* request;
    std::string options, key;  // in Device::State::programs
    std::optional<cl::Program> program;
    std::exception_ptr failure;
};

std::vector<Missing> missing_of(const Device& device, const KernelSet& set) {
    std::vector<Missing> missing;
    for (const ProgramRequest& program : set.programs()) {
        const std::string options = build_options(device, program.defines);
        const std::string key = key_in_memory(kernel_source(program.file), options);
        if (!device.state().programs.contains(key)) missing.push_back({&program, options, key, {}, {}});
    }
    return missing;
}

/// Has programs put into the cache. A single one compiles in this process without the start of another, unless threads
/// with other contexts compile, too.
void compile_in_processes(const Device& device, const std::vector<ProgramRequest>& programs, bool alone,
                          Compiling& told) {
    if (programs.empty() || (alone && programs.size() == 1)) return;
    if (store_cached_program({}, {}).empty()) compile_in_processes(device, programs, [&] { told.one_done(); });
}

/// Calls `work` for each of `count` numbers, in parallel threads or one after the other.
void for_each(std::size_t count, bool in_threads, const std::function<void(std::size_t)>& work) {
    if (in_threads) return in_parallel(count, work);
    for (std::size_t i = 0; i < count; ++i) work(i);
}

}  // namespace

std::string to_text(const ProgramRequest& program) {
    std::string text = program.file;
    for (const auto& [name, value] : program.defines) text += separator + name + '=' + value;
    return text;
}

ProgramRequest parse_program(const std::string& text) {
    ProgramRequest program;
    std::istringstream words(text);
    std::getline(words, program.file, separator);
    for (std::string word; std::getline(words, word, separator);) {
        const std::size_t name = std::min(word.find('='), word.size());
        program.defines.emplace_back(word.substr(0, name), word.substr(std::min(name + 1, word.size())));
    }
    return program;
}

void KernelSet::add(const Device& device, const KernelRequest& kernel) {
    const std::string stem = kernel.file.substr(0, kernel.file.rfind('.'));
    add(ProgramRequest{kernel.file, with_tuning(device, stem, kernel.defines)});
}

void KernelSet::add(const ProgramRequest& program) {
    if (std::find(programs_.begin(), programs_.end(), program) == programs_.end()) programs_.push_back(program);
}

void KernelSet::add(const KernelSet& other) {
    for (const ProgramRequest& program : other.programs_) add(program);
}

std::string to_text(const KernelSet& set) {
    std::string text;
    for (const ProgramRequest& program : set.programs()) text += to_text(program) + '\n';
    return text;
}

KernelSet read_kernel_set(std::istream& from) {
    KernelSet set;
    for (std::string line; std::getline(from, line) && !line.empty();) set.add(parse_program(line));
    return set;
}

std::string key_of(const Device& device, const KernelSet& set) {
    std::string identities;
    for (const ProgramRequest& program : set.programs()) identities += identity_of(device, program);
    return hash128(identities);
}

bool are_cached(const Device& device, const KernelSet& set) {
    return std::all_of(set.programs().begin(), set.programs().end(),
                       [&](const ProgramRequest& program) { return has_cached_program(identity_of(device, program)); });
}

void load(const Device& device, const KernelSet& set) try {
    const bool side_by_side = device.tuning("compute/programs", "SIDE_BY_SIDE") != 0;
    const bool in_processes = has_compiler_processes(device), in_threads = side_by_side || in_processes;
    std::vector<Missing> wanted = missing_of(device, set);
    if (wanted.empty()) return;
    const TimeOfCompiling timed;
    for_each(wanted.size(), in_threads, [&](std::size_t i) {
        wanted[i].program = load_program_from_cache(device, kernel_source(wanted[i].request->file), wanted[i].options);
    });
    std::vector<ProgramRequest> missing;
    for (const Missing& one : wanted)
        if (!one.program) missing.push_back(*one.request);
    Compiling told(unsigned(missing.size()));
    if (in_processes) compile_in_processes(device, missing, side_by_side, told);
    for_each(wanted.size(), in_threads, [&](std::size_t i) {
        if (wanted[i].program) return;
        try {
            wanted[i].program = compile_program(device, kernel_source(wanted[i].request->file), wanted[i].options, 0);
        } catch (...) {
            wanted[i].failure = std::current_exception();
        }
        if (!in_processes) told.one_done();
    });
    for (const Missing& one : wanted)
        if (one.program) device.state().programs.emplace(one.key, *one.program);
    for (const Missing& one : wanted)
        if (one.failure) std::rethrow_exception(one.failure);
} catch (const cl::Error& error) {
    throw_device_error(device, "load kernels", error);
}

void load_jointly(const Device& device, const KernelSet& set, bool optimized) {
    const JointSource joint = join(set.programs());
    if (joint.members.size() < 2) return;
    try {
        const TimeOfCompiling timed;
        const std::string joint_options =
            build_options(device, {}) + (optimized ? "" : " -cl-opt-disable -DCLARAY_UNOPTIMIZED=1");
        const cl::Program program =
            compile_for_now(device, joint.source, joint_options, unsigned(joint.members.size()));
        for (const ProgramRequest& member : joint.members) {
            const std::string key = key_in_memory(kernel_source(member.file), build_options(device, member.defines));
            const bool is_new = device.state().programs.emplace(key, program).second;
            if (is_new && !optimized) device.state().slow_programs.push_back(key);
        }
    } catch (const Error&) {
        return;  // each file is then compiled separately, with its own error
    }
}

void forget_slow_programs(const Device& device) {
    for (const std::string& key : device.state().slow_programs) device.state().programs.erase(key);
    device.state().slow_programs.clear();
}

}  // namespace claray
