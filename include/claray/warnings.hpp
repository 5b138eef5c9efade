// Warnings of the loaders: problems that they found and corrected.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

namespace claray {

/// Lines for the user. Each is fit for a terminal, as `Error::what()` is. At most 20 warnings of a kind are kept, and
/// one additional line counts the rest. Warnings are of the same kind if they differ only in numbers and in quoted
/// text.
class Warnings {
public:
    using value_type = std::string;
    using iterator = std::vector<std::string>::iterator;
    using const_iterator = std::vector<std::string>::const_iterator;

    Warnings() = default;
    Warnings(std::initializer_list<std::string> warnings) {
        for (const std::string& warning : warnings) push_back(warning);
    }

    void push_back(const std::string& warning);
    void emplace_back(const std::string& warning) { push_back(warning); }
    iterator erase(const_iterator position) { return lines_.erase(position); }
    void clear() { *this = {}; }

    [[nodiscard]] bool empty() const { return lines_.empty(); }
    [[nodiscard]] std::size_t size() const { return lines_.size(); }
    [[nodiscard]] const std::string& operator[](std::size_t i) const { return lines_[i]; }
    [[nodiscard]] const std::string& at(std::size_t i) const { return lines_.at(i); }
    [[nodiscard]] const std::string& front() const { return lines_.front(); }
    [[nodiscard]] const std::string& back() const { return lines_.back(); }
    [[nodiscard]] iterator begin() { return lines_.begin(); }
    [[nodiscard]] iterator end() { return lines_.end(); }
    [[nodiscard]] const_iterator begin() const { return lines_.begin(); }
    [[nodiscard]] const_iterator end() const { return lines_.end(); }

private:
    struct Kind {
        std::size_t count = 0;
        std::string rest;  ///< the line that counts the warnings that are not kept
    };

    std::vector<std::string> lines_;
    std::map<std::string, Kind> kinds_;
};

}  // namespace claray
