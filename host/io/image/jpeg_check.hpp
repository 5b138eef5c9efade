// Checks data in a JPEG that stb_image does not check.
#pragma once

#include <string_view>

namespace claray {

/// Returns false if a Huffman table has more than 256 codes: stb_image (2022) then writes beyond its arrays.
[[nodiscard]] bool jpeg_tables_fit(std::string_view bytes);

}  // namespace claray
