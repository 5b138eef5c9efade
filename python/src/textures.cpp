// Images: textures, environments, and files of images.
#include "textures.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>

#include "claray/image/image_error.hpp"
#include "claray/io.hpp"
#include "render_config.hpp"
#include "typed.hpp"

namespace claray::python {
namespace {

using Bytes = Input<std::uint8_t, nb::shape<-1, -1, -1>>;
using Floats = Input<float, nb::shape<-1, -1, -1>>;
using Map = Input<float, nb::shape<-1, -1>>;
using Identifiers = Input<std::uint32_t, nb::shape<-1, -1>>;
using FloatLayer = std::tuple<std::string, std::string, Floats>;  // name, channels, pixels
using WordLayer = std::tuple<std::string, std::string, Input<std::uint32_t, nb::shape<-1, -1, -1>>>;

/// A new member does not compile here: bind it below.
[[maybe_unused]] void name_all_members(Texture& texture, Environment& environment) {
    [[maybe_unused]] auto& [name, width, height, channels, format, bytes, floats, wrap_u, wrap_v, filter] = texture;
    [[maybe_unused]] auto& [images, strength, rotation] = environment;
}

template <class Array>
Texture sized(const Array& pixels, TexelFormat format) {
    Texture texture;
    texture.height = unsigned(pixels.shape(0)), texture.width = unsigned(pixels.shape(1));
    texture.channels = unsigned(pixels.shape(2));
    texture.format = format;
    return texture;
}

Texture of_bytes(const Bytes& pixels, const std::string& color) {
    Texture texture = sized(pixels, kind_of("color", color, texel_formats));
    texture.bytes.assign(pixels.data(), pixels.data() + pixels.size());
    return texture;
}

Texture of_floats(const Floats& pixels) {
    Texture texture = sized(pixels, TexelFormat::float32);
    texture.floats.assign(pixels.data(), pixels.data() + pixels.size());
    return texture;
}

/// An array of its own: (height, width, channels).
nb::object pixels_of(const Texture& texture) {
    const std::vector<std::size_t> shape = {texture.height, texture.width, texture.channels};
    if (texture.format == TexelFormat::float32) return array_of<float>(std::vector<float>(texture.floats), shape);
    return array_of<std::uint8_t>(std::vector<std::uint8_t>(texture.bytes), shape);
}

template <class Array>
claray::Image image_from(const Array& pixels) {
    claray::Image image{unsigned(pixels.shape(1)), unsigned(pixels.shape(0)), {}};
    const auto values = span_of<glm::vec3>(pixels, 3);
    image.pixels.assign(values.begin(), values.end());
    return image;
}

void save_image(const std::string& path, const Pixels& pixels, float exposure, const std::string& tone_map) {
    const ToneMap map = kind_of("tone_map", tone_map, tone_maps);
    const nb::gil_scoped_release release;
    write_image(path, image_from(pixels), exposure, map);
}

/// Of the name, the parts (height, width, ranks, 2) and the names that have ids in them.
using MatteLayer = std::tuple<std::string, Input<float, nb::shape<-1, -1, -1, 2>>, std::vector<std::string>>;

Cryptomatte matte_of(const MatteLayer& given) {
    const auto& [name, parts, names] = given;
    Cryptomatte matte{.name = name, .ranks = unsigned(parts.shape(2)), .parts = {}, .manifest = {}};
    for (std::size_t i = 0; i < parts.size(); i += 2) matte.parts.push_back({parts.data()[i], parts.data()[i + 1]});
    for (const std::string& one : names) matte.manifest.emplace_back(one, matte_hash(one));
    return matte;
}

void save_exr(const std::string& path, unsigned width, unsigned height, const std::vector<FloatLayer>& floats,
              const std::vector<WordLayer>& words, const std::vector<MatteLayer>& mattes) {
    std::vector<ImageLayer> layers;
    for (const auto& [name, channels, pixels] : floats)
        layers.push_back({name, channels, {pixels.data(), pixels.data() + pixels.size()}, {}});
    for (const auto& [name, channels, pixels] : words)
        layers.push_back({name, channels, {}, {pixels.data(), pixels.data() + pixels.size()}});
    ImageAttributes attributes;
    for (const MatteLayer& given : mattes) {
        const Cryptomatte matte = matte_of(given);
        for (ImageLayer& layer : layers_of(matte)) layers.push_back(std::move(layer));
        for (auto& attribute : attributes_of(matte)) attributes.push_back(std::move(attribute));
    }
    const nb::gil_scoped_release release;
    write_exr(path, width, height, layers, attributes);
}

/// PNG in memory is what notebooks show; files get the same bytes.
nb::object to_bytes(const Pixels& pixels, float exposure, const std::string& tone_map) {
    const ToneMap map = kind_of("tone_map", tone_map, tone_maps);
    const float gain = std::exp2(exposure);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(pixels.size());
    for (const float value : std::span(pixels.data(), pixels.size()))
        bytes.push_back(srgb_from_linear(tone_mapped(gain * value, map)));
    return array_of<std::uint8_t>(std::move(bytes), {pixels.shape(0), pixels.shape(1), 3});
}

nb::object array_from(claray::Image&& image) {
    return array_of<float>(std::move(image.pixels), {image.height, image.width, 3});
}

Tuple error_between(const Pixels& image, const Pixels& reference) {
    const ImageError error =
        image_error(span_of<glm::vec3>(image, 3), span_of<glm::vec3>(reference, 3), unsigned(image.shape(1)));
    return nb::make_tuple(error.rmse, error.relmse, error.perceptual);
}

std::pair<Environment, std::vector<std::string>> environment_in(const std::string& path) {
    const nb::gil_scoped_release release;
    Warnings warnings;
    Environment environment = load_environment(path, warnings);
    return {std::move(environment), {warnings.begin(), warnings.end()}};
}

void bind_files(nb::module_& module) {
    module.def("save_image", &save_image);
    module.def("save_exr", &save_exr);
    module.def("matte_id", [](std::uint32_t hash) { return double(matte_id(hash)); });
    module.def("to_bytes", &to_bytes);
    module.def("image_error", &error_between);
    module.def("load_environment", &environment_in);
    module.def("load_image", [](const std::string& path, const std::string& color) {
        const TexelFormat format = kind_of("color", color, std::span(texel_formats, 2));
        const nb::gil_scoped_release release;
        return load_image(path, format);
    });
    module.def("save_texture", [](const std::string& path, const Texture& texture) {
        const nb::gil_scoped_release release;
        write_texture(path, texture);
    });
    module.def("normal_map_of", &normal_map_of);
    module.def("panorama_of", &panorama_of);
    module.def("false_color", [](const Map& values) {
        return array_from(false_color(unsigned(values.shape(1)), unsigned(values.shape(0)),
                                      {values.data(), values.data() + values.size()}));
    });
    module.def("identifier_color", [](const Identifiers& values) {
        return array_from(identifier_color(unsigned(values.shape(1)), unsigned(values.shape(0)),
                                           {values.data(), values.data() + values.size()}));
    });
}

}  // namespace

void bind_textures(nb::module_& module) {
    nb::class_<Texture> texture(module, "NativeTexture");
    texture.def_static("of_bytes", &of_bytes)
        .def_static("of_floats", &of_floats)
        .def("pixels", &pixels_of)
        .def_rw("name", &Texture::name);
    def_named(texture, "color", &Texture::format, texel_formats);
    def_named(texture, "wrap_u", &Texture::wrap_u, wraps);
    def_named(texture, "wrap_v", &Texture::wrap_v, wraps);
    def_named(texture, "filter", &Texture::filter, texture_filters);
    nb::class_<Environment>(module, "NativeEnvironment")
        .def(nb::init<>())
        .def_rw("images", &Environment::images)
        .def_rw("strength", &Environment::strength)
        .def_rw("rotation", &Environment::rotation);
    bind_files(module);
}

}  // namespace claray::python
