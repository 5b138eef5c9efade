// claray probe: the light that arrives at a point, as a panorama or as the faces of a cube.
#include <cstdio>
#include <memory>

#include "claray/io.hpp"
#include "claray/renderer.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/load.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/view_options.hpp"
#include "host/cli/output/outputs.hpp"

namespace claray::cli {
namespace {

struct ProbeOptions {
    std::string scene, device;
    LightOptions lights;
    SurfaceOptions surfaces;
    LoadOptions load;
    std::filesystem::path output;
    glm::vec3 from{0.f};
    bool faces = false;
    RenderConfig config = {.height = 256, .spp = 256};
};

Image image_of(const Texture& texture) {
    Image image{texture.width, texture.height, {}};
    for (std::size_t i = 0; i < texture.floats.size(); i += 3)
        image.pixels.emplace_back(texture.floats[i], texture.floats[i + 1], texture.floats[i + 2]);
    return image;
}

/// "light.hdr" and "px" -> "light/px.hdr"
std::filesystem::path path_of_face(const std::filesystem::path& output, const std::string& face) {
    std::filesystem::path folder = output;
    return folder.replace_extension() / (face + output.extension().string());
}

void probe(const ProbeOptions& options) {
    check_writable(options.output);  // its extension, before anything is rendered
    if (options.faces) std::filesystem::create_directories(path_of_face(options.output, "px").parent_path());
    const char* const names[] = {"px", "nx", "py", "ny", "pz", "nz"};
    std::vector<NamedFile> files;
    if (!options.faces) files = {{"--output", options.output}};
    for (const char* name : names)
        if (options.faces) files.push_back({"--output", path_of_face(options.output, name)});
    check_outputs(files, {{"the scene", options.scene}});
    const Scene scene = load(options.scene, options.load, options.lights, options.surfaces);
    const Environment found = render_probe(open_device(options.device), scene, options.from, options.config);
    const Texture panorama = options.faces ? Texture() : panorama_of(found);
    // What --environment reads: bytes of the sRGB curve, or linear floats.
    for (std::size_t i = 0; i < files.size(); ++i)
        write_image(files[i].path, image_of(options.faces ? found.images[i] : panorama), 0.f, ToneMap::none);
    if (options.faces)
        std::printf("%s: six faces of %ux%u pixels\n", files[0].path.parent_path().string().c_str(),
                    options.config.height, options.config.height);
    else
        std::printf("%s: a panorama of %ux%u pixels\n", options.output.string().c_str(), panorama.width,
                    panorama.height);
}

}  // namespace

void add_probe_command(CLI::App& app, Action& action) {
    CLI::App* command =
        app.add_subcommand("probe", "Render the light that arrives at a point, as an image for --environment");
    command->footer(
        "Examples:\n"
        "  claray probe sponza.obj -o hall.hdr --from 0,2,0\n"
        "  claray render statue.obj -o statue.png --environment hall.hdr\n"
        "  claray probe cornell -o box.hdr --from 0,1,0 --faces    (box/px.hdr, box/nx.hdr, ...)");
    auto o = std::make_shared<ProbeOptions>();
    command->add_option("scene", o->scene, "A scene file, or a built-in scene (see claray scenes)")->required();
    command->add_option("-o,--output", o->output, "Output image: .hdr, .pfm, .exr or .png (up to a radiance of 1)")
        ->required();
    add_vector_option(*command, "--from", o->from, "The point, X,Y,Z")->required();
    command->add_flag("--faces", o->faces, "Write the faces of a cube, into a folder named as the output");
    command->add_option("--size", o->config.height, "Pixels per side of a face; a panorama has 4 x 2 of them [256]")
        ->transform(whole_number(1, 1 << 12))
        ->type_name("N");
    command->add_option("--spp", o->config.spp, "Samples per pixel of a face [256]")
        ->transform(whole_number(1, 1 << 24));
    command->add_option("--max-depth", o->config.max_depth, "Surfaces per path, at most; 1 is direct light only [128]")
        ->transform(whole_number(1, 1024));
    add_light_options(*command, o->lights);
    add_surface_options(*command, o->surfaces);
    add_load_options(*command, o->load);
    command->add_option("--seed", o->config.seed, "Seed of the random numbers; changes the noise [0]")
        ->transform(whole_number(0));
    command->add_option("--device", o->device, "cpu, gpu, an index or part of a name (see claray devices)");
    command->callback([&action, o] { action = [o] { probe(*o); }; });
}

}  // namespace claray::cli
