// What the benchmark programs share: scenes and rays from files, medians of event times.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "claray/claray.hpp"
#include "claray/io.hpp"

namespace claray::bench {

inline double median(std::vector<double> values) {
    if (values.empty()) return 0;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

/// Median device milliseconds by command name of `repeat` runs after one that is not counted; "" is the sum of all.
inline std::map<std::string, double> measure(const Device& device, int repeat, const std::function<void()>& run) {
    std::map<std::string, std::vector<double>> times;
    for (int i = -1; i < repeat; ++i) {
        device.finish();
        device.profiler().reset();
        run();
        device.finish();
        if (i < 0) continue;
        double sum = 0;
        for (const auto& [name, summary] : device.profiler().summary()) {
            times[name].push_back(summary.milliseconds);
            sum += summary.milliseconds;
        }
        times[""].push_back(sum);
    }
    std::map<std::string, double> medians;
    for (const auto& [name, values] : times) medians[name] = median(values);
    return medians;
}

/// --builder, --bits and --layout.
inline void add_bvh_options(CLI::App& app, Bvh::Config& config) {
    const std::map<std::string, Builder> builders = {{"fast", Builder::fast}, {"balanced", Builder::balanced}};
    const std::map<std::string, Layout> layouts = {{"binary", Layout::binary}, {"wide", Layout::wide}};
    app.add_option("--builder", config.builder)->transform(CLI::CheckedTransformer(builders));
    app.add_option("--layout", config.layout)->transform(CLI::CheckedTransformer(layouts));
    app.add_option("--bits", config.morton_bits);
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

/// A file of 32-bit words.
inline std::vector<std::uint32_t> read_words(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw Error(ErrorKind::user, "cannot read " + path.string());
    std::vector<std::uint32_t> words(std::size_t(file.tellg()) / 4 + 1);
    file.seekg(0).read(reinterpret_cast<char*>(words.data()), std::streamsize(words.size() * 4));
    return words;
}

/// A scene by built-in name or file; also the plain binary ".scn": u32 'SCN1', vertices, triangles, 0; positions;
/// indices.
inline std::vector<Mesh> load_meshes(const std::string& name) {
    if (!name.ends_with(".scn")) {
        Warnings warnings;
        return load_scene(name, warnings).meshes;
    }
    const std::vector<std::uint32_t> words = read_words(name);
    Mesh mesh;
    mesh.positions.resize(words.at(1));
    mesh.triangles.resize(words.at(2));
    std::memcpy(mesh.positions.data(), &words.at(4), mesh.positions.size() * sizeof(glm::vec3));
    std::memcpy(mesh.triangles.data(), &words.at(4 + 3 * mesh.positions.size()),
                mesh.triangles.size() * sizeof(glm::uvec3));
    return {std::move(mesh)};
}

/// Primary rays of a camera, one through each pixel's centre, in scanline order or in tiles of 8 x 8 pixels.
inline std::vector<Ray> primary_rays(const Camera& camera, unsigned width, unsigned height, bool tiles) {
    const CameraData c = camera_data(camera, float(width) / float(height));
    std::vector<Ray> rays(std::size_t(width) * height);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        std::size_t x = i % width, y = i / width;
        if (tiles) {
            const std::size_t tile = i / 64, in_tile = i % 64, row = width / 8;
            x = tile % row * 8 + in_tile % 8, y = tile / row * 8 + in_tile / 8;
        }
        const float u = (float(x) + 0.5f) / float(width) * 2 - 1, v = 1 - (float(y) + 0.5f) / float(height) * 2;
        rays[i] = {c.x,
                   c.y,
                   c.z,
                   0,
                   c.forward_x + u * c.right_x + v * c.up_x,
                   c.forward_y + u * c.right_y + v * c.up_y,
                   c.forward_z + u * c.right_z + v * c.up_z,
                   1e30f};
    }
    return rays;
}

/// Rays between random points of the box, scaled by 1.5 around its centre.
inline std::vector<Ray> random_rays(const Bounds& bounds, std::size_t count) {
    std::vector<Ray> rays(count);
    std::uint64_t state = 1;
    const auto uniform = [&] {  // PCG's generator (O'Neill 2014), its upper 24 bits
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        return float(state >> 40) * 0x1p-24f;
    };
    const auto point = [&] {
        const glm::vec3 unit(uniform(), uniform(), uniform());
        return bounds.center() + (unit - 0.5f) * 1.5f * bounds.extent();
    };
    for (Ray& ray : rays) {
        const glm::vec3 from = point(), direction = point() - from;
        ray = {from.x, from.y, from.z, 0, direction.x, direction.y, direction.z, 1e30f};
    }
    return rays;
}

}  // namespace claray::bench
