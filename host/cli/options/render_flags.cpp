#include "host/cli/options/render_flags.hpp"

#include <iterator>
#include <utility>

#include "host/cli/help/help.hpp"
#include "host/cli/options/bvh_options.hpp"
#include "host/cli/options/light_options.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/options/render_targets.hpp"
#include "host/cli/picture/alpha.hpp"
#include "host/cli/picture/lens_options.hpp"
#include "host/io/scene_readers.hpp"

namespace claray::cli {
namespace {

bool is_automatic(const std::string& text) { return text == "automatic" || text == "auto"; }

void add_exposure_option(CLI::App& command, RenderOptions& o) {
    command
        .add_option_function<std::string>(
            "--exposure",
            [&o](const std::string& text) {
                o.auto_exposure = is_automatic(text);
                o.exposure = o.auto_exposure ? std::nullopt : std::optional(parse_numbers(text).at(0));
            },
            "Brighten a picture by this many stops, or automatic (auto): by as many as show its surfaces in a medium "
            "brightness "
            "[automatic where they would be mostly white or black, else 0]")
        ->check([number = finite_number()](const std::string& text) {
            const std::string mistake = is_automatic(text) ? std::string() : number(text);
            return mistake.empty() ? mistake : mistake + ", or automatic";
        })
        ->type_name("STOPS");
}

void add_encoding_options(CLI::App& command, RenderOptions& o) {
    std::vector<std::string> names;
    for (const ImageFormatTraits& traits : image_formats) names.emplace_back(traits.name);
    names.emplace_back("y4m");
    command
        .add_option(
            "--format", o.format,
            "Format of the output, whatever its extension, as for - [by the extension; - is a PNG, or a y4m with "
            "--frames]")
        ->check(name_among(names))
        ->type_name("NAME");
    command.add_option("--png-bits", o.encoding.png_bits, "Bits of each colour of a PNG: 8 or 16 [8]")
        ->check(name_among({"8", "16"}));
    command
        .add_option_function<std::string>(
            "--quality",
            [&o](const std::string& text) {
                o.encoding.lossless = text == "lossless";
                if (!o.encoding.lossless) o.encoding.quality = *parse_number<unsigned>(text);
            },
            "Quality of a JPEG or a WebP, 1 to 100, or lossless, of a WebP [92]")
        ->check([number = whole_number(1, 100)](const std::string& text) {
            std::string copy = text;
            const std::string mistake = text == "lossless" ? std::string() : number(copy);
            return mistake.empty() ? mistake : mistake + ", or lossless";
        })
        ->type_name("N");
}

void add_image_options(CLI::App& command, RenderOptions& o) {
    OptionGroup group(command, "Output");
    command
        .add_option("scene", o.scene,
                    "A scene file (" + scene_extensions() + "), or a built-in scene (see claray scenes)")
        ->required()
        ->type_name(file_value);
    command
        .add_option("-o,--output", o.output,
                    "Output image by its extension (.png, .jpg, .webp, .hdr, .pfm or .exr), or - for standard output; "
                    "with --fps the last frame; with --frames also .y4m")
        ->type_name(file_value);
    add_size_option(command, o.config.width, o.config.height,
                    "WIDTHxHEIGHT in pixels [as a pbrt or Mitsuba file says, else 512x512]");
    add_alpha_options(command, o);
    add_exposure_option(command, o);
    add_exposure_options(command, o);
    const std::vector<std::pair<std::string, ToneMap>> tone_maps = {{"none", ToneMap::none}, {"aces", ToneMap::aces}};
    command
        .add_option("--tone-map", o.tone_map,
                    "Tone map of pictures and videos, not of radiance: none (clamp) or aces (filmic) [aces]")
        ->transform(choice_of(tone_maps))
        ->type_name("NAME");
    group.next("Quality");
    const std::vector<std::pair<std::string, DenoiserKind>> denoisers = {
        {"automatic", DenoiserKind::automatic}, {"claray", DenoiserKind::claray}, {"oidn", DenoiserKind::oidn}};
    command
        .add_flag("--denoise{automatic}", o.denoiser,
                  "Remove noise from the image. --denoise=claray: claray's kernels; "
                  "=oidn: Open Image Denoise; =automatic: the latter if it is installed. Blurs faint shadows and "
                  "reflections "
                  "in rough metal, but no textures (see docs/denoise.md)")
        ->transform(choice_of(denoisers));
    group.next("Output");
    std::vector<std::string> names;
    std::string meanings;
    for (const AovRow& row : aov_rows) {
        names.emplace_back(row.name);
        meanings += std::string("\n") + row.name + ": " + row.meaning;
    }
    for (const MatteRow& row : matte_rows) {
        names.emplace_back(row.name);
        meanings += std::string("\n") + row.name + ": Cryptomatte of " + row.meaning + ", in an .exr";
    }
    names.insert(names.end(), {"lobes", "error", "gbuffer", "voxels"});
    command
        .add_option(
            "--aov", o.aovs,
            "Also write OUTPUT.NAME.png and .pfm, or layers of an .exr:" + meanings +
                "\nlobes: light by how the first surface sends it to the camera, lobe_NAME each (see docs/formats.md)"
                "\nerror: half the width of each pixel's interval of luminance, which holds the truth in 19 of 20 "
                "pixels (see docs/accuracy.md)"
                "\ngbuffer: packed as deferred renderers keep it, .raw and a picture of each part "
                "(see docs/formats.md)"
                "\nvoxels: of --grid-voxels, by the albedo of their surfaces")
        ->take_all()
        ->delimiter(',')
        ->check(name_among(names))
        ->type_name("NAME,...");
    group.next("Image files");
    command
        .add_option("--light-group", o.config.light_groups,
                    "NAME=LIGHT,LIGHT: also write the light of these as light_NAME, by the names of lights and of "
                    "emissive materials, light:N, material:N or sky; may be repeated. light_rest has all other light")
        ->type_name("GROUP");
    add_encoding_options(command, o);
    command
        .add_option("--light-map", o.light_maps, "MESH=FILE: light map of a mesh, from claray bake; may be repeated")
        ->type_name("MESH=FILE");
}

void add_quality_options(CLI::App& command, RenderOptions& o) {
    OptionGroup group(command, "Quality");
    command.add_option("--spp", o.config.spp, "Samples per pixel [64]; with --time the upper limit")
        ->transform(whole_number(1, 1 << 24));
    group.next("Sampling");
    add_guide_flag(command, o.config.guide);
    add_approximate_option(command, o.config.approximate);
    add_shading_options(command, o.config.approximate);
    add_light_grid_options(command, o.config.light_grid);
    command.add_option("--noise", o.config.noise, "Stop at this relative standard error, for example 0.01")
        ->check(positive_number());
    command.add_option("--max-depth", o.config.max_depth, "Surfaces per path, at most; 1 is direct light only [128]")
        ->transform(whole_number(1, 1024));
    command
        .add_option("--sample-clamp", o.config.sample_clamp,
                    "Scale samples above this radiance down to it: fewer bright pixels, but a darker image")
        ->check(positive_number());
    command.add_option("--seed", o.config.seed, "Seed of the random numbers; changes the noise [0]")
        ->transform(whole_number(0));
}

void add_checkpoint_options(CLI::App& command, RenderOptions& o) {
    const OptionGroup group(command, "Checkpoints");
    command
        .add_option("--checkpoint", o.config.checkpoint, "Save progress to FILE periodically; continue with --resume")
        ->type_name(file_value);
    command
        .add_option("--checkpoint-every", o.config.checkpoint_seconds, "Time between two saves: 30s, 5min, 2h [30s]")
        ->transform(duration())
        ->type_name("TIME");
    command
        .add_option("--resume", o.config.resume,
                    "Continue from a file of --checkpoint; scene and settings must be the same")
        ->type_name(file_value);
}

void add_machine_options(CLI::App& command, RenderOptions& o) {
    OptionGroup group(command, "Device");
    command.add_option("--device", o.device,
                       "cpu, gpu, an index or part of a name (see claray devices); several share the image: "
                       "all, or a list such as gpu,cpu (see docs/scale.md)");
    group.next("Tree");
    add_bvh_options(command, o.config.bvh);
    command
        .add_option("--parts", o.config.parts,
                    "Split the tree into N parts, which take turns on the device [as its memory requires]")
        ->transform(whole_number(1, 4096));
    group.next("Reports");
    command.add_flag("--stats", o.stats, "Print build time, rays per second and memory");
    command.add_flag("--json", o.json, "Print the result and all statistics as JSON; with --frames a line for each");
    group.next("Kernels");
    command.add_option_function<std::string>(
        "--effects", [&o](const std::string& text) { o.config.effects = parse_effect_overrides(text); },
        "For experiments: +NAME compiles an effect in, -NAME removes it from the scene (see claray explain)");
    command.add_flag("--wait-for-kernels,--no-background", o.wait_for_kernels,
                     "Compile the scene's own kernels before rendering: start no compiler in the background, which may "
                     "run for up to a minute after the render");
    group.next("Reports");
    command.add_option("--trace", o.trace, "Write every device command to FILE (JSON) for ui.perfetto.dev")
        ->type_name(file_value);
    command.add_flag("-q,--quiet", o.quiet, "Print no progress");
}

}  // namespace

void add_render_options(CLI::App& command, RenderOptions& options) {
    add_image_options(command, options);
    add_view_options(command, options.view);
    add_quality_options(command, options);
    add_target_options(command, options);
    add_checkpoint_options(command, options);
    add_machine_options(command, options);
}

void check_render_options(const CLI::App& command) {
    refuse_without(command, "--checkpoint-every", "--checkpoint");
    refuse_without(command, "--exposure", "--output");
    refuse_without(command, "--tone-map", "--output");
    refuse_both(command, "--denoise", {"--fps"}, "each frame is rendered alone in its time, without a denoiser");
    refuse_both(command, "--sky", {"--environment"}, "a scene has one background");
}

}  // namespace claray::cli
