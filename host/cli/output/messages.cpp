#include "host/cli/output/messages.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "host/base/folders.hpp"
#include "host/base/message.hpp"

namespace claray::cli {
namespace {

namespace fs = std::filesystem;

/// Creates a file with an unpredictable name, readable by its owner only (mkstemps: O_EXCL, 0600). Returns an empty
/// path on failure.
fs::path written_log(const std::string& text) {
    const fs::path folder = log_folder();
    if (folder.empty()) return {};
    std::string name = (folder / "claray-XXXXXX.log").string();
    const int file = ::mkstemps(name.data(), 4);
    if (file < 0) return {};
    const bool written = ::write(file, text.data(), text.size()) == ssize_t(text.size());
    if (::close(file) == 0 && written) return name;
    ::unlink(name.c_str());
    return {};
}

}  // namespace

void print_warning(const std::string& text) { std::fprintf(stderr, "claray: warning: %s\n", one_line(text).c_str()); }

int print_error(ErrorKind kind, const std::string& text) {
    const std::size_t end = text.find('\n');
    std::string line = text.substr(0, end), place;
    if (end != std::string::npos) {
        const fs::path log = written_log(many_lines(text) + '\n');
        place = log.empty() ? "; the log could not be written" : "; the log is in " + one_line(log.string(), 160);
    }
    line = one_line(line, longest_message - place.size()) + place;
    std::fprintf(stderr, "claray: error: %s\n", line.c_str());
    return int(kind);
}

}  // namespace claray::cli
