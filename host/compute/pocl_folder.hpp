// The folder in which PoCL keeps its files.
#pragma once

namespace claray {

/// Gives PoCL an empty folder of this process alone, before the first call of OpenCL, and removes it when the process
/// ends. PoCL aborts if it cannot write there, if a blank is in the path (it passes paths to its compiler unquoted), on
/// files that another process left half written, and on folders that another process removes meanwhile (PoCL 3.1).
/// claray's own cache keeps the compiled programs. The folder is made in $POCL_CACHE_DIR, in PoCL's default folder, in
/// claray's cache or in a temporary folder: in the first one that serves and whose disk is not full. Returns false if
/// there is none. Throws ErrorKind::user if $POCL_CACHE_DIR is not writable.
[[nodiscard]] bool give_pocl_a_folder();

/// Whether the disk of that folder has become full: PoCL's compiler then fails for reasons that it does not tell.
[[nodiscard]] bool pocl_disk_is_full();

}  // namespace claray
