#include "host/verify/apart/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <vector>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/compute/fork.hpp"

namespace claray::verify {
namespace {

/// A length precedes each message.
void write_message(int pipe, const std::string& message) {
    const std::uint64_t length = message.size();
    const std::string bytes = std::string(reinterpret_cast<const char*>(&length), sizeof length) + message;
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t count = ::write(pipe, bytes.data() + done, bytes.size() - done);
        if (count > 0)
            done += std::size_t(count);
        else if (errno != EINTR)
            ::_exit(1);  // nobody reads it
    }
}

[[noreturn]] void work_and_exit(const std::function<void(const Child::Send&)>& work, int pipe, pid_t parent) {
#ifdef __linux__
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    ::setpgid(0, 0);
    if (::getppid() != parent) ::_exit(1);  // it died before
    std::mutex mutex;
    work([&](const std::string& message) {
        const std::lock_guard lock(mutex);
        write_message(pipe, message);
    });
    // As programs end that use OpenCL: drivers' files are removed. A driver's threads do not exist in a copy of a
    // process that used it before, so that its cleaning would wait for them.
    if (is_forked()) ::_exit(0);
    std::exit(0);
}

std::string signal_text(int number) {
#ifdef __GLIBC__
    const char* const name = ::sigabbrev_np(number);
    if (name != nullptr) return printed("signal %d (SIG%s)", number, name);
#endif
    return printed("signal %d", number);
}

}  // namespace

Child::Child(const std::function<void(const Send&)>& work) {
    const auto refuse = [](const char* what) {
        throw Error(ErrorKind::user, std::string("cannot start a process: ") + what + ": " + std::strerror(errno),
                    "end other programs");
    };
    int ends[2];
    if (::pipe(ends) != 0) refuse("pipe");
    for (const int end : ends) ::fcntl(end, F_SETFD, FD_CLOEXEC);  // a driver's compilers do not keep it open
    std::fflush(nullptr);                                          // else both processes would write what waits
    const pid_t parent = ::getpid();
    id_ = ::fork();
    if (id_ == 0) {
        ::close(ends[0]);
        work_and_exit(work, ends[1], parent);
    }
    ::close(ends[1]);
    pipe_ = ends[0];
    if (id_ > 0) {
        ::setpgid(id_, id_);  // the child may not have done so yet
        return;
    }
    ::close(pipe_);
    refuse("fork");
}

Child::~Child() {
    ::close(pipe_);
    if (id_ != 0) (void)end();
}

int Child::end() {
    ::kill(-id_, SIGKILL);
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return status;
}

bool Child::has_message(std::string& message) {
    std::uint64_t length = 0;
    if (received_.size() < sizeof length) return false;
    std::memcpy(&length, received_.data(), sizeof length);
    if (received_.size() - sizeof length < length) return false;
    message = received_.substr(sizeof length, length);
    received_.erase(0, sizeof length + length);
    return true;
}

bool Child::wait(std::span<Child* const> children, Clock::time_point until) {
    std::vector<struct pollfd> pipes;
    for (const Child* child : children) pipes.push_back({child->pipe_, POLLIN, 0});
    for (;;) {
        using std::chrono::milliseconds;
        const auto left = std::chrono::ceil<milliseconds>(until - Clock::now());
        const auto most = std::clamp(left, milliseconds(0), milliseconds(3'600'000));
        const int ready = ::poll(pipes.data(), nfds_t(pipes.size()), int(most.count()));
        if (ready > 0) return true;
        if (ready == 0 && left <= most) return false;
    }
}

Child::Heard Child::hear(std::string& message, Clock::time_point until) {
    Child* const self = this;
    while (!has_message(message)) {
        if (!wait({&self, 1}, until)) return Heard::nothing;
        char bytes[1 << 16];
        const ssize_t count = ::read(pipe_, bytes, sizeof bytes);
        if (count == 0) return Heard::end;
        if (count > 0) received_.append(bytes, std::size_t(count));
    }
    return Heard::message;
}

std::string Child::ended(Clock::time_point until) {
    std::string message;
    Heard heard = Heard::message;
    while (heard == Heard::message) heard = hear(message, until);
    if (heard == Heard::end) {  // it has closed all files, but its status may come later
        siginfo_t information;
        while (::waitid(P_PID, id_t(id_), &information, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
        }
    }
    const int status = end();
    if (WIFSIGNALED(status)) return "by " + signal_text(WTERMSIG(status));
    return WEXITSTATUS(status) == 0 ? "" : printed("with exit code %d", WEXITSTATUS(status));
}

}  // namespace claray::verify
