// The corners of an OBJ's faces, checked: tinyobjloader reads what is no index as 0.
#pragma once

#include <optional>
#include <string_view>

namespace claray {

/// One corner of a face as it is written: counted from 1 or, backwards, from -1; 0 where nothing is given.
struct ObjIndices {
    int position = 0, uv = 0, normal = 0;
};
/// "1", "1/2", "1//3", "1/2/3", "1/", "1/2/"; none where the word is anything else or an index is beyond 2^31 - 1.
[[nodiscard]] std::optional<ObjIndices> parse_corner(std::string_view word);

}  // namespace claray
