// Materials, textures and spectra of pbrt.
#pragma once

#include "host/io/pbrt/pbrt_parameters.hpp"
#include "host/io/world/world.hpp"

namespace claray {

class PbrtMaterials {
public:
    explicit PbrtMaterials(World& world) : world_(world) {}

    void add_texture(const std::string& name, const std::string& of, const std::string& kind,
                     PbrtParameters parameters);
    /// A look of World for a material of a kind. Looks are made when a shape first needs them.
    [[nodiscard]] std::size_t add(const std::string& kind, PbrtParameters parameters);
    void add_named(const std::string& name, PbrtParameters parameters);
    /// Nothing for an unknown name.
    [[nodiscard]] std::optional<std::size_t> named(const std::string& name) const;
    /// The material, with the opacity of a shape's "alpha".
    [[nodiscard]] std::size_t look_of(std::size_t material, const PbrtParameters& shape);

    /// A colour of light; a spectrum that is no RGB has a luminance of 1, as pbrt normalizes it.
    [[nodiscard]] glm::vec3 light(const PbrtParameters& parameters, std::string_view name, const glm::vec3& otherwise);

private:
    struct Definition {
        std::string kind;
        PbrtParameters parameters;
        std::optional<Look> look = {};
        std::optional<std::size_t> number = {};  ///< in World
        bool in_work = false;
    };
    struct TextureDefinition {
        bool color;
        std::string kind;
        PbrtParameters parameters;
        std::optional<Paint> paint = {};
        bool in_work = false;
    };
    [[nodiscard]] const Look& look(std::size_t material);
    [[nodiscard]] Look make(const std::string& kind, const PbrtParameters& parameters);
    [[nodiscard]] Look mix(const PbrtParameters& parameters);
    [[nodiscard]] Look coated_metal(const PbrtParameters& parameters);
    [[nodiscard]] Look metal(const PbrtParameters& parameters, const std::string& prefix, const std::string& fallback);
    [[nodiscard]] Paint paint(const PbrtParameters& parameters, std::string_view name, const Paint& otherwise);
    [[nodiscard]] const Paint& texture(const std::string& name);
    [[nodiscard]] Paint make_texture(const TextureDefinition& definition);
    [[nodiscard]] Paint image(const PbrtParameters& parameters);
    [[nodiscard]] Alphas alphas(const PbrtParameters& parameters, const std::string& prefix);
    [[nodiscard]] float ior(const PbrtParameters& parameters, const std::string& name);
    void add_relief(Look& look, const PbrtParameters& parameters);
    [[nodiscard]] std::vector<SpectrumSample> samples(const PbrtParameter& parameter);

    World& world_;
    std::vector<Definition> materials_;
    std::map<std::string, std::size_t> named_;
    std::map<std::string, TextureDefinition> textures_;
    int depth_ = 0;  ///< of textures and mixtures of each other
};

}  // namespace claray
