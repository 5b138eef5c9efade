#include "claray/io.hpp"

#include <algorithm>

#include "host/base/message.hpp"

namespace claray {
namespace {

/// A warning without its numbers and without what is from its first to its last quotation mark.
std::string kind_of(const std::string& warning) {
    const std::size_t first = std::min(warning.find('\''), warning.size()), last = warning.rfind('\'');
    std::string kind = warning.substr(0, first);
    if (last != std::string::npos) kind += warning.substr(last);
    std::erase_if(kind, [](char c) { return c >= '0' && c <= '9'; });
    return kind;
}

}  // namespace

void Warnings::push_back(const std::string& warning) {
    constexpr std::size_t most_of_a_kind = 20;
    const std::string line = one_line(warning);
    Kind& kind = kinds_[kind_of(line)];
    if (++kind.count <= most_of_a_kind) {
        lines_.push_back(line);
        return;
    }
    const std::string before = kind.rest;
    const std::string more = "and " + std::to_string(kind.count - most_of_a_kind) + " more, the last: ";
    kind.rest = one_line(more + line);
    const auto found = before.empty() ? lines_.end() : std::find(lines_.begin(), lines_.end(), before);
    if (found != lines_.end())
        *found = kind.rest;
    else
        lines_.push_back(kind.rest);
}

}  // namespace claray
