// What the benchmark programs share, beside host/measure: options and CSV.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "claray/claray.hpp"
#include "claray/io.hpp"
#include "host/measure/measure.hpp"
#include "host/measure/names.hpp"
#include "host/measure/rays.hpp"

namespace claray::measure {

/// --builder, --bits, --layout, --leaf and --split. The tree that is measured stays.
inline void add_bvh_options(CLI::App& app, Bvh::Config& config) {
    config.learns = false;
    app.add_option("--builder", config.builder)->transform(CLI::CheckedTransformer(builders_and_automatic()));
    app.add_option("--layout", config.layout)->transform(CLI::CheckedTransformer(layouts));
    app.add_option("--bits", config.morton_bits);
    app.add_option("--leaf", config.max_leaf_triangles);
    app.add_option("--split", config.split_budget);
}

/// Rows for a file of comma-separated values; writes nothing where the path is empty. Every row begins with the device.
class Csv {
public:
    Csv(std::string path, const Device& device, const std::string& header)
        : path_(std::move(path)),
          device_('"' + device.info().name + "\"," + device.info().driver),
          text_("device,driver," + header + "\n") {}
    template <class... Values>
    void row(const Values&... values) {
        std::ostringstream line;
        line << device_;
        ((line << ',' << values), ...);
        text_ += line.str() + "\n";
    }
    void write() const {
        if (!path_.empty()) write_file(path_, text_);
    }

private:
    std::string path_, device_, text_;
};

}  // namespace claray::measure
