#include "host/io/obj/obj_corner.hpp"

#include <charconv>

namespace claray {
namespace {

/// An index up to a slash or the end; 0 where there is none.
bool parse_index(const char*& p, const char* end, int& index) {
    if (p == end || *p == '/') return true;
    if (*p == '+') ++p;  // from_chars takes no plus sign
    const auto [stop, error] = std::from_chars(p, end, index);
    p = stop;
    return error == std::errc() && (p == end || *p == '/');
}

}  // namespace

std::optional<ObjIndices> parse_corner(std::string_view word) {
    const char *p = word.data(), *const end = p + word.size();
    ObjIndices corner;
    if (p == end || *p == '/' || !parse_index(p, end, corner.position)) return {};
    for (int* const index : {&corner.uv, &corner.normal}) {
        if (p == end) return corner;
        ++p;  // past the slash
        if (!parse_index(p, end, *index)) return {};
    }
    return p == end ? std::optional(corner) : std::nullopt;
}

}  // namespace claray
