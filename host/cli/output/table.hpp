// Tables and JSON on standard output.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace claray::cli {

using Row = std::vector<std::string>;

/// Every column is as wide as its widest cell. Columns from `first_right` on are aligned to the right, for numbers.
void print_table(const std::vector<Row>& rows, std::size_t first_right = std::size_t(-1));

/// Two blanks a level. Names come from drivers: bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);
void print_json(const nlohmann::ordered_json& json);
/// As one line, for programs that read several documents.
void print_json_line(const nlohmann::ordered_json& json);

/// "%.*f"
[[nodiscard]] std::string fixed(double value, int digits);
/// "%.4g", for values of any size.
[[nodiscard]] std::string number(double value);

}  // namespace claray::cli
