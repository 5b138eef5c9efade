#include "host/compute/programs/program_cache.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <new>
#include <utility>

#include "host/base/folders.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;

/// The beginning of a file; the identity and the binary follow. docs/formats.md describes the bytes.
struct ProgramHeader {
    std::array<unsigned char, 8> magic;
    Digest sum;  // of the folder's key and all following bytes
    std::uint32_t identity_bytes;
    std::uint32_t binary_bytes;
};
static_assert(sizeof(ProgramHeader) == 32);
constexpr std::array<unsigned char, 8> program_magic = {'C', 'L', 'R', 'P', 3, 0, 0, 0};
constexpr std::size_t before_sum = offsetof(ProgramHeader, identity_bytes);

/// A secret of the folder. A file whose sum is right was written by claray: drivers crash on binaries that others made
/// or changed, and a changed instruction makes a wrong image.
using Key = std::array<unsigned char, 32>;

Digest sum_of(const Key& key, const ProgramHeader& header, const std::string& identity,
              const std::vector<unsigned char>& binary) {
    Hasher hasher;
    hasher.add(key.data(), key.size());
    hasher.add(reinterpret_cast<const unsigned char*>(&header) + before_sum, sizeof header - before_sum);
    hasher.add(identity.data(), identity.size());
    hasher.add(binary.data(), binary.size());
    return hasher.digest();
}

constexpr const char* key_name = "programs.key";

fs::path file_of(const fs::path& folder, const std::string& identity) { return folder / (hash128(identity) + ".bin"); }

/// A descriptor that is closed at the end of the scope; negative if there is none.
class Descriptor {
public:
    explicit Descriptor(int file) : file_(file) {}
    ~Descriptor() {
        if (file_ >= 0) ::close(file_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int get() const { return file_; }
    [[nodiscard]] bool read(void* data, std::size_t bytes) const {
        for (std::size_t done = 0; done < bytes;) {
            const ssize_t count = ::read(file_, static_cast<char*>(data) + done, bytes - done);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return false;
            done += std::size_t(count);
        }
        return true;
    }

private:
    int file_;
};

/// Machine code is loaded only from a file that only this user or root can have written. The folder's permissions do
/// not matter then: others can at most add their own files or rename this user's files.
bool is_own(const struct stat& status) {
    return S_ISREG(status.st_mode) && (status.st_uid == ::geteuid() || status.st_uid == 0) &&
           (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

/// Of the folder, or nothing if it has none that only this user or root can have written.
std::optional<Key> read_key(const fs::path& folder) {
    const Descriptor file(::open((folder / key_name).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat status = {};
    Key key;
    const bool is_right = file.get() >= 0 && ::fstat(file.get(), &status) == 0 && is_own(status) &&
                          std::size_t(status.st_size) == key.size() && file.read(key.data(), key.size());
    return is_right ? std::optional(key) : std::nullopt;
}

/// The binary of an open file, or nothing. Allocates at most as much memory as the file has bytes.
std::optional<std::vector<unsigned char>> read_binary(const Key& key, const Descriptor& file,
                                                      const std::string& identity) {
    struct stat status = {};
    ProgramHeader header;
    if (::fstat(file.get(), &status) != 0 || !is_own(status) || !file.read(&header, sizeof header)) return {};
    const std::uint64_t bytes = sizeof header + identity.size() + std::uint64_t(header.binary_bytes);
    if (header.magic != program_magic || header.identity_bytes != identity.size() || header.binary_bytes == 0 ||
        std::uint64_t(status.st_size) != bytes)
        return {};
    std::string stored(identity.size(), '\0');
    if (!file.read(stored.data(), stored.size()) || stored != identity) return {};
    std::vector<unsigned char> binary(header.binary_bytes);
    if (!file.read(binary.data(), binary.size())) return {};
    return sum_of(key, header, stored, binary) == header.sum ? std::optional(std::move(binary)) : std::nullopt;
}

using Bytes = std::pair<const void*, std::size_t>;

/// Writes a new file that only this user may write; replaces a file of that name, which no running process uses.
/// Returns errno.
int write_new(const fs::path& path, std::initializer_list<Bytes> parts) {
    ::unlink(path.c_str());
    const Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (file.get() < 0) return errno;
    for (const auto& [data, bytes] : parts)
        for (std::size_t done = 0; done < bytes;) {
            const ssize_t count = ::write(file.get(), static_cast<const char*>(data) + done, bytes - done);
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return errno != 0 ? errno : EIO;
            done += std::size_t(count);
        }
    return 0;
}

fs::path temporary_for(const fs::path& file) {
    static std::atomic<unsigned> serial{0};
    return file.string() + "." + std::to_string(::getpid()) + "." + std::to_string(serial++) + ".tmp";
}

/// Makes one if there is none. Of several processes that do so at once one succeeds. Returns errno.
int make_key(const fs::path& folder) {
    if (read_key(folder)) return 0;
    Key key;
    if (::getentropy(key.data(), key.size()) != 0) return errno;
    const fs::path file = folder / key_name, temporary = temporary_for(file);
    int error = write_new(temporary, {{key.data(), key.size()}});
    if (error == 0 && !read_key(folder)) ::unlink(file.c_str());  // it is damaged or of others
    if (error == 0 && ::link(temporary.c_str(), file.c_str()) != 0 && errno != EEXIST) error = errno;
    ::unlink(temporary.c_str());
    return error;
}

}  // namespace

/// The file is empty: each key is an offset of 60 bits in it (two keys with the same bits wait for each other, which
/// does no harm). Such locks belong to the open file, not to the process, so that threads wait for each other, too.
CacheLock::CacheLock(const std::string& file, const std::string& key, const std::function<void()>& waits) {
    const fs::path folder = cache_folder();
    if (folder.empty()) return;
    std::error_code ignored;
    fs::create_directories(folder, ignored);
    file_ = ::open((folder / (file + ".lock")).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file_ < 0) return;
    struct flock range = {};
    range.l_type = F_WRLCK, range.l_whence = SEEK_SET;
    range.l_start = std::stoll(key.substr(0, 15), nullptr, 16), range.l_len = 1;
    if (::fcntl(file_, F_OFD_SETLK, &range) == 0) return;
    if (waits) waits();
    while (::fcntl(file_, F_OFD_SETLKW, &range) != 0 && errno == EINTR) {
    }
}

CacheLock::~CacheLock() {
    if (file_ >= 0) ::close(file_);  // this unlocks
}

std::optional<std::vector<unsigned char>> load_cached_program(const std::string& identity) try {
    const fs::path folder = cache_folder();
    const std::optional<Key> key = folder.empty() ? std::nullopt : read_key(folder);
    if (!key) return {};
    // Without O_NONBLOCK the call would block on a pipe of that name.
    const Descriptor file(::open(file_of(folder, identity).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.get() < 0) return {};
    return read_binary(*key, file, identity);
} catch (const std::bad_alloc&) {
    return {};
}

bool has_cached_program(const std::string& identity) {
    const fs::path folder = cache_folder();
    std::error_code error;
    return !folder.empty() && fs::exists(file_of(folder, identity), error);
}

std::string store_cached_program(const std::string& identity, const std::vector<unsigned char>& binary) {
    const fs::path folder = cache_folder();
    if (folder.empty()) return "CLARAY_CACHE_DIR, XDG_CACHE_HOME and HOME are not set";
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return "cannot create the folder '" + folder.string() + "': " + error.message();
    if (identity.size() > UINT32_MAX || binary.size() > UINT32_MAX) return "the binary is larger than 4 GiB";
    const auto failed = [&](const std::error_code& why) {
        return "cannot write to '" + folder.string() + "': " + why.message();
    };
    if (const int why = make_key(folder); why != 0) return failed({why, std::generic_category()});
    const std::optional<Key> key = read_key(folder);
    if (!key) return "cannot read the key in '" + folder.string() + "'";
    ProgramHeader header = {program_magic, {}, std::uint32_t(identity.size()), std::uint32_t(binary.size())};
    header.sum = sum_of(*key, header, identity, binary);
    const fs::path file = file_of(folder, identity), temporary = temporary_for(file);
    const int why = write_new(
        temporary, {{&header, sizeof header}, {identity.data(), identity.size()}, {binary.data(), binary.size()}});
    if (why != 0)
        error = std::error_code(why, std::generic_category());
    else if (!binary.empty())
        fs::rename(temporary, file, error);
    if (!error && !binary.empty()) return {};
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return error ? failed(error) : std::string();
}

}  // namespace claray
