#include "host/base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <utility>

#include "claray/error.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& action, const fs::path& path, int error) {
    const char* remedy = "check the path";
    if (error == ENOSPC || error == EDQUOT || error == EFBIG) remedy = "free some space or choose another folder";
    if (error == EACCES || error == EPERM || error == EROFS) remedy = "choose a writable folder";
    if (error == ENOENT || error == ENOTDIR) remedy = "create the folder first";
    if (error == EISDIR) remedy = "give the name of a file in the folder";
    throw Error(ErrorKind::user, action + " '" + path.string() + "': " + std::strerror(error), remedy);
}

/// Returns N if a path means this process's descriptor N, as /dev/stdout and /dev/fd/N do; else -1.
int descriptor_of(const fs::path& path) {
    std::error_code error;
    const fs::path descriptors = fs::canonical("/proc/self/fd", error);
    if (error || fs::canonical(path.parent_path(), error) != descriptors || error) return -1;
    const std::string name = path.filename().string();
    int number = -1;
    const auto [end, fault] = std::from_chars(name.data(), name.data() + name.size(), number);
    return fault == std::errc() && end == name.data() + name.size() ? number : -1;
}

/// Returns whether this descriptor is open for writing.
bool is_writable(int descriptor) {
    const int flags = ::fcntl(descriptor, F_GETFL);
    return flags >= 0 && (flags & O_ACCMODE) != O_RDONLY;
}

/// Devices and pipes (/dev/null, /dev/stdout) must be written to, never replaced by a file.
bool is_special(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// A new file's name is on disk only after its folder is synced. Not every file system can sync a folder.
void sync_folder_of(const fs::path& path) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

void refuse_folder(const fs::path& path) {
    std::error_code error;
    if (path.empty() || !path.has_filename() || fs::is_directory(path, error)) fail("cannot write", path, EISDIR);
}

[[noreturn]] void refuse_to_read(const fs::path& path, const std::string& why, const std::string& remedy) {
    throw Error(ErrorKind::user, "cannot read '" + path.string() + "': " + why, remedy);
}

/// At its end.
std::ifstream opened(const fs::path& path, const std::string& remedy) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) refuse_to_read(path, error ? error.message() : "No such file or directory", remedy);
    if (!fs::is_regular_file(status)) refuse_to_read(path, "not a regular file", remedy);
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) refuse_to_read(path, std::strerror(errno), remedy);
    return file;
}

}  // namespace

void check_file_readable(const fs::path& path, const std::string& remedy) { static_cast<void>(opened(path, remedy)); }

std::string read_file(const fs::path& path, const std::string& remedy) {
    std::ifstream file = opened(path, remedy);
    std::string bytes(std::size_t(file.tellg()), '\0');
    file.seekg(0).read(bytes.data(), std::streamsize(bytes.size()));
    if (!file) refuse_to_read(path, "read error", remedy);
    return bytes;
}

fs::path write_target(const fs::path& path) {
    fs::path target = path;
    std::error_code error;
    constexpr int most_links = 40;  // the kernel's limit
    for (int links = 0; descriptor_of(target) < 0 && fs::is_symlink(target, error); ++links) {
        if (links == most_links) fail("cannot write", path, ELOOP);
        const fs::path next = fs::read_symlink(target, error);
        if (error) fail("cannot write", path, error.value());
        target = next.is_absolute() ? next : target.parent_path() / next;
    }
    return target;
}

NewFile::NewFile(const fs::path& path) : path_(path) {
    refuse_folder(path);
    target_ = write_target(path);
    if (const int descriptor = descriptor_of(target_); descriptor >= 0) {
        std::fflush(nullptr);  // flushes earlier output first
        file_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
    } else if (is_special(target_)) {
        file_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    } else {
        create();
    }
    if (file_ < 0) fail("cannot write", path, errno);
}

NewFile::~NewFile() {
    if (file_ >= 0) ::close(file_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

// A crashed process with the same number may have left a file of this name.
void NewFile::create() {
    static std::atomic<unsigned> serial{0};
    for (int attempt = 0; attempt < 100; ++attempt) {
        fs::path name = target_;
        name += "." + std::to_string(::getpid()) + "." + std::to_string(serial++) + ".tmp";
        file_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file_ >= 0) temporary_ = name;
        if (file_ >= 0 || errno != EEXIST) return;
    }
}

void NewFile::write(const void* data, std::size_t bytes) {
    for (std::size_t done = 0; done < bytes;) {
        const ssize_t count = ::write(file_, static_cast<const char*>(data) + done, bytes - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) fail("cannot write", path_, errno);
        done += std::size_t(count);
    }
}

void NewFile::commit() {
    if (!temporary_.empty() && ::fsync(file_) != 0) fail("cannot write", path_, errno);
    // Some file systems report a failed write only now.
    if (::close(std::exchange(file_, -1)) != 0) fail("cannot write", path_, errno);
    if (temporary_.empty()) return;
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot write", path_, errno);
    temporary_.clear();
    sync_folder_of(target_);
}

void write_file(const fs::path& path, const std::string& bytes) {
    NewFile file(path);
    file.write(bytes.data(), bytes.size());
    file.commit();
}

void make_folder(const fs::path& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error || !fs::is_directory(path, error))
        throw Error(
            ErrorKind::user,
            "cannot create the folder '" + path.string() + "': " + std::strerror(error ? error.value() : ENOTDIR),
            "choose another folder");
}

void check_file_writable(const fs::path& path) {
    refuse_folder(path);
    const fs::path target = write_target(path);
    if (const int descriptor = descriptor_of(target); descriptor >= 0) {
        if (!is_writable(descriptor)) fail("cannot write", path, EBADF);
    } else if (is_special(target)) {  // opening and closing a pipe signals its reader that all is written
        if (::access(target.c_str(), W_OK) != 0) fail("cannot write", path, errno);
    } else {
        const NewFile file(path);
    }
}

bool is_replaced(const fs::path& path) {
    const fs::path target = write_target(path);
    return !is_special(target) && descriptor_of(target) < 0;
}

bool are_one_file(const fs::path& a, const fs::path& b) {
    const fs::path first = write_target(a), second = write_target(b);
    std::error_code error;
    if (fs::is_character_file(first, error)) return false;  // /dev/null accepts everything
    const auto in_place = [](const fs::path& path) { return is_special(path) || descriptor_of(path) >= 0; };
    if (in_place(first) || in_place(second)) return fs::equivalent(first, second, error) && !error;
    const auto folder = [](const fs::path& path) {
        return path.has_parent_path() ? path.parent_path() : fs::path(".");
    };
    return first.filename() == second.filename() && fs::equivalent(folder(first), folder(second), error) && !error;
}

}  // namespace claray
