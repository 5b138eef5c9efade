// Radiance pictures (.hdr, .pic): RGBE and XYZE, in runs of both kinds or without.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace claray {

struct RadianceHeader {
    unsigned width = 0, height = 0;
    bool columns = false;                          ///< scan lines are columns
    bool from_right = false, from_bottom = false;  ///< where they begin
    glm::dmat3 to_linear{1.0};                     ///< from the values in the file to Rec. 709, EXPOSURE undone
    std::size_t pixels = 0;                        ///< the byte at which they begin
};

[[nodiscard]] bool is_radiance(std::string_view bytes);

/// Both return what is wrong with the file, or nothing.
[[nodiscard]] std::string read_radiance_header(std::string_view bytes, RadianceHeader& header);
/// Fills three values per pixel, row by row from the top left.
[[nodiscard]] std::string read_radiance_pixels(std::string_view bytes, const RadianceHeader& header,
                                               std::vector<float>& rgb);

}  // namespace claray
