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

/// `claray-UID` in a temporary folder. Because others can write there, it must be a folder (not a link) that belongs to
/// this user and is closed to others; else it gets a name that nobody knew. Empty if it cannot be made.
[[nodiscard]] std::filesystem::path user_folder_in(const std::filesystem::path& temporary);

/// Creates the folder, for its owner only, if it does not exist. Returns false if it cannot be created or written to.
[[nodiscard]] bool make_writable(const std::filesystem::path& folder);

/// Creates a folder in the system's temporary folder. It is removed with the last copy of the pointer. Throws
/// ErrorKind::user if it cannot be created.
[[nodiscard]] std::shared_ptr<const std::filesystem::path> scratch_folder();

}  // namespace claray
