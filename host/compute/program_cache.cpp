#include "host/compute/program_cache.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace claray {
namespace {

namespace fs = std::filesystem;

// "CLRP", format version, then the XXH3-128 of the binary that follows.
constexpr std::array<unsigned char, 8> magic = {'C', 'L', 'R', 'P', 1, 0, 0, 0};
constexpr std::size_t header_bytes = magic.size() + sizeof(Digest);

fs::path cache_folder() {
    if (const char* folder = std::getenv("CLARAY_CACHE_DIR"); folder != nullptr && *folder) return folder;
    if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg != nullptr && *xdg) return fs::path(xdg) / "claray";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home) return fs::path(home) / ".cache" / "claray";
    return {};
}

}  // namespace

/// The file has no bytes: each key is a place in it, told by 60 bits (two keys that share them wait for each other,
/// which does no harm), and a lock of 0 bytes is of all from there on. Such locks are of the open file, not of the
/// process, so that threads wait for each other, too.
CacheLock::CacheLock(const std::string& file, const std::string& key) {
    const fs::path folder = cache_folder();
    if (folder.empty()) return;
    std::error_code ignored;
    fs::create_directories(folder, ignored);
    file_ = ::open((folder / (file + ".lock")).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0) return;
    struct flock range = {};
    range.l_type = F_WRLCK, range.l_whence = SEEK_SET;
    if (!key.empty()) range.l_start = std::stoll(key.substr(0, 15), nullptr, 16), range.l_len = 1;
    while (::fcntl(file_, F_OFD_SETLKW, &range) != 0 && errno == EINTR) {
    }
}

CacheLock::~CacheLock() {
    if (file_ >= 0) ::close(file_);  // which unlocks
}

std::optional<std::vector<unsigned char>> load_cached_program(const std::string& key) {
    const fs::path folder = cache_folder();
    if (folder.empty()) return {};
    std::ifstream file(folder / (key + ".bin"), std::ios::binary);
    if (!file) return {};
    std::vector<unsigned char> data((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (data.size() <= header_bytes || std::memcmp(data.data(), magic.data(), magic.size()) != 0) return {};
    const Digest sum = digest_of(data.data() + header_bytes, data.size() - header_bytes);
    if (std::memcmp(data.data() + magic.size(), sum.data(), sum.size()) != 0) return {};
    data.erase(data.begin(), data.begin() + header_bytes);
    return data;
}

std::string store_cached_program(const std::string& key, const std::vector<unsigned char>& binary) {
    const fs::path folder = cache_folder();
    if (folder.empty()) return "neither CLARAY_CACHE_DIR, XDG_CACHE_HOME nor HOME is set";
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return "cannot make the folder '" + folder.string() + "': " + error.message();
    static std::atomic<unsigned> serial{0};
    const fs::path temporary =
        folder / (key + "." + std::to_string(::getpid()) + "." + std::to_string(serial++) + ".tmp");
    bool written = false;
    errno = 0;
    {
        std::ofstream file(temporary, std::ios::binary);
        const Digest sum = digest_of(binary.data(), binary.size());
        file.write(reinterpret_cast<const char*>(magic.data()), std::streamsize(magic.size()));
        file.write(reinterpret_cast<const char*>(sum.data()), sum.size());
        file.write(reinterpret_cast<const char*>(binary.data()), std::streamsize(binary.size()));
        written = bool(file.flush());
    }
    if (!written)
        error = std::error_code(errno != 0 ? errno : EIO, std::generic_category());
    else if (!binary.empty())
        fs::rename(temporary, folder / (key + ".bin"), error);
    if (!error && !binary.empty()) return {};
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return error ? "cannot write to '" + folder.string() + "': " + error.message() : std::string();
}

}  // namespace claray
