// Files that a page sends: scenes with their textures.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

namespace claray::view {

using Folder = std::shared_ptr<const std::filesystem::path>;

/// The files of one drop lie in one temporary folder, which is removed when nobody uses it any more. All functions may
/// be called by any thread, and throw ErrorKind::user with one line.
class Uploads {
public:
    /// `most`: bytes of one drop.
    explicit Uploads(std::size_t most) : most_(most) {}

    /// The files that follow are those of a new drop.
    void begin();
    /// Appends bytes to a file: `at` is its size so far, and 0 begins it. The name may have folders, which lie below
    /// that of the drop.
    void add(const std::string& name, std::size_t at, const std::string& bytes);
    /// The folder of the drop, which has this file.
    [[nodiscard]] Folder folder_with(const std::string& name) const;

private:
    [[nodiscard]] std::filesystem::path path_of(const std::string& name) const;

    mutable std::mutex mutex_;
    Folder folder_;
    std::size_t most_, used_ = 0;
};

}  // namespace claray::view
