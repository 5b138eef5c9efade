// Compiled programs on disk, under $XDG_CACHE_HOME/claray.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/compute/hash.hpp"

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

/// The stored binary of a key, or nothing where there is none, it cannot be read, or its checksum is wrong. A bad file
/// is left alone: an I/O error says nothing about the content (drjit-core, src/io.cpp); storing replaces it.
std::optional<std::vector<unsigned char>> load_cached_program(const std::string& key);

/// Stores a binary by temporary file and rename, so that readers and other writers never see half of one. Failure to
/// store is not an error: the program is compiled again next time. Returns what failed, in words, or nothing. An empty
/// binary only tries whether it can.
std::string store_cached_program(const std::string& key, const std::vector<unsigned char>& binary);

}  // namespace claray
