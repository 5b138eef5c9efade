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
    unsigned stored_width = 0, stored_height = 0;  ///< of the data window
    unsigned channels = 0;                         ///< 1 to 4
    std::vector<std::string> names;
};

/// Both return what is wrong with the file, or nothing.
[[nodiscard]] std::string read_exr_shape(std::string_view bytes, ExrShape& shape);
[[nodiscard]] std::string read_exr_pixels(std::string_view bytes, const ExrShape& shape, std::vector<float>& values);

/// Whether its attribute `envmap` says that it has the faces of a cube one below the other.
[[nodiscard]] bool is_exr_cube(std::string_view bytes);
/// Returns the six faces of such an image, as Environment has them. Throws ErrorKind::user if they are no squares.
[[nodiscard]] std::vector<Texture> faces_of_exr_cube(const Texture& stacked);

/// Returns the bytes of a file. Throws ErrorKind::usage if claray was built without OpenEXR.
[[nodiscard]] std::string encode_exr(unsigned width, unsigned height, const std::vector<ImageLayer>& layers,
                                     const ImageAttributes& attributes);

/// Throws ErrorKind::usage if claray was built without OpenEXR.
void require_exr(const std::string& path);

}  // namespace claray
