// Folders of the user's in which files are kept, as the XDG Base Directory Specification (0.8) has them.
#pragma once

#include <filesystem>

namespace claray {

/// $CLARAY_CACHE_DIR, $XDG_CACHE_HOME/claray or ~/.cache/claray; empty where none is set. It may not be there yet.
[[nodiscard]] std::filesystem::path cache_folder();

/// Where logs go: $XDG_STATE_HOME/claray, ~/.local/state/claray, else the cache folder, else a folder of the user's in
/// the system's temporary one. It is made where need be; empty where none can be written to.
[[nodiscard]] std::filesystem::path log_folder();

/// A folder for PoCL's files, to which this process can write: `pocl` in the cache folder, else in a folder of the
/// user's in the system's temporary one. Empty where there is none.
[[nodiscard]] std::filesystem::path pocl_folder();

/// Makes the folder, for its owner only, where it is not there yet. False where it can't be made or written to.
[[nodiscard]] bool make_writable(const std::filesystem::path& folder);

}  // namespace claray
