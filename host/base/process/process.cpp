#include "host/base/process/process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <initializer_list>

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
        return ::posix_spawn(&id, pointers[0], &actions_, nullptr, pointers.data(), environ) == 0 ? id : 0;
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
