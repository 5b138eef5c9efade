// Compiled programs on disk, under $XDG_CACHE_HOME/claray.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace claray {

/// 128 bits as 32 hexadecimal digits (XXH3).
std::string hash128(const std::string& data);

/// The stored binary of a key, or nothing where there is none, it cannot be read, or its checksum is wrong. A bad file
/// is left alone: an I/O error says nothing about the content (drjit-core, src/io.cpp); storing replaces it.
std::optional<std::vector<unsigned char>> load_cached_program(const std::string& key);

/// Stores a binary by temporary file and rename, so that readers and other writers never see half of one. Failure to
/// store is not an error: the program is compiled again next time.
void store_cached_program(const std::string& key, const std::vector<unsigned char>& binary);

}  // namespace claray
