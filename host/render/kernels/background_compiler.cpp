#include "host/render/kernels/background_compiler.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <thread>

#include "host/base/folders.hpp"
#include "host/base/process.hpp"
#include "host/effects/effects.hpp"

namespace claray {
namespace {

std::atomic<int> running = 0;
constexpr int inherited_lock = STDERR_FILENO + 1;

std::filesystem::path lock_path() { return cache_folder() / "compiler.lock"; }

/// The lock that allows one compiler at a time. It belongs to the open file, which the compiler inherits, so that it is
/// released when that process ends, whatever ends it.
class CompilerLock {
public:
    CompilerLock() {
        if (!make_writable(cache_folder())) return;
        file_ = ::open(lock_path().c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
        if (file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) != 0) is_busy_ = errno == EWOULDBLOCK;
    }
    ~CompilerLock() {
        if (file_ >= 0) ::close(file_);
    }
    CompilerLock(const CompilerLock&) = delete;
    CompilerLock& operator=(const CompilerLock&) = delete;

    [[nodiscard]] int file() const { return file_; }  ///< -1 if the file cannot be opened
    [[nodiscard]] bool is_busy() const { return is_busy_; }

private:
    int file_ = -1;
    bool is_busy_ = false;
};

std::vector<std::string> command_line(const std::string& program, const Device& device, const KernelChoice& choice,
                                      const RenderConfig& config) {
    std::vector<std::string> line = {program,         "compile",
                                     "--quiet",       "--and-generic",
                                     "--device",      std::to_string(device.info().index),
                                     "--effects",     to_string(choice.effects),
                                     "--layout",      choice.layout == Layout::wide ? "wide" : "binary",
                                     "--morton-bits", std::to_string(config.bvh.morton_bits),
                                     "--builder",     traits_of(config.bvh.builder).name};
    if (config.approximate.any()) line.insert(line.end(), {"--approximate", to_string(config.approximate)});
    return line;
}

/// On Linux threads have priorities, and a process inherits that of the thread that starts it (setpriority(2)).
void lower_priority_of_this_thread() {
    constexpr int lower = 10, lowest = 19;
    ::setpriority(PRIO_PROCESS, 0, std::min(::getpriority(PRIO_PROCESS, 0) + lower, lowest));
}

/// Returns its process number, or 0 if it cannot be started.
pid_t start_in_background(const std::vector<std::string>& arguments, int lock) {
    pid_t id = 0;
    std::thread([&] {
        lower_priority_of_this_thread();
        id = start_silently(arguments, lock);
    }).join();
    return id;
}

}  // namespace

bool start_compiler(const std::string& program, const Device& device, const KernelChoice& choice,
                    const RenderConfig& config) {
    const CompilerLock lock;
    if (lock.is_busy()) return false;
    if (lock.file() < 0) return true;
    const pid_t id = start_in_background(command_line(program, device, choice, config), lock.file());
    if (id == 0) return true;
    ++running;
    std::thread([id] {
        wait_for_process(id);  // so that no zombie remains
        --running;
    }).detach();
    return true;
}

void let_others_compile() {
    struct stat inherited = {}, lock = {};
    if (::fstat(inherited_lock, &inherited) == 0 && ::stat(lock_path().c_str(), &lock) == 0 &&
        inherited.st_dev == lock.st_dev && inherited.st_ino == lock.st_ino)
        ::close(inherited_lock);
}

bool is_compiling() { return running > 0; }

}  // namespace claray
