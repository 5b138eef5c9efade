// claray normal-map: a height field becomes a normal map.
#include <cstdio>
#include <memory>

#include "claray/io.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/outputs.hpp"

namespace claray::cli {
namespace {

struct NormalMapOptions {
    std::filesystem::path heights, output;
    float strength = 1.f;
    int wrap = int(Wrap::repeat);
};

void make_normal_map(const NormalMapOptions& options) {
    if (options.output.extension() != ".png")
        throw Error(ErrorKind::usage, "--output: '" + options.output.string() + "' is not a PNG",
                    "use the extension .png");
    check_outputs({{"--output", options.output}}, {{"the height field", options.heights}});
    Texture heights = load_image(options.heights, TexelFormat::linear8);
    heights.wrap_u = heights.wrap_v = Wrap(options.wrap);
    const Texture map = normal_map_of(heights, options.strength);
    write_texture(options.output, map);
    std::printf("%s: %ux%u normals\n", options.output.string().c_str(), map.width, map.height);
}

}  // namespace

void add_normal_map_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("normal-map", "Convert a height field into a normal map");
    command->footer(
        "Examples:\n"
        "  claray normal-map bricks.png -o bricks_normals.png --strength 8");
    auto o = std::make_shared<NormalMapOptions>();
    command->add_option("heights", o->heights, "Image of heights; its first channel is read, without the sRGB curve")
        ->required();
    command->add_option("-o,--output", o->output, "Output normal map: .png, +y is up in the image")->required();
    command->add_option("--strength", o->strength, "Height of white over black, in texels; negative: holes [1]")
        ->check(finite_number());
    command->add_option("--wrap", o->wrap, "What continues the image beyond its border: repeat or clamp [repeat]")
        ->transform(choice_of<Wrap>({{"repeat", Wrap::repeat}, {"clamp", Wrap::clamp}}))
        ->type_name("NAME");
    command->callback([&action, o] { action = [o] { make_normal_map(*o); }; });
}

}  // namespace claray::cli
