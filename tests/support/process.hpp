// Running programs from a test: output, exit code, signals.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace claray::test {

/// How a program ended.
struct ProcessResult {
    int exit_code = -1;  ///< 128 + signal where a signal ended it
    std::string output;  ///< standard output
    std::string errors;  ///< standard error
};

/// Looks at a condition until it holds, and returns whether it did. The looks are counted, not the seconds: on a busy
/// machine a look takes longer, too. On an idle one they take ten minutes.
[[nodiscard]] bool becomes_true(const std::function<bool()>& condition);

using Variables = std::map<std::string, std::string>;

/// A running program with its output in files of its own folder.
class Process {
public:
    /// `environment` is added to the test's own. Throws std::runtime_error if the program cannot be started.
    explicit Process(const std::vector<std::string>& command, const Variables& environment = {});
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// What it has written to standard error so far.
    [[nodiscard]] std::string errors_so_far() const;
    void send(int signal_number) const;
    /// Returns whether it handles a signal now, by /proc.
    [[nodiscard]] bool handles(int signal_number) const;
    /// The same for what the process does: returns false if the process ends first.
    [[nodiscard]] bool brings_about(const std::function<bool()>& condition) const;
    /// Blocks until it ends.
    [[nodiscard]] ProcessResult wait();

private:
    std::filesystem::path folder_;
    pid_t id_ = 0;
    bool running_ = false;
};

/// Starts a program and waits for its end.
[[nodiscard]] ProcessResult run_process(const std::vector<std::string>& command, const Variables& environment = {});

/// The running test program itself.
[[nodiscard]] std::string this_program();

/// A new empty folder, removed with all its content at the end of the scope.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    /// Writes a file and returns its path. One that is there goes first: ext4 syncs a file that is cut to nothing and
    /// written anew, which takes milliseconds.
    [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& content) const;
    [[nodiscard]] std::size_t entries() const;

private:
    std::filesystem::path path_;
};

/// Sets an environment variable of this process until the end of the scope.
class ScopedEnvironment {
public:
    ScopedEnvironment(std::string name, const std::string& value);
    ~ScopedEnvironment();
    ScopedEnvironment(const ScopedEnvironment&) = delete;
    ScopedEnvironment& operator=(const ScopedEnvironment&) = delete;

private:
    std::string name_, before_;
    bool was_set_;
};

[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace claray::test
