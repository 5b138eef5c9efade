#include "host/base/host_memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#if defined(__linux__)
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace claray {
namespace {

constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();

/// What is left of a limit; unknown where it is none.
std::uint64_t left_of(std::uint64_t limit, std::uint64_t used) {
    return limit == unknown ? unknown : limit - std::min(limit, used);
}

/// The first number of a file such as /proc/self/statm; unknown where it has none, as "max" in a control group's.
std::uint64_t number_in(const std::string& path) {
    std::uint64_t number = 0;
    return std::ifstream(path) >> number ? number : unknown;
}

/// MemAvailable of /proc/meminfo (proc_meminfo(5)), in kB.
std::uint64_t available_to_all() {
    std::ifstream file("/proc/meminfo");
    std::string name, unit;
    for (std::uint64_t number; file >> name >> number; std::getline(file, unit))
        if (name == "MemAvailable:") return 1024 * number;
    return unknown;
}

/// Of this process' control group, which in containers is the root (cgroups(7)).
std::uint64_t left_in_group() {
    std::string group;
    std::ifstream file("/proc/self/cgroup");
    while (std::getline(file, group) && !group.starts_with("0::")) continue;
    const std::string folder = "/sys/fs/cgroup" + (group.starts_with("0::") ? group.substr(3) : std::string());
    const std::uint64_t used = number_in(folder + "/memory.current");
    return used == unknown ? unknown : left_of(number_in(folder + "/memory.max"), used);
}

std::uint64_t left_of_address_space() {
#if defined(__linux__)
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        return left_of(limit.rlim_cur, number_in("/proc/self/statm") * std::uint64_t(sysconf(_SC_PAGESIZE)));
#endif
    return unknown;
}

}  // namespace

std::uint64_t free_host_memory() { return std::min({available_to_all(), left_in_group(), left_of_address_space()}); }

}  // namespace claray
