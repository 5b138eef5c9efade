// Forged files: changed on purpose, in any number of places, and with checksums that are right, so that what is behind
// the checksums is tried. The same number gives the same file, always.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace claray::test {

using FileBytes = std::vector<std::uint8_t>;

/// Changes 1 to 4 places of a file: flips bits, sets words of 4 or 8 bytes to values at the edges of what they hold or
/// to words from elsewhere, exchanges or repeats blocks, and sometimes cuts or lengthens the file. Half of the changes
/// are within the first `header` bytes. `number` chooses; checksums are not put right.
[[nodiscard]] FileBytes forged(std::span<const std::uint8_t> good, std::uint32_t number, std::size_t header);

/// Writes the canonical XXH3-128 of bytes [begin, end) behind them; does nothing where the file is too short.
void mend_digest(FileBytes& file, std::size_t begin, std::size_t end);

/// For files whose header ends with a digest of what is before it, and which end with a digest of what is between.
void mend_digests(FileBytes& file, std::size_t header);

/// Puts right what a saved tree says of itself: its size and its checksums.
void mend_tree(FileBytes& file);
inline constexpr std::size_t tree_header = 168;  // docs/formats.md

/// How many files a test forges: $CLARAY_FORGED where it is set, as `./dev forge` does, else `otherwise`.
[[nodiscard]] std::uint32_t forged_count(std::uint32_t otherwise);

/// What happened to forged files: nothing but reading and refusing may, and no memory may be asked for that the file
/// does not justify.
struct ForgedOutcome {
    std::uint32_t read = 0, refused = 0;
    std::uint64_t grown_bytes = 0;  ///< by which the process's largest size in memory has grown meanwhile
};
/// Gives `use` so many forged copies of each file, mended by `mend`; `use` returns whether the file was read.
[[nodiscard]] ForgedOutcome try_forged(const std::vector<FileBytes>& good, std::uint32_t count, std::size_t header,
                                       const std::function<void(FileBytes&)>& mend,
                                       const std::function<bool(std::span<const std::uint8_t>)>& use);

}  // namespace claray::test
