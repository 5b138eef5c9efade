#include "host/io/gltf/gltf_choice.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "claray/error.hpp"
#include "host/base/did_you_mean.hpp"

namespace claray {
namespace {

using std::to_string;

std::optional<std::size_t> index_from(const std::string& text) {
    std::size_t index = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, index);
    return error == std::errc() && stop == end ? std::optional(index) : std::nullopt;
}

}  // namespace

std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t longest = 150, longest_name = 40;
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (text.size() > longest) return text + ", ... (" + to_string(names.size()) + " in total)";
        const std::string name = names[i].size() > longest_name ? names[i].substr(0, longest_name) + "..." : names[i];
        text += (i > 0 ? ", " : "") + (name.empty() ? to_string(i) : "'" + name + "'");
    }
    return text;
}

std::size_t choose(const GltfFile& file, const char* kind, const std::string& choice,
                   const std::vector<std::string>& names) {
    const auto named = std::find(names.begin(), names.end(), choice);
    if (named != names.end()) return std::size_t(named - names.begin());
    if (const auto index = index_from(choice); index && *index < names.size()) return *index;
    const std::string what = "'" + file.path.string() + "' has no " + kind;
    if (names.empty()) throw Error(ErrorKind::usage, what, "leave this choice out");
    throw Error(ErrorKind::usage, what + " " + listed({choice}) + did_you_mean(choice, names),
                "choose one of " + listed(names));
}

}  // namespace claray
