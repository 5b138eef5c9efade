#include "host/base/did_you_mean.hpp"

#include <algorithm>
#include <cctype>
#include <utility>
#include <vector>

namespace claray {
namespace {

char lower(char c) { return char(std::tolower(static_cast<unsigned char>(c))); }

/// Insertions, deletions, substitutions and exchanges of neighbours, no letter changed twice: the optimal string
/// alignment distance (Damerau 1964; Wagner and Fischer 1974).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> two_above, above(b.size() + 1), row(b.size() + 1);
    for (std::size_t k = 0; k <= b.size(); ++k) row[k] = k;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        two_above = std::exchange(above, row);
        row[0] = i;
        for (std::size_t k = 1; k <= b.size(); ++k) {
            const auto same = [&](std::size_t x, std::size_t y) { return lower(a[x]) == lower(b[y]); };
            row[k] = std::min({above[k] + 1, row[k - 1] + 1, above[k - 1] + !same(i - 1, k - 1)});
            if (i > 1 && k > 1 && same(i - 1, k - 2) && same(i - 2, k - 1))
                row[k] = std::min(row[k], two_above[k - 2] + 1);
        }
    }
    return row.back();
}

}  // namespace

std::string did_you_mean(std::string_view name, std::span<const std::string> names) {
    std::size_t least = name.size() / 3 + 1;
    const std::string* nearest = nullptr;
    for (const std::string& other : names)
        if (const std::size_t distance = edit_distance(name, other); distance < least)
            least = distance, nearest = &other;
    return nearest ? " (did you mean '" + *nearest + "'?)" : std::string();
}

}  // namespace claray
