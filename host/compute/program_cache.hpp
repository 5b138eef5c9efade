// Compiled programs on disk, under $XDG_CACHE_HOME/claray.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/base/hash.hpp"

namespace claray {

/// Held while something is looked up, compiled and stored: of many processes or threads that want the same at once one
/// compiles, the others then find its binary. Without a folder that can be opened nothing is locked.
class CacheLock {
public:
    /// Of one key, hexadecimal as from hash128, among those that are locked by a file of this name in the cache; of all
    /// of them where there is none.
    explicit CacheLock(const std::string& file, const std::string& key = {});
    ~CacheLock();
    CacheLock(const CacheLock&) = delete;
    CacheLock& operator=(const CacheLock&) = delete;

private:
    int file_ = -1;
};

/// The stored binary of what `identity` says in full (the file's name is only its hash), or nothing where there is
/// none, it cannot be read, its checksum or the identity in it is another one, or others than this user and root can
/// have written it. A bad file is left alone: an I/O error says nothing about the content (drjit-core, src/io.cpp);
/// storing replaces it.
std::optional<std::vector<unsigned char>> load_cached_program(const std::string& identity);

/// Stores a binary by temporary file and rename, so that readers and other writers never see half of one. Failure to
/// store is not an error: the program is compiled again next time. Returns what failed, in words, or nothing. An empty
/// binary only tries whether it can.
std::string store_cached_program(const std::string& identity, const std::vector<unsigned char>& binary);

}  // namespace claray
