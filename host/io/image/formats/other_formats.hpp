// Names of the image formats that claray does not read.
#pragma once

#include <string>
#include <string_view>

namespace claray {

/// What a file is, and how it becomes an image that claray reads.
struct OtherFormat {
    std::string name;    ///< "a GIF image"; empty: unknown
    std::string remedy;  ///< "convert it to PNG, for example by ..."
};
[[nodiscard]] OtherFormat other_format_of(std::string_view bytes);

}  // namespace claray
