// Colours and numbers of scene files that may vary over a surface.
#pragma once

#include <functional>

#include "host/io/scene_textures.hpp"

namespace claray {

/// A value, or an image times a value. Scalars have three equal numbers.
struct Paint {
    glm::vec3 factor{1.f};
    TextureUse use = {};

    Paint() = default;
    Paint(const glm::vec3& value) : factor(value) {}  // NOLINT(google-explicit-constructor): a value is a paint
    Paint(float value) : factor(value) {}             // NOLINT(google-explicit-constructor)
    [[nodiscard]] bool varies() const { return use.used(); }
};

/// Makes the textures of paints. What images cannot hold as they are is computed texel by texel.
class Paints {
public:
    /// `folder`: to which the names of images are relative.
    Paints(std::filesystem::path path, Scene& scene, Warnings& warnings)
        : path_(std::move(path)), scene_(scene), textures_(scene), warnings_(warnings) {}

    /// The colours of an image, without its alpha. A missing one is grey, with a warning.
    [[nodiscard]] Paint image(const std::string& name, const TextureSettings& settings);
    /// `f` of each value; `key` names the function.
    [[nodiscard]] Paint changed(const Paint& paint, const std::string& key,
                                const std::function<glm::vec3(const glm::vec3&)>& f);
    [[nodiscard]] Paint product(const Paint& a, const Paint& b);
    /// a + amount (b - a).
    [[nodiscard]] Paint mixed(const Paint& a, const Paint& b, const Paint& amount);
    /// Squares of side 1/2 of the coordinates, `even` at the origin.
    [[nodiscard]] Paint checkerboard(const Paint& even, const Paint& odd);
    /// A paint whose colour is within 0..1, as albedos must be.
    [[nodiscard]] Paint albedo(const Paint& paint);
    /// The mean over the image.
    [[nodiscard]] glm::vec3 mean(const Paint& paint) const;
    /// As Material::specular_map and specular_weight_map read it: the colour over its largest channel, which is alpha.
    [[nodiscard]] TextureUse strength_map(const Paint& color);
    /// As Material::metallic_roughness_map reads it: the roughness to be shown, 0..1, and metal everywhere.
    [[nodiscard]] TextureUse roughness_map(const Paint& roughness);

    Warnings& warnings() { return warnings_; }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    using Texels = std::function<glm::vec3(const glm::dvec2& place)>;
    /// Where the paint is looked up: its own image if it has the coordinates of `like`, else its mean, with a warning.
    [[nodiscard]] Texels texels(const Paint& paint, const TextureUse& like);
    [[nodiscard]] Paint baked(const std::string& key, const TextureUse& like, unsigned width, unsigned height,
                              const std::function<glm::vec3(const glm::dvec2&)>& at) {
        return baked(key, like, width, height, 3, [&](const glm::dvec2& place) { return glm::vec4(at(place), 1.f); });
    }
    [[nodiscard]] Paint baked(const std::string& key, const TextureUse& like, unsigned width, unsigned height,
                              unsigned channels, const std::function<glm::vec4(const glm::dvec2&)>& at);

    std::filesystem::path path_;
    Scene& scene_;
    SceneTextures textures_;
    Warnings& warnings_;
};

}  // namespace claray
