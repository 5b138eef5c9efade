#include "host/cli/options/option_rules.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "claray/error.hpp"
#include "host/base/did_you_mean.hpp"
#include "host/cli/help/option_facts.hpp"

namespace claray::cli {
namespace {

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

/// The finite number that is all of `text`, or nothing.
std::optional<double> parse_finite(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto value = parse_number<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

/// "a, b or c"
std::string listed(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    return text;
}

std::string no_such(const std::string& name, const std::vector<std::string>& names) {
    return "unknown name " + in_quotes(name) + did_you_mean(name, names) + "; choose " + listed(names);
}

template <class Good>
CLI::Validator number_that_is(Good good, const char* mistake) {
    const auto check = [=](const std::string& text) {
        const auto value = parse_finite(text);
        const bool fits_float = value && std::abs(*value) <= double(std::numeric_limits<float>::max());
        return fits_float && good(*value) ? std::string() : in_quotes(text) + mistake;
    };
    return CLI::Validator(check, "");
}

}  // namespace

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; begin <= text.size(); begin += words.back().size() + 1)
        words.push_back(text.substr(begin, text.find(',', begin) - begin));
    return words;
}

std::vector<float> parse_numbers(const std::string& text) {
    std::vector<float> numbers;
    for (const std::string& word : split(text)) {
        const auto number = parse_number<float>(word);
        if (!number || !std::isfinite(*number)) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

CLI::Validator finite_number() {
    return number_that_is([](double) { return true; }, " is not a number; write it as in -1.5");
}

CLI::Validator positive_number() {
    return number_that_is([](double x) { return x > 0; }, " is not a number of more than 0");
}

CLI::Validator number_from_0() {
    return number_that_is([](double x) { return x >= 0; }, " is not a number of 0 or more");
}

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
    const std::string range = std::to_string(least) + ".." + std::to_string(most);
    const auto check = [=](std::string& text) {
        const auto value = parse_number<std::uint64_t>(text);
        if (!value || *value < least || *value > most) return in_quotes(text) + " is not a whole number in " + range;
        text = std::to_string(*value);  // "010" would be read as octal
        return std::string();
    };
    return CLI::Validator(check, "");
}

CLI::Validator duration() {
    const auto parse = [](std::string& text) {
        static constexpr std::pair<const char*, double> units[] = {{"", 1},   {"us", 1e-6}, {"ms", 1e-3}, {"s", 1},
                                                                   {"m", 60}, {"min", 60},  {"h", 3600}};
        const std::size_t begin = std::min(text.find_first_not_of("+-.0123456789eE"), text.size());
        const auto value = parse_finite(std::string_view(text).substr(0, begin));
        const std::string unit = lower_case(text.substr(std::min(text.find_first_not_of(' ', begin), text.size())));
        for (const auto& [name, unit_seconds] : units) {
            const double seconds = value ? *value * unit_seconds : 0;
            if (seconds > 0 && unit == name) {
                char decimal[32];
                *std::to_chars(decimal, std::end(decimal) - 1, seconds).ptr = '\0';
                text = decimal;
                return std::string();
            }
        }
        return in_quotes(text) + " is not a time of more than 0; write it as in 500ms, 2s, 5min or 1h";
    };
    return CLI::Validator(parse, "");
}

CLI::Validator choice_of(std::vector<std::pair<std::string, int>> choices) {
    std::vector<std::string> names;
    std::vector<int> numbers;
    for (const auto& [name, number] : choices) names.push_back(name), numbers.push_back(number);
    const std::string validator_name = choices_name(names, numbers);
    const auto find = [choices = std::move(choices), names = std::move(names)](std::string& text) {
        for (const auto& [name, number] : choices)
            if (lower_case(text) == name) {
                text = std::to_string(number);
                return std::string();
            }
        return no_such(text, names);
    };
    return CLI::Validator(find, "", validator_name);
}

CLI::Validator name_among(std::vector<std::string> names) {
    const std::string validator_name = choices_name(names);
    const auto check = [names = std::move(names)](const std::string& text) {
        return std::find(names.begin(), names.end(), text) != names.end() ? std::string() : no_such(text, names);
    };
    return CLI::Validator(check, "", validator_name);
}

void refuse_without(const CLI::App& command, const char* option, const char* other) {
    if (command.count(option) > 0 && command.count(other) == 0)
        throw Error(ErrorKind::usage, std::string(option) + " has no effect without " + other,
                    std::string("add ") + other + ", or leave it out");
}

void refuse_both(const CLI::App& command, const char* option, std::initializer_list<const char*> others,
                 const char* why) {
    if (command.count(option) == 0) return;
    for (const char* other : others)
        if (command.count(other) > 0)
            throw Error(ErrorKind::usage, std::string(option) + " and " + other + " contradict each other: " + why,
                        "leave one of them out");
}

}  // namespace claray::cli
