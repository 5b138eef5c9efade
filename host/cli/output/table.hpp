// Plain tables on standard output.
#pragma once

#include <string>
#include <vector>

namespace claray::cli {

using Row = std::vector<std::string>;

/// Columns as wide as their widest cell. Columns from `first_right` on are aligned to the right, as numbers are.
void print_table(const std::vector<Row>& rows, std::size_t first_right = std::size_t(-1));

/// "%.*f"
[[nodiscard]] std::string fixed(double value, int digits);
/// "%.4g", for what may be of any size.
[[nodiscard]] std::string number(double value);

}  // namespace claray::cli
