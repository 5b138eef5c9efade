#include "host/cli/output/table.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "host/base/format.hpp"

namespace claray::cli {

void print_table(const std::vector<Row>& rows, std::size_t first_right) {
    std::vector<std::size_t> widths;
    for (const Row& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
    }
    for (const Row& row : rows) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string pad(widths[i] - row[i].size(), ' ');
            line += (i < first_right ? row[i] + pad : pad + row[i]) + "  ";
        }
        line.erase(line.find_last_not_of(' ') + 1);
        std::printf("%s\n", line.c_str());
    }
}

namespace {
std::string dumped(const nlohmann::ordered_json& json, int blanks) {
    return json.dump(blanks, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}
}  // namespace

std::string json_text(const nlohmann::ordered_json& json) { return dumped(json, 2); }
void print_json(const nlohmann::ordered_json& json) { std::fputs(json_text(json).c_str(), stdout); }
void print_json_line(const nlohmann::ordered_json& json) { std::fputs(dumped(json, -1).c_str(), stdout); }

std::string fixed(double value, int digits) { return printed("%.*f", digits, value); }
std::string number(double value) { return printed("%.4g", value); }

}  // namespace claray::cli
