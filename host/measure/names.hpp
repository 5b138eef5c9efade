// Names of builders and layouts on command lines.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "claray/bvh.hpp"

namespace claray::measure {

inline const std::vector<std::pair<std::string, Builder>> builders = {
#define CLARAY_ROW(name, NAME, note, codes, splits) {#name, Builder::name},
    CLARAY_BUILDERS(CLARAY_ROW)
#undef CLARAY_ROW
};
/// Those and "automatic", for options.
[[nodiscard]] inline std::vector<std::pair<std::string, Builder>> builders_and_automatic() {
    auto all = builders;
    all.emplace_back(automatic_traits.name, Builder::automatic);
    return all;
}
inline const std::vector<std::pair<std::string, Layout>> layouts = {
    {"automatic", Layout::automatic}, {"binary", Layout::binary}, {"wide", Layout::wide}};

template <class Value>
[[nodiscard]] std::string name_of(const std::vector<std::pair<std::string, Value>>& names, Value value) {
    for (const auto& [name, named] : names)
        if (named == value) return name;
    return "?";
}

}  // namespace claray::measure
