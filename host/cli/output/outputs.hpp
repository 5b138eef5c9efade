// The files that a command writes: checked before time is spent, and written one after the other whatever becomes of
// one.
#pragma once

#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "claray/error.hpp"

namespace claray::cli {

/// A file, and what names it on the command line. Without a path it is not asked for.
struct NamedFile {
    std::string option;
    std::filesystem::path path;
};

/// Throws ErrorKind::usage where two outputs, or an output and an input, are one file by whatever spelling and links,
/// and what writing any of the outputs would throw.
void check_outputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs = {});

/// Writes what can be written, and then throws the first error.
class Writes {
public:
    template <class Write>
    void attempt(Write&& write) {
        try {
            write();
        } catch (const Error&) {
            if (!first_) first_ = std::current_exception();
        }
    }
    void finish() const {
        if (first_) std::rethrow_exception(first_);
    }

private:
    std::exception_ptr first_;
};

}  // namespace claray::cli
