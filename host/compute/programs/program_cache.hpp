// Compiled programs on disk, under $XDG_CACHE_HOME/claray.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/hash.hpp"

namespace claray {

/// Held while a program is looked up, compiled and stored: of several processes or threads that need the same program
/// one compiles it, and the others find its binary. Does not lock if the folder cannot be opened.
class CacheLock {
public:
    /// Locks one key (hexadecimal as from hash128) among those of the lock file with this name in the cache. Calls
    /// `waits` before it waits for another.
    CacheLock(const std::string& file, const std::string& key, const std::function<void()>& waits = {});
    ~CacheLock();
    CacheLock(const CacheLock&) = delete;
    CacheLock& operator=(const CacheLock&) = delete;

private:
    int file_ = -1;
};

/// The stored binary with this full `identity` (the file's name is only its hash). Nothing if there is none, it cannot
/// be read, its checksum or identity differs, or others than this user and root can have written it. The checksum
/// depends on a random key in the folder, so that nobody else makes a file with the right one by accident. A bad file
/// is kept: an I/O error says nothing about the content (drjit-core, src/io.cpp); storing replaces it.
std::optional<std::vector<unsigned char>> load_cached_program(const std::string& identity);

/// Whether the folder has a file for it, which need not be good.
[[nodiscard]] bool has_cached_program(const std::string& identity);

/// Stores a binary by a temporary file and rename, so that readers and other writers never see a part of it. Failure is
/// not an error: the program is compiled again next time. Returns a description of the failure, or nothing. An empty
/// binary only tests whether storing is possible.
std::string store_cached_program(const std::string& identity, const std::vector<unsigned char>& binary);

}  // namespace claray
