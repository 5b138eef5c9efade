// The frames of an animation, a picture each.
#pragma once

#include <filesystem>
#include <string>

namespace claray::cli {

struct FrameRange {
    unsigned first = 0, last = 0;
};

/// "0..47" -> {0, 47}. Throws ErrorKind::usage for what is no such range, or one of more than a million frames.
[[nodiscard]] FrameRange parse_frames(const std::string& text);

/// The file of a frame: its number takes the place of %d or %04d in the name, or stands before the extension, as in
/// out.0007.png. Throws ErrorKind::usage where the name has another % than one of these.
[[nodiscard]] std::filesystem::path numbered(const std::filesystem::path& output, unsigned frame);

}  // namespace claray::cli
