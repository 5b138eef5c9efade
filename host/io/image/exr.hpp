// OpenEXR files, through libOpenEXR, if claray was built with it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "claray/io.hpp"

namespace claray {

[[nodiscard]] bool is_exr(std::string_view bytes);

/// What an EXR's header tells of the image that load_image reads.
struct ExrShape {
    unsigned width = 0, height = 0;
    unsigned channels = 0;  ///< 1, 3 or 4
    std::vector<std::string> names;
};

/// Both return what is wrong with the file, or nothing.
[[nodiscard]] std::string read_exr_shape(std::string_view bytes, ExrShape& shape);
[[nodiscard]] std::string read_exr_pixels(std::string_view bytes, const ExrShape& shape, std::vector<float>& values);

/// Returns the bytes of a file. Throws ErrorKind::usage if claray was built without OpenEXR.
[[nodiscard]] std::string encode_exr(unsigned width, unsigned height, const std::vector<ImageLayer>& layers);

/// Throws ErrorKind::usage if claray was built without OpenEXR.
void require_exr(const std::string& path);

}  // namespace claray
