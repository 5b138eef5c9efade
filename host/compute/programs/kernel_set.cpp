#include "host/compute/programs/kernel_set.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <sstream>

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

std::string options_of(const Device& device, const ProgramRequest& program) {
    return build_options(device, program.defines);
}

/// In Device::State::programs.
std::string key_of(const Device& device, const ProgramRequest& program) {
    return key_in_memory(kernel_source(program.file), options_of(device, program));
}

bool is_cached(const Device& device, const ProgramRequest& program) {
    return has_cached_program(cache_identity(device, kernel_source(program.file), options_of(device, program)));
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
    add(ProgramRequest{kernel.file, macros_of(device, kernel.file, kernel.defines)});
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

bool are_cached(const Device& device, const KernelSet& set) {
    return std::all_of(set.programs().begin(), set.programs().end(),
                       [&](const ProgramRequest& program) { return is_cached(device, program); });
}

void load(const Device& device, const KernelSet& set) try {
    const bool side_by_side = device.tuning("compute/programs", "SIDE_BY_SIDE") != 0;
    const bool in_processes = has_compiler_processes(device);
    auto& programs = state_of(device).programs;
    std::vector<ProgramRequest> wanted = set.programs(), missing;
    std::erase_if(wanted, [&](const ProgramRequest& one) { return programs.contains(key_of(device, one)); });
    if (wanted.empty()) return;
    const TimeOfCompiling timed;
    std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(missing),
                 [&](const ProgramRequest& one) { return !is_cached(device, one); });
    Compiling told(unsigned(missing.size()));
    // A single one compiles here without the start of another process, unless threads with other contexts compile, too.
    if (in_processes && missing.size() > (side_by_side ? 1 : 0) && store_cached_program({}, {}).empty())
        compile_in_processes(device, missing, [&] { told.one_done(); });
    std::vector<cl::Program> loaded(wanted.size());
    for_each(wanted.size(), side_by_side || in_processes, [&](std::size_t i) {
        loaded[i] = compile_program(device, kernel_source(wanted[i].file), options_of(device, wanted[i]), 0);
        if (std::find(missing.begin(), missing.end(), wanted[i]) != missing.end()) told.one_done();
    });
    for (std::size_t i = 0; i < wanted.size(); ++i) programs.emplace(key_of(device, wanted[i]), loaded[i]);
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
            const std::string key = key_of(device, member);
            const bool is_new = state_of(device).programs.emplace(key, program).second;
            if (is_new && !optimized) state_of(device).slow_programs.push_back(key);
        }
    } catch (const Error&) {
        return;  // each file is then compiled separately, with its own error
    }
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

}  // namespace claray
