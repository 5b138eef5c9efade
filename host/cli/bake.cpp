// claray bake: the light that falls on a mesh becomes an image.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/load.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_options.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/cli/output/progress.hpp"

namespace claray::cli {
namespace {

struct BakeOptions {
    std::string scene, device;
    LightOptions lights;
    SurfaceOptions surfaces;
    LoadOptions load;
    std::filesystem::path output;
    std::size_t mesh = 0;
    LightMapConfig config;
};

void bake(BakeOptions options) {
    const std::filesystem::path extension = options.output.extension();
    if (extension != ".pfm" && extension != ".hdr")
        throw Error(ErrorKind::usage, "--output: '" + options.output.string() + "' cannot store irradiance",
                    "use the extension .hdr or .pfm");
    check_outputs({{"--output", options.output}}, {{"the scene", options.scene}});
    const Scene scene = load(options.scene, options.load, options.lights, options.surfaces);
    options.config.uv_set = light_map_uv_set(scene, options.mesh);
    const InterruptGuard guard;
    const Texture map = bake_light_map(open_device(options.device), scene, options.mesh, options.config,
                                       [](double) { return !InterruptGuard::interrupted(); });
    Image image{map.width, map.height, {}};
    for (std::size_t i = 0; i < map.floats.size(); i += 3)
        image.pixels.emplace_back(map.floats[i], map.floats[i + 1], map.floats[i + 2]);
    write_image(options.output, image);
    if (std::none_of(map.floats.begin(), map.floats.end(), [](float value) { return value > 0; }))
        print_warnings({"no light falls on mesh " + std::to_string(options.mesh) +
                        ": the light map is black; add light with --light or --sky"});
    std::printf("%s: irradiance of mesh %zu, %ux%u texels on coordinates %u\n", options.output.string().c_str(),
                options.mesh, map.width, map.height, options.config.uv_set);
}

}  // namespace

void add_bake_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("bake", "Compute the light on a mesh as a light map for render --light-map");
    command->footer(
        "Examples:\n"
        "  claray bake effect:light-maps -o lm.hdr --size 64x64\n"
        "  claray render effect:light-maps -o lit.png --light-map 0=lm.hdr\n"
        "  claray bake hall.gltf --mesh 2 -o lm2.hdr --spp 1024");
    auto o = std::make_shared<BakeOptions>();
    command->add_option("scene", o->scene, "A scene file, or a built-in scene (see claray scenes)")->required();
    command->add_option("-o,--output", o->output, "Output light map: .hdr or .pfm")->required();
    command->add_option("--mesh", o->mesh, "Index of the mesh, from 0 [0]")->transform(whole_number(0));
    add_size_option(*command, o->config.width, o->config.height, "WIDTHxHEIGHT in texels [128x128]");
    command->add_option("--spp", o->config.spp, "Paths per texel [256]")->transform(whole_number(1, 1 << 24));
    command->add_option("--max-depth", o->config.max_depth, "Surfaces per path, at most; 1 is direct light only [128]")
        ->transform(whole_number(1, 1024));
    add_light_options(*command, o->lights);
    add_surface_options(*command, o->surfaces);
    add_load_options(*command, o->load);
    command->add_option("--seed", o->config.seed, "Seed of the random numbers; changes the noise [0]")
        ->transform(whole_number(0));
    command->add_option("--device", o->device, "cpu, gpu, an index or part of a name (see claray devices)");
    command->callback([&action, o] { action = [o] { bake(*o); }; });
}

}  // namespace claray::cli
