// The programs that something needs, as data: pure functions make sets from configurations, one function loads them,
// and other processes get them as text. Loading a set before its kernels compiles its programs in parallel, or as one:
// a driver needs a tenth of a second even for a small program (PoCL 3.1: 75 ms for an empty kernel), or seconds
// (NVIDIA's).
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "claray/program.hpp"

namespace claray {

/// A kernel, as load_kernel takes it.
struct KernelRequest {
    std::string file, function;
    Defines defines;
};

/// A file under kernels/ and its macros, with those of the tuning table.
struct ProgramRequest {
    std::string file;
    Defines defines;
    bool operator==(const ProgramRequest&) const = default;
};

/// "file", then a tab and "NAME=value" for each macro.
[[nodiscard]] std::string to_text(const ProgramRequest& program);
[[nodiscard]] ProgramRequest parse_program(const std::string& text);

/// Programs, each once.
class KernelSet {
public:
    void add(const Device& device, const KernelRequest& kernel);
    void add(const ProgramRequest& program);
    void add(const KernelSet& other);
    [[nodiscard]] const std::vector<ProgramRequest>& programs() const { return programs_; }
    bool operator==(const KernelSet&) const = default;

private:
    std::vector<ProgramRequest> programs_;
};

/// A line for each program.
[[nodiscard]] std::string to_text(const KernelSet& set);
/// Reads such lines until an empty one or the end.
[[nodiscard]] KernelSet read_kernel_set(std::istream& from);

/// Whether the cache has all programs.
[[nodiscard]] bool are_cached(const Device& device, const KernelSet& set);

/// Loads programs from the cache or compiles and stores them, so that load_kernel finds them: in parallel threads or
/// processes if the tuning table says that this suits the device, else one after the other. Throws ErrorKind::device
/// with the compiler's log.
void load(const Device& device, const KernelSet& set);
/// The same as one program, as far as they can share one (joint_program.hpp). It is not stored. If it does not compile,
/// nothing happens. Without `optimized` it compiles in little more than half the time and runs several times slower.
void load_jointly(const Device& device, const KernelSet& set, bool optimized = true);
/// Makes load_kernel forget programs that were not optimized. Loaded kernels are unaffected.
void forget_slow_programs(const Device& device);

/// A kernel that an object has as a member.
template <class Owner>
struct KernelOf {
    Kernel Owner::*member;
    KernelRequest request;
};
template <class Owner>
using KernelsOf = std::vector<KernelOf<Owner>>;

template <class Owner>
[[nodiscard]] KernelSet programs_of(const Device& device, const KernelsOf<Owner>& kernels) {
    KernelSet set;
    for (const auto& [member, request] : kernels) set.add(device, request);
    return set;
}

[[nodiscard]] inline Kernel load_kernel(const Device& device, const KernelRequest& request) {
    return load_kernel(device, request.file, request.function, request.defines);
}

template <class Owner>
void load(const Device& device, const KernelsOf<Owner>& kernels, Owner& owner) {
    for (const auto& [member, request] : kernels) owner.*member = load_kernel(device, request);
}

}  // namespace claray
