#include "host/io/obj/obj_lines.hpp"

#include <algorithm>
#include <initializer_list>

#include "host/io/text_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

/// `rest`: what follows the keyword.
ObjStatement statement_of(std::string_view keyword, std::string_view rest) {
    const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
        return std::find(words.begin(), words.end(), keyword) != words.end();
    };
    // Behind "mtllib": what says how others show it, and changes no surface.
    if (is_one_of({"", "v", "vt", "vn", "f", "g", "o", "usemtl", "mtllib", "mg", "lod", "bevel", "c_interp", "d_interp",
                   "usemap", "maplib", "shadow_obj", "trace_obj"}))
        return ObjStatement::known;
    if (is_one_of({"l", "p"})) return ObjStatement::stroke;
    if (is_one_of({"vp", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp",
                   "end", "con", "ctech", "stech"}))
        return ObjStatement::free_form;
    if (keyword != "s") return ObjStatement::unknown;
    const std::string_view group = next_word(rest);
    return group == "off" || group == "0" ? ObjStatement::known : ObjStatement::smoothing;
}

}  // namespace

std::string_view trim(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r\n") - begin + 1);
}

ObjLines::int_type ObjLines::underflow() {
    if (next_ >= text_.size()) return traits_type::eof();
    const std::size_t begin = next_, end = std::min(text_.find('\n', begin), text_.size());
    const bool may_go_on = !is_comment({text_.data() + begin, end - begin});
    while (join_next_line(begin, may_go_on)) {
    }
    char* const data = text_.data();
    setg(data + begin, data + begin, data + next_);
    const std::string_view all = trim(text());
    if (bare_.line == 0 && (all == "v" || all == "vt" || all == "vn")) bare_ = {std::string(all), line_};
    std::string_view rest = all;
    const std::string_view keyword = next_word(rest);
    const ObjStatement kind = statement_of(keyword, rest);
    if (kind == ObjStatement::stroke)
        at_stroke();
    else if (kind != ObjStatement::known)
        left_out_[std::size_t(kind)].add(keyword, line_);
    return traits_type::to_int_type(data[begin]);
}

bool ObjLines::join_next_line(std::size_t begin, bool may_go_on) {
    const std::size_t end = std::min(text_.find('\n', next_), text_.size());
    next_ = std::min(end + 1, text_.size());
    ++line_;
    if (!may_go_on || end == begin || text_[end - 1] != '\\' || next_ >= text_.size()) return false;
    std::fill(text_.begin() + std::ptrdiff_t(end) - 1, text_.begin() + std::ptrdiff_t(next_), ' ');
    return true;
}

}  // namespace claray
