// The user's folders for files, by the XDG Base Directory Specification (0.8).
#pragma once

#include <filesystem>
#include <memory>

namespace claray {

/// $CLARAY_CACHE_DIR, $XDG_CACHE_HOME/claray or ~/.cache/claray; empty if none is set. It may not exist yet.
[[nodiscard]] std::filesystem::path cache_folder();

/// The folder for logs: $XDG_STATE_HOME/claray, ~/.local/state/claray, else the cache folder, else the user's folder in
/// the system's temporary folder. Created if necessary; empty if none is writable.
[[nodiscard]] std::filesystem::path log_folder();

/// A writable folder for PoCL's files: `pocl` in the cache folder, else in the user's folder in the system's temporary
/// folder. Empty if there is none.
[[nodiscard]] std::filesystem::path pocl_folder();

/// Creates the folder, for its owner only, if it does not exist. Returns false if it cannot be created or written to.
[[nodiscard]] bool make_writable(const std::filesystem::path& folder);

/// Creates a folder in the system's temporary folder. It is removed with the last copy of the pointer. Throws
/// ErrorKind::user if it cannot be created.
[[nodiscard]] std::shared_ptr<const std::filesystem::path> scratch_folder();

}  // namespace claray
