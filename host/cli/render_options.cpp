#include "host/cli/render_options.hpp"

#include "claray/light_map.hpp"
#include "host/cli/option_rules.hpp"
#include "host/compute/file.hpp"

namespace claray::cli {
namespace {

constexpr unsigned largest_side = 16384;

}  // namespace

std::pair<unsigned, unsigned> parse_size(const std::string& text) {
    const std::size_t x = text.find('x');
    if (x != std::string::npos) {
        const auto width = parse_number<unsigned>(std::string_view(text).substr(0, x));
        const auto height = parse_number<unsigned>(std::string_view(text).substr(x + 1));
        if (width && height && *width > 0 && *height > 0 && *width <= largest_side && *height <= largest_side)
            return {*width, *height};
    }
    throw Error(ErrorKind::usage, "--size: '" + text + "' is no image size",
                "write WIDTHxHEIGHT, each from 1 to " + std::to_string(largest_side));
}

void use_light_maps(Scene& scene, const std::vector<std::string>& light_maps) {
    for (const std::string& text : light_maps) {
        const std::size_t equals = text.find('=');
        const auto mesh = parse_number<std::size_t>(std::string_view(text).substr(0, equals));
        if (equals == std::string::npos || !mesh)
            throw Error(ErrorKind::usage, "--light-map: '" + text + "' names no mesh and file",
                        "write MESH=FILE: 0=floor.pfm");
        Texture map = load_image(text.substr(equals + 1));
        map.filter = Filter::bilinear;
        map.wrap_u = map.wrap_v = Wrap::clamp;
        use_light_map(scene, *mesh, std::move(map), light_map_uv_set(scene, *mesh));
    }
}

std::pair<std::filesystem::path, std::filesystem::path> aov_paths(const std::filesystem::path& output,
                                                                  const std::string& name) {
    const std::string stem = (output.parent_path() / output.stem()).string() + "." + name;
    return {stem + ".png", stem + ".pfm"};
}

/// What is written last would replace what was written before.
void refuse_same_file(const RenderOptions& options) {
    const std::pair<const char*, std::filesystem::path> outputs[] = {
        {"--output", options.output}, {"--trace", options.trace}, {"--checkpoint", options.config.checkpoint}};
    for (const auto& [option, path] : outputs)
        for (const auto& [other, other_path] : outputs)
            if (std::string_view(option) < other && !path.empty() &&
                path.lexically_normal() == other_path.lexically_normal())
                throw Error(ErrorKind::usage,
                            std::string(option) + " and " + other + " name one file, '" + path.string() + "'",
                            "give each its own");
}

void check_outputs(const RenderOptions& options) {
    refuse_same_file(options);
    if (!options.output.empty()) check_writable(options.output);
    for (const std::string& name : options.aovs) {
        const auto [picture, raw] = aov_paths(options.output, name);
        check_writable(picture);
        check_writable(raw);
    }
    if (!options.trace.empty()) check_file_writable(options.trace);
    if (!options.config.checkpoint.empty()) check_file_writable(options.config.checkpoint);
}

}  // namespace claray::cli
