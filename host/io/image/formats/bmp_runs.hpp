// BMP images in runs (BI_RLE8 and BI_RLE4), which stb_image does not read.
#pragma once

#include <string>
#include <string_view>

namespace claray {

[[nodiscard]] bool is_bmp_of_runs(std::string_view bytes);

/// Bytes of the image without runs; 0 if its size is invalid.
[[nodiscard]] std::size_t size_without_bmp_runs(std::string_view bytes);
/// Returns the same image without runs. What the runs leave out has the first colour. Runs that go on beyond the image
/// or end early are cut off, as in other readers.
[[nodiscard]] std::string without_bmp_runs(std::string_view bytes);

}  // namespace claray
