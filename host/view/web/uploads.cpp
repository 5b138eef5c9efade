#include "host/view/web/uploads.hpp"

#include <algorithm>
#include <fstream>

#include "claray/error.hpp"
#include "host/base/folders.hpp"
#include "host/base/format.hpp"

namespace claray::view {
namespace {

constexpr std::size_t longest_name = 255;  // bytes, as files of Linux

[[noreturn]] void refuse_file(const std::string& name, const std::string& why, const std::string& remedy) {
    throw Error(ErrorKind::user, "'" + name + "': " + why, remedy);
}

}  // namespace

void Uploads::begin() {
    const std::lock_guard lock(mutex_);
    folder_ = scratch_folder(), used_ = 0;
}

std::filesystem::path Uploads::path_of(const std::string& name) const {
    if (!folder_) refuse_file(name, "no drop has begun", "send POST /drop first");
    const std::filesystem::path path = name;
    const bool plain = std::all_of(path.begin(), path.end(), [](const std::filesystem::path& part) {
        return !part.empty() && part != "." && part != ".." && part.string().size() <= longest_name;
    });
    const bool readable =
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return c >= ' ' && c != 127 && c != '\\'; });
    if (name.empty() || path.is_absolute() || !plain || !readable)
        refuse_file(readable ? name : "the file", "a file cannot have this name", "give a name without . and ..");
    return *folder_ / path;
}

void Uploads::add(const std::string& name, std::size_t at, const std::string& bytes) {
    const std::lock_guard lock(mutex_);
    const std::filesystem::path path = path_of(name);
    if (used_ + bytes.size() > most_)
        refuse_file(name, printed("more than %zu MB in one drop", most_ >> 20),
                    "start claray view with the file instead");
    std::error_code error;
    std::filesystem::create_directories(path.parent_path(), error);
    const std::size_t before = at == 0 ? 0 : std::size_t(std::filesystem::file_size(path, error));
    if (error || before != at) refuse_file(name, "a piece is missing", "send it again from its begin");
    std::ofstream file(path, at == 0 ? std::ios::binary : std::ios::binary | std::ios::app);
    file.write(bytes.data(), std::streamsize(bytes.size()));
    file.close();
    if (!file) refuse_file(name, "it cannot be written", "make room in the folder for temporary files");
    used_ += bytes.size();
}

Folder Uploads::folder_with(const std::string& name) const {
    const std::lock_guard lock(mutex_);
    if (!std::filesystem::is_regular_file(path_of(name))) refuse_file(name, "it was not sent", "send it first");
    return folder_;
}

}  // namespace claray::view
