#include "host/base/process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

extern char** environ;

namespace claray {

pid_t start_silently(std::vector<std::string> arguments, int file) {
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t streams;
    ::posix_spawn_file_actions_init(&streams);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})  // so that no pipe waits for it
        ::posix_spawn_file_actions_addopen(&streams, stream, "/dev/null", O_RDWR, 0);
    if (file >= 0) ::posix_spawn_file_actions_adddup2(&streams, file, STDERR_FILENO + 1);
    pid_t id = 0;
    if (::posix_spawn(&id, pointers[0], &streams, nullptr, pointers.data(), environ) != 0) id = 0;
    ::posix_spawn_file_actions_destroy(&streams);
    return id;
}

bool wait_for_process(pid_t id) {
    int status = 0;
    while (::waitpid(id, &status, 0) < 0)
        if (errno != EINTR) return false;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string this_program() {
    std::error_code unknown;
    return std::filesystem::read_symlink("/proc/self/exe", unknown).string();
}

}  // namespace claray
