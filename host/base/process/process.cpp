#include "host/base/process/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <initializer_list>
#include <optional>

extern char** environ;

namespace claray {
namespace {

/// What a new process has as its standard streams and other files.
class Files {
public:
    Files() { ::posix_spawn_file_actions_init(&actions_); }
    ~Files() { ::posix_spawn_file_actions_destroy(&actions_); }
    Files(const Files&) = delete;
    Files& operator=(const Files&) = delete;

    /// So that no pipe of this process waits for it.
    void silence(std::initializer_list<int> streams) {
        for (const int stream : streams) ::posix_spawn_file_actions_addopen(&actions_, stream, "/dev/null", O_RDWR, 0);
    }
    void give(int file, int as) { ::posix_spawn_file_actions_adddup2(&actions_, file, as); }

    /// Returns 0 if the program cannot be started.
    [[nodiscard]] pid_t start(std::vector<std::string>& arguments) const {
        std::vector<char*> pointers;
        for (std::string& argument : arguments) pointers.push_back(argument.data());
        pointers.push_back(nullptr);
        pid_t id = 0;
        return ::posix_spawnp(&id, pointers[0], &actions_, nullptr, pointers.data(), environ) == 0 ? id : 0;
    }

private:
    posix_spawn_file_actions_t actions_{};
};

}  // namespace

pid_t start_silently(std::vector<std::string> arguments, int file, int input) {
    Files files;
    files.silence({STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO});
    if (input >= 0) files.give(input, STDIN_FILENO);
    if (file >= 0) files.give(file, STDERR_FILENO + 1);
    return files.start(arguments);
}

bool wait_for_process(pid_t id) {
    int status = 0;
    while (::waitpid(id, &status, 0) < 0)
        if (errno != EINTR) return false;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

namespace {

/// The end of a pipe from which this process reads, until the other end is closed.
class Reader {
public:
    Reader() {
        if (::pipe2(ends_.data(), O_CLOEXEC) != 0) ends_ = {-1, -1};
    }
    ~Reader() {
        close(0);
        close(1);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    [[nodiscard]] int other_end() const { return ends_[1]; }
    void close_other_end() { close(1); }
    [[nodiscard]] bool is_open() const { return ends_[0] >= 0; }
    [[nodiscard]] pollfd wanted() const { return {ends_[0], POLLIN, 0}; }

    /// Appends what has arrived.
    void read(std::string& to) {
        std::array<char, 1 << 16> bytes;
        const ssize_t count = ::read(ends_[0], bytes.data(), bytes.size());
        if (count > 0)
            to.append(bytes.data(), std::size_t(count));
        else if (count == 0 || errno != EINTR)
            close(0);
    }

private:
    void close(std::size_t end) {
        if (ends_[end] >= 0) ::close(ends_[end]);
        ends_[end] = -1;
    }

    std::array<int, 2> ends_{-1, -1};
};

/// Reads both pipes to their ends. Returns why the program must be killed, if it must.
std::optional<ProgramOutput::End> read_all(Reader& output, Reader& errors, ProgramOutput& result,
                                           const ProgramLimits& limits) {
    using Clock = std::chrono::steady_clock;
    constexpr std::size_t most_errors = 1 << 16;
    const Clock::time_point end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limits.seconds));
    while (output.is_open() || errors.is_open()) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
        if (left <= 0) return ProgramOutput::End::too_slow;
        std::array<pollfd, 2> files = {output.wanted(), errors.wanted()};
        if (::poll(files.data(), files.size(), int(std::min<long long>(left, 1000))) <= 0) continue;
        if (files[0].revents != 0) output.read(result.output);
        if (files[1].revents != 0) errors.read(result.errors);
        if (result.output.size() > limits.bytes) return ProgramOutput::End::too_long;
        result.errors.resize(std::min(result.errors.size(), most_errors));
    }
    return {};
}

}  // namespace

ProgramOutput run_program(std::vector<std::string> arguments, const ProgramLimits& limits) {
    ProgramOutput result;
    Reader output, errors;
    if (!output.is_open() || !errors.is_open()) return result;
    Files files;
    files.silence({STDIN_FILENO});
    files.give(output.other_end(), STDOUT_FILENO);
    files.give(errors.other_end(), STDERR_FILENO);
    const pid_t id = files.start(arguments);
    if (id == 0) return result;
    output.close_other_end();
    errors.close_other_end();
    const std::optional<ProgramOutput::End> excess = read_all(output, errors, result, limits);
    if (excess) ::kill(id, SIGKILL);
    int status = 0;
    while (::waitpid(id, &status, 0) < 0)
        if (errno != EINTR) return result;
    result.end = excess.value_or(WIFEXITED(status) ? ProgramOutput::End::exited : ProgramOutput::End::killed);
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
    return result;
}

AnsweringProcess::AnsweringProcess(std::vector<std::string> arguments) {
    int ends[2];  // a socket, since a write to a pipe that nobody reads ends this process
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return;
    Files files;
    files.give(ends[1], STDIN_FILENO);
    files.give(ends[1], STDOUT_FILENO);
    files.silence({STDERR_FILENO});
    id_ = files.start(arguments);
    ::close(ends[1]);
    socket_ = ends[0];
    if (id_ == 0) end();
}

AnsweringProcess::~AnsweringProcess() { end(); }

void AnsweringProcess::end() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
    if (id_ != 0) wait_for_process(id_);
    id_ = 0;
}

std::string AnsweringProcess::ask(const std::string& line) {
    const std::string sent = line + '\n';
    for (std::size_t done = 0; socket_ >= 0 && done < sent.size();) {
        const ssize_t count = ::send(socket_, sent.data() + done, sent.size() - done, MSG_NOSIGNAL);
        if (count > 0)
            done += std::size_t(count);
        else if (errno != EINTR)
            end();
    }
    std::string answer;
    for (char c = 0; socket_ >= 0 && c != '\n';) {
        const ssize_t count = ::recv(socket_, &c, 1, 0);
        if (count == 1)
            answer += c;
        else if (count == 0 || errno != EINTR)
            end();
    }
    if (socket_ < 0) return {};
    answer.pop_back();
    return answer;
}

std::string this_program() {
    std::error_code unknown;
    return std::filesystem::read_symlink("/proc/self/exe", unknown).string();
}

}  // namespace claray
