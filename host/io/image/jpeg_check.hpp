// What stb_image trusts in a JPEG.
#pragma once

#include <string_view>

namespace claray {

/// False where a Huffman table has more than 256 codes: stb_image (2022) writes behind its arrays then.
[[nodiscard]] bool jpeg_tables_fit(std::string_view bytes);

}  // namespace claray
