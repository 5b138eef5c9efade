#include "host/cli/options/render_options.hpp"

#include <algorithm>
#include <tuple>

#include "claray/renderer.hpp"
#include "host/base/format.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/render/layers/light_layers.hpp"

namespace claray::cli {
namespace {

constexpr unsigned largest_side = 16384;

/// "640x480" -> {640, 480}
std::pair<unsigned, unsigned> parse_size(const std::string& text) {
    const std::size_t x = text.find('x');
    if (x != std::string::npos) {
        const auto width = parse_number<unsigned>(std::string_view(text).substr(0, x));
        const auto height = parse_number<unsigned>(std::string_view(text).substr(x + 1));
        if (width && height && *width > 0 && *height > 0 && *width <= largest_side && *height <= largest_side)
            return {*width, *height};
    }
    throw Error(ErrorKind::usage, "--size: '" + text + "' is not an image size",
                "write WIDTHxHEIGHT, each from 1 to " + std::to_string(largest_side));
}

}  // namespace

void add_size_option(CLI::App& command, unsigned& width, unsigned& height, const char* description) {
    command
        .add_option_function<std::string>(
            "--size", [&](const std::string& text) { std::tie(width, height) = parse_size(text); }, description)
        ->type_name("WxH");
}

void add_approximate_option(CLI::App& command, Approximations& approximate, const char* description) {
    const OptionGroup group(command, "Approximations");
    command
        .add_option_function<std::vector<std::string>>(
            "--approximate",
            [&](const std::vector<std::string>& names) {
                std::string text;
                for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
                approximate = parse_approximations(text);
            },
            description)
        ->take_all()
        ->delimiter(',')
        ->check(name_among(split("nothing," + to_string(all_approximations()))))
        ->type_name("NAME,...");
}

void add_guide_flag(CLI::App& command, bool& guide) {
    command.add_flag("--guide,!--no-guide", guide,
                     "Learn from the image's first samples where light comes from, and choose directions accordingly "
                     "where this promises less noise; needs a CPU, 9 samples per pixel and 16,384 pixels [--guide]");
}

void add_shading_options(CLI::App& command, Approximations& approximate) {
    const OptionGroup group(command, "Approximations");
    const std::vector<std::pair<std::string, int>> models = {{"flat", 0}, {"gouraud", 1}, {"phong", 2}};
    command
        .add_option_function<int>(
            "--shading", [&](int model) { approximate.flat = model == 0, approximate.gouraud = model == 1; },
            "Of first surfaces: phong (normals are interpolated), gouraud (colours of vertices are "
            "interpolated) or flat (one colour per triangle) [phong]")
        ->transform(choice_of(models))
        ->type_name("NAME");
    const std::vector<std::pair<std::string, int>> switches = {{"on", 0}, {"off", 1}};
    command
        .add_option_function<int>(
            "--shadows", [&](int off) { approximate.no_shadows = off == 1; },
            "off: lights shine through everything [on]")
        ->transform(choice_of(switches))
        ->type_name("NAME");
}

void add_light_grid_options(CLI::App& command, LightGridConfig& grid) {
    const OptionGroup group(command, "Light grid");
    command.add_flag("--grid-voxels", grid.voxels,
                     "Voxels instead of probes, which give light to the surfaces next to them only; games use "
                     "--grid-side 32 --grid-levels 2");
    command.add_option("--grid-side", grid.side, "Probes of the light grid per axis [16]")
        ->transform(whole_number(2, 64));
    command.add_option("--grid-coefficients", grid.coefficients, "Per probe and colour: 4, or 9, which is sharper [9]")
        ->transform(whole_number(4, 9));
    command
        .add_option("--grid-levels", grid.levels,
                    "Grids inside each other; finer ones follow the camera, with a quarter of the spacing [1]")
        ->transform(whole_number(1, 4));
    command
        .add_option("--grid-gather", grid.gather,
                    "Surfaces that a path meets before the grid answers; 1: final gathering [0]")
        ->transform(whole_number(0, 1024));
}

FrameRange parse_frames(const std::string& text) {
    constexpr unsigned most = 1'000'000;
    const std::size_t dots = text.find("..");
    if (dots != std::string::npos) {
        const auto first = parse_number<unsigned>(std::string_view(text).substr(0, dots));
        const auto last = parse_number<unsigned>(std::string_view(text).substr(dots + 2));
        if (first && last && *first <= *last && *last < most) return {*first, *last};
    }
    throw Error(ErrorKind::usage, "--frames: '" + text + "' is not a range of frames",
                "write FIRST..LAST, as in 0..47; a single number is for --fps");
}

std::filesystem::path numbered(const std::filesystem::path& output, unsigned frame) {
    std::string name = output.filename().string();
    const std::size_t percent = name.find('%');
    if (percent == std::string::npos)
        return output.parent_path() /
               (output.stem().string() + "." + printed("%04u", frame) + output.extension().string());
    const std::size_t end = name.find_first_not_of("0123456789", percent + 1);
    const std::string digits = name.substr(percent + 1, end - percent - 1);
    const bool plain = digits.empty() || (digits.size() == 2 && digits[0] == '0' && digits[1] != '0');
    if (end == std::string::npos || name[end] != 'd' || !plain || name.find('%', end) != std::string::npos)
        throw Error(ErrorKind::usage, "--output: '" + name + "' has an invalid placeholder for the frame number",
                    "write %d or %04d once");
    return output.parent_path() /
           name.replace(percent, end + 1 - percent, printed("%0*u", digits.empty() ? 1 : digits[1] - '0', frame));
}

bool is_y4m(const RenderOptions& options) {
    if (!options.format.empty()) return options.format == "y4m";
    return options.output == "-" ? options.animation.has_value() : options.output.extension() == ".y4m";
}

bool is_stream(const RenderOptions& options) {
    return is_y4m(options) || (options.output == "-" && options.animation.has_value());
}

ImageEncoding encoding_of(const RenderOptions& options) {
    ImageEncoding encoding = options.encoding;
    for (const ImageFormatTraits& traits : image_formats)
        if (options.format == traits.name) encoding.format = traits.format;
    if (options.format.empty() && options.output == "-") encoding.format = ImageFormat::png;
    return encoding;
}

std::optional<ImageFormat> format_of(const RenderOptions& options) {
    if (is_y4m(options)) return {};
    const ImageEncoding encoding = encoding_of(options);
    return encoding.format ? encoding.format : image_format_of(options.output);
}

bool is_shaped(const RenderOptions& options) {
    const auto format = format_of(options);
    const auto shapes = [&](const ImageFormatTraits& traits) { return traits.format == format && traits.shaped; };
    return is_y4m(options) || std::ranges::any_of(image_formats, shapes);
}

const MatteRow* matte_named(const std::string& aov) {
    const auto row = std::find_if(std::begin(matte_rows), std::end(matte_rows), [&](auto& r) { return aov == r.name; });
    return row == std::end(matte_rows) ? nullptr : row;
}

bool is_layer(const RenderOptions& options, const std::string& aov) {
    return format_of(options) == ImageFormat::exr && aov != "error" && aov != "gbuffer" && aov != "voxels";
}

void use_light_maps(Scene& scene, const std::vector<std::string>& light_maps) {
    for (const std::string& text : light_maps) {
        const std::size_t equals = text.find('=');
        const auto mesh = parse_number<std::size_t>(std::string_view(text).substr(0, equals));
        if (equals == std::string::npos || !mesh)
            throw Error(ErrorKind::usage, "--light-map: '" + text + "' is not a mesh and a file",
                        "write MESH=FILE, for example 0=floor.pfm");
        Texture map = load_image(text.substr(equals + 1));
        map.filter = Filter::bilinear;
        map.wrap_u = map.wrap_v = Wrap::clamp;
        use_light_map(scene, *mesh, std::move(map), light_map_uv_set(scene, *mesh));
    }
}

std::pair<std::filesystem::path, std::filesystem::path> aov_paths(const std::filesystem::path& output,
                                                                  const std::string& name) {
    const std::string stem = (output.parent_path() / output.stem()).string() + "." + name;
    return {stem + ".png", stem + (name == "gbuffer" ? ".raw" : ".pfm")};
}

std::vector<NamedFile> outputs_of(const RenderOptions& options) {
    std::vector<NamedFile> outputs = {{"--output", named_file(options.output)},
                                      {"--checkpoint", options.config.checkpoint},
                                      {"--trace", options.trace}};
    if (format_of(options) != ImageFormat::exr)
        for (const std::string& name : names_of_light_layers(options.config)) {
            const auto [picture, raw] = aov_paths(options.output, name);
            outputs.push_back({"--aov " + name, picture}), outputs.push_back({"--aov " + name, raw});
        }
    for (const std::string& name : options.aovs) {
        if (is_layer(options, name) || name == "lobes") continue;
        if (matte_named(name))
            throw Error(ErrorKind::usage, "--aov " + name + ": '" + options.output.string() + "' cannot hold it",
                        "use -o NAME.exr: only its layers hold ids");
        const auto [picture, raw] = aov_paths(options.output, name);
        if (name == "gbuffer")
            for (const char* view : gbuffer_views)
                outputs.push_back({"--aov gbuffer", aov_paths(options.output, view).first});
        else
            outputs.push_back({"--aov " + name, picture});
        outputs.push_back({"--aov " + name, raw});
    }
    return outputs;
}

std::vector<NamedFile> inputs_of(const RenderOptions& options) {
    std::vector<NamedFile> inputs = {{"the scene", options.scene}, {"--environment", options.view.lights.environment}};
    for (const std::string& text : options.light_maps)
        inputs.push_back({"--light-map", text.substr(text.find('=') + 1)});
    return inputs;
}

void check_outputs(const RenderOptions& options) {
    if (!options.output.empty() && !is_y4m(options))  // its extension, too
        check_writable(named_file(options.output), encoding_of(options));
    check_outputs(outputs_of(options), inputs_of(options));
}

}  // namespace claray::cli
