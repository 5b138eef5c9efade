// A copy of this process that works for it: it may hang or crash.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <span>
#include <string>

namespace claray::verify {

/// A child process that runs a function, and what it sends. Made by fork(): if OpenCL was used before, the function
/// must not use it. Processes that it starts end with it.
class Child {
public:
    using Clock = std::chrono::steady_clock;
    /// Sends a message to the parent; from any thread.
    using Send = std::function<void(const std::string&)>;

    /// Throws ErrorKind::user if the system has no further process.
    explicit Child(const std::function<void(const Send&)>& work);
    /// Kills the process, if it has not ended, and waits for it. If this process dies, the child does so, too.
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Waits until one of them has sent something or ended, or until a time; returns false then.
    static bool wait(std::span<Child* const> children, Clock::time_point until);

    enum class Heard { message, nothing, end };
    /// Waits for a message, the end of the process or a time.
    [[nodiscard]] Heard hear(std::string& message, Clock::time_point until);
    /// Waits for its end, at most until a time. Returns how it ended: empty if it returned from its function.
    [[nodiscard]] std::string ended(Clock::time_point until);

private:
    [[nodiscard]] bool has_message(std::string& message);
    /// Kills the process and those that it started. Returns its status.
    int end();

    int pipe_ = -1;
    pid_t id_ = 0;
    std::string received_;
};

}  // namespace claray::verify
