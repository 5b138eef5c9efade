#include "host/io/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "claray/error.hpp"
#include "claray/io.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& action, const fs::path& path, int error) {
    const char* remedy = "check the path";
    if (error == ENOSPC || error == EDQUOT || error == EFBIG) remedy = "free some space or choose another folder";
    if (error == EACCES || error == EPERM || error == EROFS) remedy = "choose a folder that you may write to";
    if (error == ENOENT || error == ENOTDIR) remedy = "create the folder first";
    if (error == EISDIR) remedy = "name a file in the folder";
    throw Error(ErrorKind::user, action + " '" + path.string() + "': " + std::strerror(error), remedy);
}

/// An open file descriptor. Cleaning up keeps errno, which says why there is something to clean up.
class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        const int error = errno;
        if (fd_ >= 0) ::close(fd_);
        errno = error;
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    [[nodiscard]] bool open() const { return fd_ >= 0; }
    [[nodiscard]] int get() const { return fd_; }
    /// Closes now: some file systems report a failed write only here.
    [[nodiscard]] bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

private:
    int fd_;
};

/// A new file beside `target`, open for writing, that is removed again unless it was renamed.
class Temporary {
public:
    explicit Temporary(const fs::path& target) : file_(create(target, path_)) {}
    ~Temporary() {
        const int error = errno;
        if (file_.open() || written_) ::unlink(path_.c_str());
        errno = error;
    }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;

    [[nodiscard]] const Descriptor& file() const { return file_; }
    /// Makes it safe on disk and gives it its name; false and errno where that failed.
    [[nodiscard]] bool commit(const fs::path& target) {
        written_ = true;
        if (::fsync(file_.get()) != 0 || !file_.close() || ::rename(path_.c_str(), target.c_str()) != 0) return false;
        written_ = false;
        return true;
    }

private:
    // A name may be taken by what a crashed process of the same number left behind.
    static int create(const fs::path& target, fs::path& path) {
        static std::atomic<unsigned> serial{0};
        for (int attempt = 0;; ++attempt) {
            path = target;
            path += "." + std::to_string(::getpid()) + "." + std::to_string(serial++) + ".tmp";
            const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (fd >= 0 || errno != EEXIST || attempt == 100) return fd;
        }
    }

    fs::path path_;
    Descriptor file_;
    bool written_ = false;
};

bool write_all(int fd, const std::string& bytes) {
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t count = ::write(fd, bytes.data() + done, bytes.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        done += std::size_t(count);
    }
    return true;
}

/// Links are followed, so that renaming replaces what they point to and not the link.
fs::path resolve(const fs::path& path) {
    std::error_code error;
    const fs::path target = fs::is_symlink(path, error) ? fs::canonical(path, error) : path;
    return error || target.empty() ? path : target;
}

/// Devices and pipes (/dev/null, /dev/stdout) must be written to, never replaced by a file.
bool is_special(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// The name of a new file is safe on disk only after its folder is. Not every file system can sync a folder.
void sync_folder_of(const fs::path& path) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (descriptor.open()) ::fsync(descriptor.get());
}

bool write_in_place(const fs::path& path, const std::string& bytes) {
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    return file.open() && write_all(file.get(), bytes) && file.close();
}

bool write_anew(const fs::path& path, const std::string& bytes) {
    Temporary temporary(path);
    if (!temporary.file().open() || !write_all(temporary.file().get(), bytes) || !temporary.commit(path)) return false;
    sync_folder_of(path);
    return true;
}

void refuse_folder(const fs::path& path) {
    std::error_code error;
    if (path.empty() || !path.has_filename() || fs::is_directory(path, error)) fail("cannot write", path, EISDIR);
}

}  // namespace

std::string read_file(const fs::path& path, const std::string& remedy) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    const auto refuse = [&](const std::string& why) {
        throw Error(ErrorKind::user, "cannot read '" + path.string() + "': " + why, remedy);
    };
    if (!fs::exists(status)) refuse(error ? error.message() : "No such file or directory");
    if (!fs::is_regular_file(status)) refuse("not a regular file");
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) refuse(std::strerror(errno));
    std::string bytes(std::size_t(file.tellg()), '\0');
    file.seekg(0).read(bytes.data(), std::streamsize(bytes.size()));
    if (!file) refuse("read error");
    return bytes;
}

void write_file(const fs::path& path, const std::string& bytes) {
    refuse_folder(path);
    const fs::path target = resolve(path);
    errno = 0;
    if (!(is_special(target) ? write_in_place(target, bytes) : write_anew(target, bytes)))
        fail("cannot write", path, errno);
}

void check_file_writable(const fs::path& path) {
    refuse_folder(path);
    const fs::path target = resolve(path);
    const bool writable = is_special(target) ? Descriptor(::open(target.c_str(), O_WRONLY | O_CLOEXEC)).open()
                                             : Temporary(target).file().open();
    if (!writable) fail("cannot write", path, errno);
}

}  // namespace claray
