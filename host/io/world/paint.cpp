#include "host/io/world/paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/format.hpp"
#include "host/io/image/image_file.hpp"

namespace claray {
namespace {

/// The sRGB curve (IEC 61966-2-1).
float linear_of_srgb(float s) { return s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f); }
float srgb_of_linear(float c) { return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f; }

const std::array<float, 256>& decoded_bytes(bool srgb) {
    static const auto made = [] {
        std::array<std::array<float, 256>, 2> tables{};
        for (unsigned i = 0; i < 256; ++i) tables[0][i] = float(i) / 255, tables[1][i] = linear_of_srgb(float(i) / 255);
        return tables;
    }();
    return made[srgb ? 1 : 0];
}

/// Linear.
glm::vec3 texel(const Texture& t, std::size_t i) {
    const auto value = [&](unsigned channel) {
        const std::size_t at = i * t.channels + channel;
        return t.format == TexelFormat::float32 ? t.floats[at]
                                                : decoded_bytes(t.format == TexelFormat::srgb8)[t.bytes[at]];
    };
    return t.channels < 3 ? glm::vec3(value(0)) : glm::vec3(value(0), value(1), value(2));
}

/// The texel that contains a place of 0..1.
glm::vec3 nearest_texel(const Texture& t, const glm::dvec2& place) {
    const auto index = [](double x, unsigned size) { return std::size_t(std::clamp(x * size, 0.0, double(size) - 1)); };
    return texel(t, index(place.y, t.height) * t.width + index(place.x, t.width));
}

Texture without_alpha_channel(Texture image) {
    if (image.channels == 1 || image.channels == 3) return image;
    const unsigned kept = image.channels - 1;
    const auto strip = [&](auto& values) {
        const std::size_t texels = values.size() / image.channels;
        for (std::size_t i = 0; i < texels; ++i)
            for (unsigned c = 0; c < kept; ++c) values[i * kept + c] = values[i * image.channels + c];
        values.resize(texels * kept);
    };
    strip(image.bytes), strip(image.floats);
    image.channels = kept;
    return image;
}

bool same_place(const TextureUse& a, const TextureUse& b) {
    return a.uv_set == b.uv_set && a.offset == b.offset && a.scale == b.scale && a.rotation == b.rotation;
}

TextureSettings settings_of(const Texture& texture) {
    return {texture.format, texture.wrap_u, texture.wrap_v, texture.filter};
}

std::string text_of_paint(const Paint& p) {
    const glm::vec3& f = p.factor;
    return printed("%u*%.9g,%.9g,%.9g", p.use.texture, double(f.x), double(f.y), double(f.z));
}

bool is_finite_color(const glm::vec3& c) { return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z); }

}  // namespace

Paint Paints::image(const std::string& name, const TextureSettings& settings) {
    const auto read = [&](TexelFormat format, std::size_t room) -> std::optional<Texture> {
        const std::optional<ImageFile> file = read_image_of_scene(path_, path_.parent_path(), name, warnings_);
        if (!file) return {};
        Texture texture = without_alpha_channel(decode_texture(file->bytes, file->name, format, room));
        texture.name = name;
        return texture;
    };
    Paint paint;
    if (const auto texture = textures_.add(name, settings, read))
        paint.use.texture = *texture;
    else
        paint.factor = glm::vec3(0.5f);
    return paint;
}

Paint Paints::baked(const std::string& key, const TextureUse& like, unsigned width, unsigned height, unsigned channels,
                    const std::function<glm::vec4(const glm::dvec2&)>& at) {
    TextureSettings settings;
    if (like.used()) settings = settings_of(scene_.textures[like.texture]);
    const auto make = [&](TexelFormat format, std::size_t room) -> std::optional<Texture> {
        Texture texture;
        texture.name = key, texture.width = width, texture.height = height, texture.channels = channels;
        texture.format = format;
        const std::size_t values = std::size_t(width) * height * channels;
        if (values * (format == TexelFormat::float32 ? sizeof(float) : 1) > room) {
            warnings_.push_back("'" + path_.string() + "': its textures need too much memory, and some are grey");
            return {};
        }
        for (unsigned y = 0; y < height; ++y) {
            for (unsigned x = 0; x < width; ++x) {
                const glm::vec4 color = at({(x + 0.5) / width, (y + 0.5) / height});
                for (int k = 0; k < int(channels); ++k) {
                    if (format == TexelFormat::float32) {
                        texture.floats.push_back(color[k]);
                        continue;
                    }
                    const float c = std::clamp(color[k], 0.f, 1.f);
                    const float stored = format == TexelFormat::srgb8 && k < 3 ? srgb_of_linear(c) : c;
                    texture.bytes.push_back(std::uint8_t(std::lround(255 * stored)));
                }
            }
        }
        return texture;
    };
    Paint paint;
    paint.use = like;
    const auto made = textures_.add("computed: " + key, settings, make);
    if (!made) return Paint(0.5f);
    paint.use.texture = *made;
    return paint;
}

Paints::Texels Paints::texels(const Paint& paint, const TextureUse& like) {
    if (!paint.varies()) return [color = paint.factor](const glm::dvec2&) { return color; };
    if (!same_place(paint.use, like)) {
        warnings_.push_back("'" + path_.string() +
                            "': textures of different coordinates are combined: the mean of one is used");
        return [color = mean(paint)](const glm::dvec2&) { return color; };
    }
    return [this, paint](const glm::dvec2& place) {
        return paint.factor * nearest_texel(scene_.textures[paint.use.texture], place);
    };
}

Paint Paints::changed(const Paint& paint, const std::string& key, const std::function<glm::vec3(const glm::vec3&)>& f) {
    if (!paint.varies()) return f(paint.factor);
    const unsigned width = scene_.textures[paint.use.texture].width, height = scene_.textures[paint.use.texture].height;
    const Texels at = texels(paint, paint.use);
    return baked(key + "(" + text_of_paint(paint) + ")", paint.use, width, height,
                 [&](const glm::dvec2& place) { return f(at(place)); });
}

Paint Paints::product(const Paint& a, const Paint& b) {
    if (a.varies() && b.varies()) return mixed(Paint(0.f), a, b);
    Paint result = a.varies() ? a : b;
    result.factor = a.factor * b.factor;
    return result;
}

Paint Paints::mixed(const Paint& a, const Paint& b, const Paint& amount) {
    const Paint* like = nullptr;
    for (const Paint* each : {&a, &b, &amount})
        if (each->varies() && !like) like = each;
    if (!like) return a.factor + amount.factor * (b.factor - a.factor);
    if (!a.varies() && a.factor == glm::vec3(0.f) && !(b.varies() && amount.varies())) return product(b, amount);
    const TextureUse use = like->use;
    const unsigned width = scene_.textures[use.texture].width, height = scene_.textures[use.texture].height;
    const Texels of_a = texels(a, use), of_b = texels(b, use), of_amount = texels(amount, use);
    return baked("mix(" + text_of_paint(a) + ";" + text_of_paint(b) + ";" + text_of_paint(amount) + ")", use, width,
                 height, [&](const glm::dvec2& place) {
                     const glm::vec3 from = of_a(place);
                     return from + of_amount(place) * (of_b(place) - from);
                 });
}

Paint Paints::checkerboard(const Paint& even, const Paint& odd) {
    constexpr unsigned side = 64;  // of bytes in sRGB; the borders of squares are as sharp as a texel
    const glm::vec3 a = mean(even), b = mean(odd);
    if (even.varies() || odd.varies())
        warnings_.push_back("'" + path_.string() + "': a checkerboard of textures has their means as colours");
    return baked("checkerboard(" + text_of_paint(a) + ";" + text_of_paint(b) + ")", {}, side, side,
                 [&](const glm::dvec2& place) { return (place.x < 0.5) == (place.y < 0.5) ? a : b; });
}

Paint Paints::albedo(const Paint& paint) {
    const auto within = [](const glm::vec3& c) {
        return is_finite_color(c) ? glm::clamp(c, glm::vec3(0.f), glm::vec3(1.f)) : glm::vec3(0.f);
    };
    if (within(paint.factor) == paint.factor) return paint;
    return changed(paint, "albedo", within);
}

glm::vec3 Paints::mean(const Paint& paint) const {
    if (!paint.varies()) return paint.factor;
    const Texture& texture = scene_.textures[paint.use.texture];
    const std::size_t texels = std::size_t(texture.width) * texture.height;
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < texels; ++i) sum += glm::dvec3(texel(texture, i));
    return paint.factor * glm::vec3(sum / double(texels));
}

TextureUse Paints::strength_map(const Paint& color) {
    const unsigned width = scene_.textures[color.use.texture].width, height = scene_.textures[color.use.texture].height;
    const Texels at = texels(color, color.use);
    return baked("strength(" + text_of_paint(color) + ")", color.use, width, height, 4,
                 [&](const glm::dvec2& place) {
                     const glm::vec3 c = at(place);
                     const float strength = std::max({c.x, c.y, c.z});
                     return strength > 0.f ? glm::vec4(c / strength, strength) : glm::vec4(1.f, 1.f, 1.f, 0.f);
                 })
        .use;
}

TextureUse Paints::roughness_map(const Paint& roughness) {
    const unsigned width = scene_.textures[roughness.use.texture].width,
                   height = scene_.textures[roughness.use.texture].height;
    const Texels at = texels(roughness, roughness.use);
    // glTF's channels: green is the roughness, blue is 1.
    return baked("roughness(" + text_of_paint(roughness) + ")", roughness.use, width, height,
                 [&](const glm::dvec2& place) { return glm::vec3(0.f, at(place).x, 1.f); })
        .use;
}

}  // namespace claray
