#include "host/render/kernels/background_compiler.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "host/base/folders.hpp"
#include "host/base/process/process.hpp"

namespace claray {
namespace {

std::atomic<int> running = 0;

/// Returns -1 if the file cannot be opened.
int open_in_cache(const char* name) {
    if (!make_writable(cache_folder())) return -1;
    return ::open((cache_folder() / name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
}

constexpr const char* compiler_lock = "compiler.lock";
constexpr const char* renders_lock = "renders.lock";

/// The lock that allows one compiler at a time. It belongs to the open file, which the compiler inherits, so that it is
/// released when that process ends, whatever ends it.
class CompilerLock {
public:
    CompilerLock() : file_(open_in_cache(compiler_lock)) {
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

/// Tells compilers that a render lives, until this process ends. Returns the file, or -1.
int show_as_render() {
    static std::mutex mutex;
    static std::map<std::filesystem::path, int> shown;
    const std::lock_guard lock(mutex);
    const auto [file, is_new] = shown.try_emplace(cache_folder(), -1);
    if (is_new) file->second = open_in_cache(renders_lock);
    if (is_new && file->second >= 0) ::flock(file->second, LOCK_SH);
    return file->second;
}

/// On Linux threads have priorities, and a process inherits that of the thread that starts it (setpriority(2)).
void lower_priority_of_this_thread() {
    constexpr int lower = 10, lowest = 19;
    ::setpriority(PRIO_PROCESS, 0, std::min(::getpriority(PRIO_PROCESS, 0) + lower, lowest));
}

/// Returns its process number, or 0 if it cannot be started. The text is its standard input.
pid_t start_in_background(const std::vector<std::string>& arguments, const std::string& text, int lock) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> input(std::tmpfile(), std::fclose);
    if (!input || std::fputs(text.c_str(), input.get()) < 0) return 0;
    std::rewind(input.get());
    ::fcntl(::fileno(input.get()), F_SETFD, FD_CLOEXEC);
    pid_t id = 0;
    std::thread([&] {
        lower_priority_of_this_thread();
        id = start_silently(arguments, lock, ::fileno(input.get()));
    }).join();
    return id;
}

}  // namespace

bool start_compiler(const std::string& program, const Device& device, const KernelSet& programs,
                    const KernelSet& later) {
    const int shown = show_as_render();
    const CompilerLock lock;
    if (lock.is_busy()) {
        if (shown >= 0) ::futimens(shown, nullptr);
        return false;
    }
    if (lock.file() < 0) return true;
    const pid_t id =
        start_in_background({program, "compile", "--background", "--device", std::to_string(device.info().index)},
                            to_text(programs) + '\n' + to_text(later), lock.file());
    if (id == 0) return true;
    ++running;
    std::thread([id] {
        wait_for_process(id);  // so that no zombie remains
        --running;
    }).detach();
    return true;
}

bool is_compiling() { return running > 0; }

CompilerWatch::CompilerWatch() : file_(open_in_cache(renders_lock)) {}

CompilerWatch::~CompilerWatch() {
    if (file_ >= 0) ::close(file_);
}

void CompilerWatch::let_others_compile() {
    const std::lock_guard guard(mutex_);
    struct stat now = {};
    if (::fstat(file_, &now) == 0) last_asked_ = now.st_mtim;
    can_wait_ = true;
}

bool CompilerWatch::is_asked() const {
    struct stat now = {};
    return ::fstat(file_, &now) == 0 &&
           (now.st_mtim.tv_sec != last_asked_.tv_sec || now.st_mtim.tv_nsec != last_asked_.tv_nsec);
}

bool CompilerWatch::must_end(double now) {
    const std::lock_guard guard(mutex_);
    const bool none_lives = file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) == 0;
    if (none_lives) ::flock(file_, LOCK_UN);
    if (!none_lives || last_render_ < 0) last_render_ = now;
    return now - last_render_ > seconds_after_renders || (can_wait_ && is_asked());
}

}  // namespace claray
