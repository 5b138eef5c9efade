#include "host/cli/options/frames.hpp"

#include "claray/error.hpp"
#include "host/cli/options/option_rules.hpp"

namespace claray::cli {
namespace {

std::string with_zeros(unsigned frame, std::size_t digits) {
    const std::string number = std::to_string(frame);
    return std::string(digits > number.size() ? digits - number.size() : 0, '0') + number;
}

}  // namespace

FrameRange parse_frames(const std::string& text) {
    constexpr unsigned most = 1'000'000;
    const std::size_t dots = text.find("..");
    if (dots != std::string::npos) {
        const auto first = parse_number<unsigned>(std::string_view(text).substr(0, dots));
        const auto last = parse_number<unsigned>(std::string_view(text).substr(dots + 2));
        if (first && last && *first <= *last && *last < most) return {*first, *last};
    }
    throw Error(ErrorKind::usage, "--frames: '" + text + "' is not a range of frames",
                "write FIRST..LAST, as in 0..47; a single number is for --fps");
}

std::filesystem::path numbered(const std::filesystem::path& output, unsigned frame) {
    std::string name = output.filename().string();
    const std::size_t percent = name.find('%');
    if (percent == std::string::npos)
        return output.parent_path() /
               (output.stem().string() + "." + with_zeros(frame, 4) + output.extension().string());
    const std::size_t end = name.find_first_not_of("0123456789", percent + 1);
    const std::string digits = name.substr(percent + 1, end - percent - 1);
    const bool plain = digits.empty() || (digits.size() == 2 && digits[0] == '0' && digits[1] != '0');
    if (end == std::string::npos || name[end] != 'd' || !plain || name.find('%', end) != std::string::npos)
        throw Error(ErrorKind::usage, "--output: '" + name + "' has an invalid placeholder for the frame number",
                    "write %d or %04d once");
    return output.parent_path() / name.replace(percent, end + 1 - percent,
                                               with_zeros(frame, digits.empty() ? 1 : std::size_t(digits[1] - '0')));
}

}  // namespace claray::cli
