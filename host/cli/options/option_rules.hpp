// Checks of the values of options, and of options that contradict each other.
#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace claray::cli {

/// The number that is all of `text`, or nothing.
template <class T>
[[nodiscard]] std::optional<T> parse_number(std::string_view text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return {};
    return value;
}

/// The name of the type of values that are paths, also of "MESH=FILE".
inline constexpr const char* file_value = "FILE";

/// Splits at commas.
[[nodiscard]] std::vector<std::string> split(const std::string& text);
/// The numbers between commas. Empty if one is not a finite number.
[[nodiscard]] std::vector<float> parse_numbers(const std::string& text);

/// Accept finite numbers only.
[[nodiscard]] CLI::Validator finite_number();
[[nodiscard]] CLI::Validator positive_number();
[[nodiscard]] CLI::Validator number_from_0();
/// Accepts decimal whole numbers in least..most.
[[nodiscard]] CLI::Validator whole_number(std::uint64_t least,
                                          std::uint64_t most = std::numeric_limits<std::uint32_t>::max());
/// Turns "500ms", "2s", "1.5min", "1m" and "2h", or a number of seconds, into seconds; more than 0.
[[nodiscard]] CLI::Validator duration();

/// Turns the name of a choice into its number; upper and lower case are the same.
[[nodiscard]] CLI::Validator choice_of(std::vector<std::pair<std::string, int>> choices);
template <class Choice>
[[nodiscard]] CLI::Validator choice_of(const std::vector<std::pair<std::string, Choice>>& choices) {
    std::vector<std::pair<std::string, int>> numbers;
    for (const auto& [name, choice] : choices) numbers.emplace_back(name, int(choice));
    return choice_of(std::move(numbers));
}
/// Accepts these names only.
[[nodiscard]] CLI::Validator name_among(std::vector<std::string> names);

/// Throws ErrorKind::usage if `option` is given without `other`, without which it has no effect.
void refuse_without(const CLI::App& command, const char* option, const char* other);
/// Throws ErrorKind::usage if `option` and one of `others` are given.
void refuse_both(const CLI::App& command, const char* option, std::initializer_list<const char*> others,
                 const char* why);

}  // namespace claray::cli
