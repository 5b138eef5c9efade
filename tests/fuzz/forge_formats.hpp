// Forged files of formats that have more structure than words: what is changed is a chunk, a value of JSON, a word of a
// line. Lengths and checksums are right, so that what is behind them is tried. The same number gives the same file.
#pragma once

#include <string_view>

#include "tests/fuzz/forge.hpp"

namespace claray::test {

/// A PNG of any size up to 48 pixels a side, colour type, depth, palette, interlacing and filters, sound or not: fields
/// that contradict each other, too few or too many pixels, chunks that are missing, doubled or out of order.
[[nodiscard]] FileBytes forged_png(std::uint32_t number);

/// 1 to 4 values of a glTF's JSON changed, moved, doubled or taken away. Of a .glb the lengths are put right, and
/// sometimes bytes of its buffer are changed, too.
[[nodiscard]] FileBytes forged_gltf(std::span<const std::uint8_t> good, std::uint32_t number);

/// Words and lines of an OBJ or MTL changed, moved, doubled or taken away; sometimes its line ends or its encoding.
[[nodiscard]] FileBytes forged_text(std::span<const std::uint8_t> good, std::uint32_t number);

/// Bytes of the elements that a glTF's accessors promise without giving data for them.
[[nodiscard]] std::uint64_t promised_zeros(std::span<const std::uint8_t> gltf);

}  // namespace claray::test
