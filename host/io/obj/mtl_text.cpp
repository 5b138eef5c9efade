#include <algorithm>
#include <cctype>
#include <charconv>
#include <span>
#include <sstream>

#include "host/io/obj/mtl.hpp"
#include "host/io/obj/obj_words.hpp"

namespace claray {
namespace {

bool is_number(const std::string& word) {
    const char* begin = word.c_str() + (word[0] == '+');
    float value = 0.f;
    const auto [end, error] = std::from_chars(begin, word.c_str() + word.size(), value);
    return error == std::errc() && end == word.c_str() + word.size();
}

/// How many numbers an option takes at most, and what stands for those that are left out.
struct Option {
    const char* name;
    int numbers;
    const char* fallback;
};
constexpr Option options[] = {{"-o", 3, "0"}, {"-s", 3, "1"}, {"-t", 3, "0"}, {"-mm", 2, "0"}};

bool names_an_image(const std::string& key) {
    return key.rfind("map_", 0) == 0 || key == "bump" || key == "norm" || key == "disp" || key == "refl";
}

constexpr std::string_view colors[] = {"Ka", "Kd", "Ks", "Ke", "Tf", "Kt"};
constexpr std::string_view values[] = {"Ns", "Ni", "d",  "Tr",  "illum", "Pr",
                                       "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor"};

bool is_among(std::span<const std::string_view> keys, const std::string& key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

/// "Kd 1" is grey, as the format has it; the parser would make it red.
std::string with_three_numbers(const std::string& line) {
    std::string_view rest = line;
    const std::string key(next_word(rest)), number(next_word(rest));
    if (number.empty() || !next_word(rest).empty() || !is_among(colors, key) || !is_number(number)) return line;
    return key + " " + number + " " + number + " " + number;
}

/// The words of a line, as long as they are options; the rest, a name that may hold blanks, is left as it is.
std::string padded(const std::string& line) {
    std::istringstream in(line);
    std::string word, result;
    if (!(in >> word) || !names_an_image(word)) return line;
    result = word;
    const Option* option = nullptr;
    int given = 0;
    const auto finish = [&] {
        for (; option != nullptr && given < option->numbers; ++given)
            result += " " + std::string(std::string_view(option->name) == "-mm" && given == 1 ? "1" : option->fallback);
        option = nullptr;
    };
    bool wants_argument = false;
    for (std::streampos before = in.tellg(); in >> word; before = in.tellg()) {
        if (option != nullptr && given < option->numbers && is_number(word)) {
            result += " " + word;
            ++given;
            continue;
        }
        finish();
        const bool is_option = word[0] == '-' && word.size() > 1;
        if (!is_option && !wants_argument) {
            const std::string rest = line.substr(std::size_t(before));
            return result + " " + rest.substr(rest.find_first_not_of(" \t"));
        }
        wants_argument = is_option;
        for (const Option& known : options)
            if (is_option && word == known.name) option = &known, given = 0, wants_argument = false;
        result += " " + word;
    }
    return result;
}

}  // namespace

std::string with_all_defaults(const std::string& mtl) {
    std::string result, line;
    std::istringstream lines(mtl);
    bool in_material = false, has_illumination = false;
    const auto end_material = [&] {
        if (in_material && !has_illumination) result += "illum 2\n";
        has_illumination = false;
    };
    while (std::getline(lines, line)) {
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
        std::string_view rest = line;
        const std::string_view key = next_word(rest);
        if (key == "newmtl") end_material(), in_material = true;
        has_illumination = has_illumination || key == "illum";
        result += padded(with_three_numbers(line)) + "\n";
    }
    end_material();
    return result;
}

void warn_of_numbers(const std::string& mtl, const std::string& name, Warnings& warnings) {
    std::istringstream lines(mtl);
    std::string line, key;
    for (std::size_t number = 1; std::getline(lines, line); ++number) {
        std::string_view rest = line;
        key = next_word(rest);
        if (!is_among(colors, key) && !is_among(values, key)) continue;
        std::string_view word = next_word(rest);
        if (word == "-halo") word = next_word(rest);
        while (is_finite_number(word)) word = next_word(rest);
        if (!word.empty())
            warnings.push_back(name + " line " + std::to_string(number) + ": " + quoted(word) +
                               " is not a valid number for a material: 0 is used");
    }
}

}  // namespace claray
