#include "host/cli/picture/alpha.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "host/base/color.hpp"
#include "host/base/format.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/outputs.hpp"
#include "host/io/image/write/encode.hpp"

namespace claray::cli {
namespace {

constexpr const char* ground = "plane";
constexpr double sides_per_radius = 40;  // of the ground plane, over the scene's radius

Region parse_region(const std::string& text) {
    const std::vector<std::string> words = split(text);
    unsigned numbers[4] = {};
    bool good = words.size() == 4;
    for (std::size_t i = 0; good && i < 4; ++i) {
        const auto number = parse_number<unsigned>(words[i]);
        good = number.has_value();
        numbers[i] = number.value_or(0);
    }
    if (!good || numbers[2] == 0 || numbers[3] == 0)
        throw Error(ErrorKind::usage, "--region: '" + text + "' is not a part of an image",
                    "write X,Y,WIDTH,HEIGHT in pixels from the top left");
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

/// A name, or the number that --aov material shows.
Material& material_called(Scene& scene, const std::string& option, const std::string& name) {
    for (Material& material : scene.materials)
        if (material.name == name) return material;
    const auto number = parse_number<std::size_t>(name);
    if (number && *number < scene.materials.size()) return scene.materials[*number];
    std::string names;
    for (const Material& material : scene.materials)
        if (!material.name.empty()) names += (names.empty() ? "" : ", ") + material.name;
    throw Error(ErrorKind::usage, option + ": the scene has no material '" + name + "'",
                "use a number from 0 to " + std::to_string(scene.materials.size() - 1) +
                    (names.empty() ? std::string() : ", or one of " + names));
}

/// A square below all surfaces, across the axis that is nearest to the camera's up.
void add_ground(Scene& scene) {
    const Bounds bounds = bounds_of(scene);
    const glm::vec3 up = camera_of(scene).up, size = glm::abs(up);
    const int axis = size.y >= size.x && size.y >= size.z ? 1 : size.z >= size.x ? 2 : 0;
    const bool points_down = up[axis] < 0;
    const float half = float(0.5 * sides_per_radius * 0.5) * std::max(1e-6f, glm::length(bounds.extent()));
    glm::vec3 center = bounds.center();
    const float gap = 1e-4f * glm::length(bounds.extent());  // lest it is within a floor
    center[axis] = points_down ? bounds.hi[axis] + gap : bounds.lo[axis] - gap;
    glm::vec3 along(0.f), across(0.f);
    along[(axis + 1) % 3] = half, across[(axis + 2) % 3] = points_down ? -half : half;
    Mesh mesh{.name = "ground plane"};
    mesh.positions = {center - along - across, center + along - across, center + along + across,
                      center - along + across};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.materials.assign(2, std::uint32_t(scene.materials.size()));
    scene.materials.push_back(Material{.name = "ground plane", .role = MaterialRole::shadow_catcher});
    if (!scene.instances.empty()) scene.instances.push_back({.mesh = std::uint32_t(scene.meshes.size())});
    scene.meshes.push_back(std::move(mesh));
}

bool is_straight(const RenderOptions& options, bool by_format) {
    return options.alpha == AlphaStorage::by_format ? by_format : options.alpha == AlphaStorage::straight;
}

glm::vec3 straight(const glm::vec3& color, float alpha) { return alpha > 0.f ? color / alpha : glm::vec3(0.f); }

/// The texels of a PNG: red, green, blue and alpha of 8 or 16 bits each.
template <class Number>
std::string texels_of(const Picture& picture, const RenderOptions& options) {
    constexpr double most = std::numeric_limits<Number>::max();
    const float gain = std::exp2(options.exposure.value_or(0.f));
    const bool multiplies = !is_straight(options, true);
    std::vector<Number> texels;
    texels.reserve(4 * picture.pixels.size());
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const glm::vec3 color = gain * straight(picture.pixels[i], picture.alpha[i]);
        for (int k = 0; k < 3; ++k) {
            const double encoded = srgb_curve(tone_mapped(color[k], options.tone_map));
            texels.push_back(Number(std::lround(most * encoded * (multiplies ? picture.alpha[i] : 1.f))));
        }
        texels.push_back(Number(std::lround(most * picture.alpha[i])));
    }
    return {reinterpret_cast<const char*>(texels.data()), texels.size() * sizeof texels[0]};
}

template <class Pixel>
std::vector<Pixel> framed(const std::vector<Pixel>& part, const RenderConfig& config) {
    const Region& region = config.region;
    std::vector<Pixel> whole(std::size_t(config.width) * config.height);
    for (unsigned y = 0; y < region.height; ++y)
        std::copy_n(part.begin() + std::ptrdiff_t(y) * region.width, region.width,
                    whole.begin() + std::ptrdiff_t(region.y + y) * config.width + region.x);
    return whole;
}

}  // namespace

void add_alpha_options(CLI::App& command, RenderOptions& o) {
    OptionGroup group(command, "Output");
    command
        .add_option_function<std::string>(
            "--region", [&o](const std::string& text) { o.config.region = parse_region(text); },
            "X,Y,WIDTH,HEIGHT: render these pixels only, from the top left; the image has their size")
        ->type_name("X,Y,W,H");
    const std::vector<std::pair<std::string, AlphaStorage>> kinds = {{"automatic", AlphaStorage::by_format},
                                                                     {"straight", AlphaStorage::straight},
                                                                     {"premultiplied", AlphaStorage::premultiplied}};
    command
        .add_flag("--alpha{automatic}", o.alpha,
                  "Leave the background transparent, which still lights the scene, in .png or .exr. "
                  "=straight or =premultiplied: the colours [straight in a PNG, premultiplied in an EXR]")
        ->transform(choice_of(kinds));
    group.next("Alpha");
    command.add_flag("--full-frame", o.full_frame, "Write the pixels of --region at their place in the whole image");
    command
        .add_option("--holdout", o.holdouts,
                    "Cut the surfaces of a material out of the image with alpha; may be repeated")
        ->type_name("MATERIAL");
    command
        .add_option("--shadow-catcher", o.catchers,
                    "Show of a material only the shadows and the light that other surfaces cast on it, by alpha. "
                    "plane: of a ground plane below the scene. May be repeated")
        ->type_name("MATERIAL");
}

void check_alpha_options(const CLI::App& command, RenderOptions& o) {
    o.config.alpha = o.alpha || !o.holdouts.empty() || !o.catchers.empty();
    refuse_without(command, "--full-frame", "--region");
    refuse_both(command, "--full-frame", {"--aov"}, "AOVs of a region have its size");
    refuse_both(command, "--region", {"--adaptive", "--denoise", "--fps"}, "they need the whole image");
    const char* const cause = o.alpha ? "--alpha" : !o.holdouts.empty() ? "--holdout" : "--shadow-catcher";
    refuse_both(command, cause, {"--fps", "--checkpoint", "--resume"}, "these images have no alpha");
    const auto format = format_of(o);
    if (o.config.alpha && (is_stream(o) || (format != ImageFormat::png && format != ImageFormat::exr)))
        throw Error(ErrorKind::usage, "--output: '" + o.output.string() + "' has no place for an alpha",
                    "write .png or .exr files");
}

void give_roles(Scene& scene, const RenderOptions& options) {
    for (const std::string& name : options.holdouts)
        material_called(scene, "--holdout", name).role = MaterialRole::holdout;
    for (const std::string& name : options.catchers)
        if (name != ground) material_called(scene, "--shadow-catcher", name).role = MaterialRole::shadow_catcher;
    if (std::find(options.catchers.begin(), options.catchers.end(), ground) != options.catchers.end())
        add_ground(scene);
}

Picture picture_of(const std::vector<glm::vec3>& pixels, const Renderer* renderer, const RenderOptions& options) {
    const RenderConfig& config = options.config;
    Picture picture{config.image_width(), config.image_height(), pixels, {}};
    if (config.alpha && renderer != nullptr) picture.alpha = renderer->alpha();
    if (!options.full_frame) return picture;
    picture.width = config.width, picture.height = config.height;
    picture.pixels = framed(picture.pixels, config);
    if (!picture.alpha.empty()) picture.alpha = framed(picture.alpha, config);
    return picture;
}

ImageLayer colors_of(const Picture& picture, const RenderOptions& options) {
    const bool has_alpha = !picture.alpha.empty(), divides = has_alpha && is_straight(options, false);
    ImageLayer layer{.name = "", .channels = has_alpha ? "RGBA" : "RGB"};
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const glm::vec3 color = divides ? straight(picture.pixels[i], picture.alpha[i]) : picture.pixels[i];
        layer.values.insert(layer.values.end(), {color.x, color.y, color.z});
        if (has_alpha) layer.values.push_back(picture.alpha[i]);
    }
    return layer;
}

void write_with_alpha(const Picture& picture, const RenderOptions& options) {
    const auto path = named_file(options.output);
    if (format_of(options) == ImageFormat::exr)
        return write_exr(path, picture.width, picture.height, {colors_of(picture, options)});
    const bool is_deep = encoding_of(options).png_bits == 16;
    const std::string texels =
        is_deep ? texels_of<std::uint16_t>(picture, options) : texels_of<std::uint8_t>(picture, options);
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(texels.data()), texels.size());
    const std::string png = encode_png(picture.width, picture.height, 4, bytes, is_deep ? 16 : 8);
    if (png.empty())
        throw Error(ErrorKind::user, "cannot encode '" + path.string() + "': out of memory", "use a smaller image");
    write_file(path, png);
}

}  // namespace claray::cli
