// The files that a command writes: all are checked first; an error in one does not stop the others from being written.
#pragma once

#include <exception>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "claray/error.hpp"

namespace claray::cli {

/// A file and its option on the command line. An empty path: the option is not given.
struct NamedFile {
    std::string option;
    std::filesystem::path path;
};

/// The file that "-" stands for.
[[nodiscard]] inline std::filesystem::path named_file(const std::filesystem::path& path) {
    return path == "-" ? std::filesystem::path("/dev/stdout") : path;
}

/// Throws ErrorKind::usage if two outputs, or an output and an input, are the same file, also by another spelling or by
/// links. Throws the errors that writing the outputs would throw.
void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs = {});

/// Attempts all writes, from any thread, then throws the first error.
class Writes {
public:
    /// Returns whether this one succeeded.
    template <class Write>
    bool attempt(Write&& write) {
        try {
            write();
            return true;
        } catch (const Error&) {
            const std::lock_guard lock(mutex_);
            if (!first_) first_ = std::current_exception();
            return false;
        }
    }
    void finish() const {
        if (first_) std::rethrow_exception(first_);
    }

private:
    std::mutex mutex_;
    std::exception_ptr first_;
};

}  // namespace claray::cli
