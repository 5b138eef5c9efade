#include "host/io/words.hpp"

#include <charconv>
#include <cmath>
#include <string>

#include "host/base/message.hpp"

namespace claray {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

const char* skip_sign(const char* p, const char* end) { return p < end && (*p == '-' || *p == '+') ? p + 1 : p; }

const char* skip_digits(const char* p, const char* end) {
    while (p < end && is_digit(*p)) ++p;
    return p;
}

}  // namespace

std::string_view next_word(std::string_view& line) {
    std::size_t begin = 0;
    while (begin < line.size() && is_space(line[begin])) ++begin;
    std::size_t end = begin;
    while (end < line.size() && !is_space(line[end])) ++end;
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word.starts_with('#') ? line = {} : word;
}

std::string quoted(std::string_view word, std::size_t most) {
    return "'" + one_line(word.substr(0, most)) + (word.size() > most ? "...'" : "'");
}

bool is_finite_number(std::string_view word) {
    constexpr std::ptrdiff_t longest_exponent = 8;  // digits; the parser gives up where it does not fit an int
    const char *const end = word.data() + word.size(), *const begin = skip_sign(word.data(), end);
    const char* p = skip_digits(begin, end);
    bool some = p > begin;
    if (p < end && *p == '.') {
        const char* const fraction = p + 1;
        p = skip_digits(fraction, end);
        some |= p > fraction;
    }
    if (some && p < end && (*p == 'e' || *p == 'E')) {
        const char* const exponent = skip_sign(p + 1, end);
        p = skip_digits(exponent, end);
        some = p > exponent && p - exponent <= longest_exponent;
    }
    return some && p == end;
}

std::optional<float> not_finite_number(std::string_view word) {
    const bool negative = word.starts_with('-');
    if (negative || word.starts_with('+')) word.remove_prefix(1);
    const std::string lower = lower_case(word);
    // "1.#..." is how old Microsoft libraries write them.
    if (lower == "inf" || lower == "infinity" || lower.starts_with("1.#inf")) return negative ? -INFINITY : INFINITY;
    if (lower.starts_with("nan") || lower.starts_with("1.#")) return NAN;
    return {};
}

std::optional<double> number_in(std::string_view word) {
    if (!is_finite_number(word)) {
        const std::optional<float> value = not_finite_number(word);
        return value ? std::optional<double>(*value) : std::nullopt;
    }
    if (word.front() == '+') word.remove_prefix(1);
    long double value = 0;  // its range tells what is too large for a double from what is too small
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc::result_out_of_range) return double(value);
    const bool tiny = word.find_first_of("eE") != std::string_view::npos && word.find("-", 1) != std::string_view::npos;
    return tiny ? 0.0 : word.front() == '-' ? -INFINITY : INFINITY;
}

}  // namespace claray
