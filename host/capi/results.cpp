// claray.h: what renderers give, pictures, and image files.
#include "claray/cryptomatte.hpp"
#include "claray/image/image_error.hpp"
#include "claray/io.hpp"
#include "host/capi/members.hpp"
#include "host/capi/renderer.hpp"

using namespace claray;
using namespace claray::capi;

struct claray_cryptomatte {
    Cryptomatte matte;
    ImageAttributes attributes;
};

namespace {

static_assert(sizeof(claray_gbuffer_pixel) == sizeof(GBufferPixel));

std::size_t pixel_count(const claray_renderer& renderer) { return std::size_t(renderer.width) * renderer.height; }

/// Memory of the caller for an image of the renderer.
std::span<glm::vec3> image_room(const claray_renderer& renderer, float* rgb, std::size_t count) {
    const std::size_t pixels = pixel_count(renderer);
    static_cast<void>(room(rgb, count, 3 * pixels, "the image"));
    return {reinterpret_cast<glm::vec3*>(rgb), pixels};
}

claray_layer_info info_of(const std::string& name) {
    for (const AovRow& row : aov_rows)
        if (name == row.name) {
            const bool integer = row.kind == AovKind::identifier || row.kind == AovKind::count;
            return {0, row.meaning, std::uint32_t(std::strlen(row.letters)), integer ? 1 : 0, row.letters};
        }
    if (name.starts_with("lobe_")) return {0, "light by how the first surface sends it to the camera", 3, 0, "RGB"};
    if (name.starts_with("light_")) return {0, "light of a group of lights", 3, 0, "RGB"};
    if (name == "noise") return {0, "variance of the mean luminance, over the square of the image's mean", 1, 0, "Y"};
    if (name == "error") return {0, "half the width of the interval that holds the luminance", 1, 0, "Y"};
    if (name == "voxels") return {0, "albedo of the surface in the voxel", 3, 0, "RGB"};
    refuse("name is '" + name + "'", "use a name of the list layers (claray_names_create)");
}

template <class Pixel>
void copy_layer(const std::vector<Pixel>& pixels, void* values, std::size_t count) {
    const std::size_t bytes = pixels.size() * sizeof(Pixel);
    static_cast<void>(room(static_cast<char*>(values), 4 * count, bytes, "the layer"));
    std::memcpy(values, pixels.data(), bytes);
}

void fill_layer(Renderer& renderer, const std::string& name, void* values, std::size_t count) {
    if (name == "noise") return copy_layer(renderer.noise_map(), values, count);
    if (name == "error") return copy_layer(renderer.error_map(), values, count);
    if (name == "voxels") return copy_layer(renderer.voxels(), values, count);
    if (name.starts_with("lobe_") || name.starts_with("light_")) {
        for (const LightLayer& layer : renderer.light_layers())
            if (name == layer.name) return copy_layer(layer.pixels, values, count);
        refuse("name is '" + name + "', which the render does not keep", "see lobes and light_groups");
    }
    const Aovs aovs = renderer.aovs();
    for_each_aov(aovs, [&](const AovRow& row, const auto& pixels) {
        if (name == row.name) copy_layer(pixels, values, count);
    });
}

void check_size(std::uint32_t width, std::uint32_t height) {
    if (width == 0 || height == 0) refuse((width == 0 ? "width" : "height") + std::string(" is 0"));
}

Image image_of(const float* rgb, std::uint32_t width, std::uint32_t height) {
    const auto pixels = pixels_of(rgb, std::size_t(width) * height, "rgb");
    return {width, height, {pixels.begin(), pixels.end()}};
}

void give_pixels(const Image& image, float* rgb) {
    if (!image.pixels.empty()) std::memcpy(&required(rgb, "rgb"), image.pixels.data(), 12 * image.pixels.size());
}

}  // namespace

namespace claray::capi {

std::span<const glm::vec3> pixels_of(const float* rgb, std::size_t pixels, const char* name) {
    return array(reinterpret_cast<const glm::vec3*>(rgb), pixels, name);
}

PictureConfig picture_config_of(const claray_picture_config* given) {
    const claray_picture_config known = versioned(given, "config");
    PictureConfig config;
    config.exposure = known.exposure;
    config.tone_map = enumerator(known.tone_map, "config.tone_map");
    config.width = known.width, config.height = known.height;
    return config;
}

}  // namespace claray::capi

claray_status claray_renderer_image(claray_renderer* renderer, float* rgb, size_t count) {
    return guarded([&] {
        const claray_renderer& used = required(renderer, "renderer");
        used.renderer.image(image_room(used, rgb, count));
    });
}

claray_status claray_renderer_alpha(const claray_renderer* renderer, float* alpha, size_t count) {
    return guarded([&] {
        const claray_renderer& used = required(renderer, "renderer");
        const std::span<float> place = room(alpha, count, pixel_count(used), "the alpha");
        const std::vector<float> values = used.renderer.alpha();
        std::copy(values.begin(), values.end(), place.begin());
    });
}

claray_status claray_renderer_radiance(const claray_renderer* renderer, uint32_t width, uint32_t height,
                                       const float** rgb) {
    return guarded([&] {
        const float*& place = required(rgb, "rgb");
        place = &required(renderer, "renderer").renderer.radiance(width, height)[0][0];
    });
}

claray_status claray_denoiser_resolve(claray_denoiser denoiser, claray_denoiser* resolved) {
    return guarded([&] {
        const DenoiserKind kind = enumerator(denoiser, "denoiser");
        if (kind == DenoiserKind::oidn) require_oidn();
        put(required(resolved, "resolved"), picked_denoiser(kind));
    });
}

claray_status claray_renderer_denoised(const claray_renderer* renderer, claray_denoiser denoiser, float* rgb,
                                       size_t count) {
    return guarded([&] {
        const claray_renderer& used = required(renderer, "renderer");
        const std::span<glm::vec3> place = image_room(used, rgb, count);
        const std::vector<glm::vec3> image = used.renderer.denoised(enumerator(denoiser, "denoiser"));
        std::copy(image.begin(), image.end(), place.begin());
    });
}

claray_status claray_renderer_release_denoiser(claray_renderer* renderer) {
    return guarded([&] { required(renderer, "renderer").renderer.release_denoiser(); });
}

claray_status claray_layer_get(const char* name, claray_layer_info* info) {
    return guarded([&] { give(info, info_of(&required(name, "name")), "info"); });
}

claray_status claray_renderer_layer(claray_renderer* renderer, const char* name, void* values, size_t count) {
    return guarded([&] {
        claray_renderer& used = required(renderer, "renderer");
        const std::size_t needed = pixel_count(used) * info_of(&required(name, "name")).channels;
        static_cast<void>(room(static_cast<float*>(values), count, needed, "the layer"));
        fill_layer(used.renderer, name, values, count);
    });
}

claray_status claray_renderer_error_of(claray_renderer* renderer, const float* rgb, size_t count, double* error) {
    return guarded([&] {
        claray_renderer& used = required(renderer, "renderer");
        if (count != 3 * pixel_count(used))
            refuse("count is " + std::to_string(count) + ", and the image has " +
                   std::to_string(3 * pixel_count(used)) + " floats");
        required(error, "error") = used.renderer.error_of(pixels_of(rgb, count / 3, "rgb"));
    });
}

claray_status claray_renderer_gbuffer(const claray_renderer* renderer, claray_normal_packing packing,
                                      claray_gbuffer_pixel* pixels, size_t count, double world_from_image[16]) {
    return guarded([&] {
        const claray_renderer& used = required(renderer, "renderer");
        const std::span place = room(pixels, count, pixel_count(used), "the buffer");
        const GBuffer buffer = used.renderer.gbuffer(enumerator(packing, "packing"));
        std::memcpy(place.data(), buffer.pixels.data(), place.size_bytes());
        for (int i = 0; world_from_image && i < 16; ++i) world_from_image[i] = buffer.world_from_image[i / 4][i % 4];
    });
}

claray_status claray_gbuffer_unpack(const claray_gbuffer_pixel* pixels, uint32_t width, uint32_t height,
                                    claray_normal_packing packing, const double world_from_image[16], float* normals,
                                    float* positions) {
    return guarded([&] {
        GBuffer buffer;
        buffer.width = width, buffer.height = height, buffer.normals = enumerator(packing, "packing");
        buffer.pixels = copied<GBufferPixel>(pixels, std::size_t(width) * height, "pixels");
        if (positions) static_cast<void>(required(world_from_image, "world_from_image"));
        for (int i = 0; positions && i < 16; ++i) buffer.world_from_image[i / 4][i % 4] = world_from_image[i];
        for (std::size_t i = 0; i < buffer.pixels.size(); ++i) {
            const glm::vec3 normal = normals ? normal_of(buffer, i) : glm::vec3(0.f);
            const glm::vec3 position = positions ? position_of(buffer, i) : glm::vec3(0.f);
            if (normals) std::memcpy(normals + 3 * i, &normal, sizeof normal);
            if (positions) std::memcpy(positions + 3 * i, &position, sizeof position);
        }
    });
}

claray_status claray_renderer_picture(claray_renderer* renderer, const claray_picture_config* config,
                                      const uint8_t** rgba) {
    return guarded([&] {
        Renderer& used = required(renderer, "renderer").renderer;
        const PictureConfig known = picture_config_of(config);
        const bool denoised = versioned(config, "config").denoised != 0;
        const std::uint8_t*& place = required(rgba, "rgba");
        place = (denoised ? used.denoised_picture(known) : used.picture(known)).data();
    });
}

claray_status claray_tone_map_apply(const float* radiance, size_t count, const claray_picture_config* config,
                                    uint8_t* srgb) {
    return guarded([&] {
        const PictureConfig known = picture_config_of(config);
        const float gain = std::exp2(known.exposure);
        const std::span place = room(srgb, count, count, "srgb");
        std::size_t i = 0;
        for (const float value : array(radiance, count, "radiance"))
            place[i++] = srgb_from_linear(tone_mapped(gain * value, known.tone_map));
    });
}

float claray_linear_from_srgb(uint8_t value) { return linear_from_srgb(value); }

claray_status claray_write_image(const char* path, const float* rgb, uint32_t width, uint32_t height,
                                 const claray_picture_config* config) {
    return guarded([&] {
        const PictureConfig known = picture_config_of(config);
        check_size(width, height);
        write_image(&required(path, "path"), image_of(rgb, width, height), known.exposure, known.tone_map);
    });
}

claray_status claray_check_writable(const char* path) {
    return guarded([&] { check_writable(&required(path, "path")); });
}

claray_status claray_write_pfm(const char* path, const float* values, uint32_t width, uint32_t height) {
    return guarded([&] {
        write_pfm(&required(path, "path"), width, height, copied<float>(values, std::size_t(width) * height, "values"));
    });
}

claray_status claray_cryptomatte_create(const claray_renderer* renderer, claray_matte kind, uint32_t samples,
                                        claray_cryptomatte** matte) {
    return guarded([&] {
        hand_out(matte, "matte", [&] {
            Cryptomatte made = cryptomatte(required(renderer, "renderer").renderer, enumerator(kind, "kind"), samples);
            ImageAttributes attributes = attributes_of(made);
            return new claray_cryptomatte{std::move(made), std::move(attributes)};
        });
    });
}
claray_status claray_cryptomatte_get(const claray_cryptomatte* matte, claray_cryptomatte_info* info) {
    return guarded([&] {
        const claray_cryptomatte& of = required(matte, "matte");
        const Cryptomatte& made = of.matte;
        give(info,
             {0, made.name.c_str(), made.ranks, &made.parts[0].id, made.parts.size(),
              of.attributes.back().second.c_str()},
             "info");
    });
}
void claray_cryptomatte_release(claray_cryptomatte* matte) { delete matte; }
uint32_t claray_matte_hash(const char* name) { return name ? matte_hash(name) : 0; }
float claray_matte_id(uint32_t hash) { return matte_id(hash); }

claray_status claray_write_exr(const char* path, uint32_t width, uint32_t height, const claray_exr_layer* layers,
                               size_t count) {
    return claray_write_exr_with_mattes(path, width, height, layers, count, nullptr, 0);
}

claray_status claray_write_exr_with_mattes(const char* path, uint32_t width, uint32_t height,
                                           const claray_exr_layer* layers, size_t count,
                                           const claray_cryptomatte* const* mattes, size_t matte_count) {
    return guarded([&] {
        std::vector<ImageLayer> all;
        for (const claray_exr_layer& given : array(layers, count, "layers")) {
            if (!given.values == !given.numbers)
                refuse("layers: '" + text_of(given.name) + "' needs values or numbers", "give one of them");
            ImageLayer& layer = all.emplace_back();
            layer.name = text_of(given.name), layer.channels = &required(given.channels, "layers: channels");
            const std::size_t elements = std::size_t(width) * height * layer.channels.size();
            if (given.values) layer.values = copied<float>(given.values, elements, "layers: values");
            if (given.numbers) layer.numbers = copied<std::uint32_t>(given.numbers, elements, "layers: numbers");
        }
        ImageAttributes attributes;
        for (const claray_cryptomatte* given : array(mattes, matte_count, "mattes")) {
            const claray_cryptomatte& matte = required(given, "mattes");
            for (ImageLayer& layer : layers_of(matte.matte)) all.push_back(std::move(layer));
            attributes.insert(attributes.end(), matte.attributes.begin(), matte.attributes.end());
        }
        write_exr(&required(path, "path"), width, height, all, attributes);
    });
}

claray_status claray_false_color(const float* values, size_t count, float* rgb) {
    return guarded([&] { give_pixels(false_color(unsigned(count), 1, copied<float>(values, count, "values")), rgb); });
}
claray_status claray_identifier_color(const uint32_t* numbers, size_t count, float* rgb) {
    return guarded([&] {
        give_pixels(identifier_color(unsigned(count), 1, copied<std::uint32_t>(numbers, count, "numbers")), rgb);
    });
}

claray_status claray_image_compare(const float* rgb, const float* reference, uint32_t width, uint32_t height,
                                   claray_image_error* error) {
    return guarded([&] {
        check_size(width, height);
        const std::size_t pixels = std::size_t(width) * height;
        const ImageError known =
            image_error(pixels_of(rgb, pixels, "rgb"), pixels_of(reference, pixels, "reference"), width);
        give(error, {sizeof(claray_image_error), known.rmse, known.relmse, known.perceptual}, "error");
    });
}
