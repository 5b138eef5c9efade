// The text of an MTL, brought into the spelling and order that tinyobjloader knows.
#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <sstream>
#include <utility>

#include "host/io/obj/mtl.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

using std::to_string;

/// What follows a keyword.
enum class Holds { color, value, image, name, nothing_shown };

struct Keyword {
    std::string_view name;
    Holds holds;
    bool ignored = false;  ///< although it would change the picture
    std::string_view other = {};
};
constexpr Keyword keywords[] = {{"newmtl", Holds::name},
                                {"Ka", Holds::nothing_shown},
                                {"Kd", Holds::color},
                                {"Ks", Holds::color},
                                {"Ke", Holds::color},
                                {"Tf", Holds::color, false, "Kt"},
                                {"Ns", Holds::value},
                                {"Ni", Holds::value},
                                {"d", Holds::value},
                                {"Tr", Holds::value},
                                {"illum", Holds::value},
                                {"sharpness", Holds::nothing_shown},
                                {"Pr", Holds::value},
                                {"Pm", Holds::value},
                                {"Ps", Holds::value, true},
                                {"Pc", Holds::value},
                                {"Pcr", Holds::value},
                                {"aniso", Holds::value, true},
                                {"anisor", Holds::value, true},
                                {"map_Ka", Holds::nothing_shown},
                                {"map_aat", Holds::nothing_shown},
                                {"map_Kd", Holds::image},
                                {"map_Ks", Holds::image},
                                {"map_Ns", Holds::image},
                                {"map_Ke", Holds::image, false, "map_emissive"},
                                {"map_d", Holds::image, false, "map_opacity"},
                                {"map_Pr", Holds::image},
                                {"map_Pm", Holds::image},
                                {"map_Ps", Holds::image, true},
                                {"bump", Holds::image, false, "map_bump"},
                                {"norm", Holds::image, false, "map_norm"},
                                {"disp", Holds::image, false, "map_disp"},
                                {"refl", Holds::image, true, "map_refl"},
                                {"decal", Holds::image, true}};

const Keyword* keyword_of(std::string_view word) {
    for (const Keyword& keyword : keywords)
        if (is_same_in_any_case(word, keyword.name) ||
            (!keyword.other.empty() && is_same_in_any_case(word, keyword.other)))
            return &keyword;
    return nullptr;
}

/// An option of an image: how many numbers it takes at most, and what stands for each that is left out; or a word.
struct Option {
    std::string_view name;
    std::size_t numbers;
    std::string_view fallbacks[3];
    bool known_to_parser = true;
};
constexpr Option options[] = {{"-o", 3, {"0", "0", "0"}}, {"-s", 3, {"1", "1", "1"}},  {"-t", 3, {"0", "0", "0"}},
                              {"-mm", 2, {"0", "1"}},     {"-bm", 1, {"1"}},           {"-boost", 1, {"1"}},
                              {"-texres", 1, {"0"}},      {"-blendu", 0, {"on"}},      {"-blendv", 0, {"on"}},
                              {"-clamp", 0, {"on"}},      {"-cc", 0, {"on"}, false},   {"-imfchan", 0, {"m"}},
                              {"-type", 0, {"sphere"}},   {"-colorspace", 0, {"sRGB"}}};

using Words = std::vector<std::string_view>;

/// Reads an option that begins at words[at], and moves behind it; `all_numbers`: none may be left out. The option as
/// the parser takes it, or nothing where there is none.
std::optional<std::string> take_option(const Words& words, std::size_t& at, bool complete) {
    const auto option = std::find_if(std::begin(options), std::end(options),
                                     [&](const Option& known) { return is_same_in_any_case(words[at], known.name); });
    if (option == std::end(options)) return {};
    std::string result(option->name);
    std::size_t next = at + 1, given = 0;
    if (option->numbers == 0) {
        const bool switches = option->fallbacks[0] == "on";
        const bool has_word = next < words.size() && (!switches || is_same_in_any_case(words[next], "on") ||
                                                      is_same_in_any_case(words[next], "off"));
        if (!has_word && complete) return {};
        result += " " + std::string(has_word ? words[next++] : option->fallbacks[0]);
    }
    for (; given < option->numbers && next < words.size() && is_finite_number(words[next]); ++given)
        result += " " + std::string(words[next++]);
    if (given == 0 && option->numbers > 0 && complete) return {};
    for (; given < option->numbers; ++given) result += " " + std::string(option->fallbacks[given]);
    at = next;
    return option->known_to_parser ? result + " " : std::string();
}

/// All words from `at` on, if they are options and nothing else.
std::optional<std::string> only_options(const Words& words, std::size_t at) {
    std::string result;
    while (at < words.size()) {
        const std::optional<std::string> option = take_option(words, at, true);
        if (!option) return {};
        result += *option;
    }
    return result;
}

/// "[options] name [options]" with all options first, and without quotation marks. A name may hold blanks, so that only
/// what is an option to its end comes behind it.
std::string image_statement(std::string_view rest) {
    Words words;
    std::string_view left = rest;
    for (std::string_view word = next_word(left); !word.empty(); word = next_word(left)) words.push_back(word);
    std::string found;
    std::size_t begin = 0;
    while (begin < words.size()) {
        const std::optional<std::string> option = take_option(words, begin, false);
        if (!option) break;
        found += *option;
    }
    if (begin == words.size()) return found;
    std::size_t end = begin + 1;
    for (; end < words.size(); ++end) {
        if (!words[end].starts_with('-')) continue;
        const std::optional<std::string> behind = only_options(words, end);
        if (!behind) continue;
        found += *behind;
        break;
    }
    const char* const first = words[begin].data();
    std::string_view name(first, std::size_t(words[end - 1].data() + words[end - 1].size() - first));
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    return found + std::string(name);
}

/// The statements of one kind that are left out.
struct Ignored {
    std::size_t count = 0, line = 0;
};

class MtlText {
public:
    MtlText(std::string name, Warnings& warnings) : name_(std::move(name)), warnings_(warnings) {}

    std::string read(const std::string& mtl) {
        std::istringstream lines(mtl);
        for (std::string line; std::getline(lines, line);) {
            ++line_;
            std::string_view rest = line;
            const std::string_view word = next_word(rest);
            if (!word.empty()) read(word, rest);
        }
        end_material();
        warn(unknown_, " is not an MTL statement: the line is ignored");
        warn(unsupported_, " is not supported: it is ignored");
        return std::move(text_);
    }

private:
    void read(std::string_view word, std::string_view rest) {
        const Keyword* keyword = keyword_of(word);
        if (keyword == nullptr) return count(unknown_, word);
        if (keyword->name == "newmtl") end_material(), in_material_ = true;
        if (keyword->holds == Holds::nothing_shown) return;
        std::string content = content_of(*keyword, rest);
        if (keyword->ignored) {
            const bool is_0 = keyword->holds == Holds::value && content.find_first_of("123456789") == std::string::npos;
            if (!is_0) count(unsupported_, keyword->name);
            return;
        }
        statements_.push_back({keyword->name, std::move(content)});
    }

    std::string content_of(const Keyword& keyword, std::string_view rest) {
        if (keyword.holds == Holds::image) return " " + image_statement(rest);
        if (keyword.holds != Holds::name) return numbers_of(keyword, rest);
        const std::size_t end = rest.find_last_not_of(" \t");
        return std::string(rest.substr(0, end == std::string_view::npos ? 0 : end + 1));
    }

    /// "Kd 1" is grey, as the format has it; the parser would make it red. "d -halo 0.9" is 0.9 where the surface faces
    /// the eye.
    std::string numbers_of(const Keyword& keyword, std::string_view rest) {
        std::string_view word = next_word(rest);
        if (word == "-halo") {
            warnings_.push_back(where() + "'-halo' is ignored: the opacity is the same from all sides");
            word = next_word(rest);
        }
        std::string result;
        std::size_t given = 0;
        bool warned = false;
        for (; !word.empty(); word = next_word(rest), ++given) {
            if (!is_finite_number(word)) {
                if (!std::exchange(warned, true))
                    warnings_.push_back(where() + quoted(word) + " is not a valid number for a material: 0 is used");
                word = "0";
            }
            result += " " + std::string(word);
        }
        return keyword.holds == Holds::color && given == 1 ? result + result + result : result;
    }

    /// What follows a keyword in the material, the first time; null: it is not there.
    [[nodiscard]] const std::string* find(std::string_view keyword) const {
        const auto found = std::find_if(statements_.begin(), statements_.end(),
                                        [&](const auto& statement) { return statement.first == keyword; });
        return found == statements_.end() ? nullptr : &found->second;
    }
    [[nodiscard]] bool has(std::string_view keyword) const { return find(keyword) != nullptr; }

    /// Many programs write "d 1" and "Tr 0", which say the same.
    [[nodiscard]] bool contradicts_itself() const {
        const auto number = [&](const char* keyword) {
            std::string_view rest = *find(keyword);
            return number_in(next_word(rest)).value_or(0);
        };
        return std::abs(number("d") + number("Tr") - 1) > 1e-3;
    }

    void end_material() {
        const bool both = has("d") && has("Tr");
        if (both && contradicts_itself())
            warnings_.push_back(where() + "its material has both d and Tr: Tr is ignored");
        const bool needs_white = has("map_Kd") && !has("Kd"), needs_illum = in_material_ && !has("illum");
        for (const auto& [keyword, content] : statements_) {
            if (both && keyword == "Tr") continue;
            text_ += std::string(keyword) + content + "\n";
            if (keyword == "newmtl" && needs_white) text_ += "Kd 1 1 1\n";
        }
        if (needs_illum) text_ += "illum 2\n";
        statements_.clear();
    }

    [[nodiscard]] std::string where() const { return name_ + " line " + to_string(line_) + ": "; }

    using Counts = std::map<std::string, Ignored, std::less<>>;
    void count(Counts& counts, std::string_view word) const {
        Ignored& left_out = counts[std::string(word)];
        if (left_out.count++ == 0) left_out.line = line_;
    }
    void warn(const Counts& counts, const char* consequence) {
        for (const auto& [word, left_out] : counts)
            warnings_.push_back(name_ + " line " + to_string(left_out.line) +
                                (left_out.count > 1 ? " (and " + to_string(left_out.count - 1) + " more)" : "") + ": " +
                                claray::quoted(word) + consequence);
    }

    std::string name_, text_;
    Warnings& warnings_;
    std::size_t line_ = 0;
    bool in_material_ = false;
    std::vector<std::pair<std::string_view, std::string>> statements_;  ///< of the material
    Counts unknown_, unsupported_;
};

}  // namespace

std::string adapted_to_tinyobj(const std::string& mtl, const std::string& name, Warnings& warnings) {
    return MtlText(name, warnings).read(mtl);
}

}  // namespace claray
