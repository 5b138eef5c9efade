// The layers of a render's light: by lobes of the first surfaces, and by groups of lights
// (kernels/render/layers/light_layers.clh).
#pragma once

#include <string>
#include <vector>

#include "claray/renderer.hpp"
#include "claray/shared/lists/lobes.h"
#include "host/render/wavefront/wavefront.hpp"

namespace claray {

/// Layers of light that a render keeps.
[[nodiscard]] unsigned light_layers_of(const RenderConfig& config);

/// The names of these layers, in the order of Renderer::light_layers.
[[nodiscard]] std::vector<std::string> names_of_light_layers(const RenderConfig& config);

struct LightGroup {
    std::string name;
    std::vector<std::string> lights;  // by their names
};

/// The group of each light: 0 for none, else from 1 on, in the order of RenderConfig::light_groups.
struct GroupsOfLights {
    std::vector<std::uint32_t> lights, materials;  // of Scene::lights and Scene::materials
    std::uint32_t sky = 0;
};
/// Reads "NAME=light,light". Throws ErrorKind::usage for other texts, and for names that are given twice.
[[nodiscard]] std::vector<LightGroup> groups_of(const std::vector<std::string>& texts);
/// Throws ErrorKind::usage for lights that do not exist or are in another group.
[[nodiscard]] GroupsOfLights groups_of_lights(const Scene& scene, const std::vector<LightGroup>& groups);

class LightLayers {
public:
    /// The next batches of `wavefront` split their light.
    LightLayers(const Scene& scene, const RenderConfig& config, Wavefront& wavefront);

    /// After changes of lights and materials.
    void follow(const Scene& scene, Wavefront& wavefront);
    /// Adds a traced batch; asynchronous. Parameters as of Film::accumulate.
    void accumulate(const Batch& batch, const Wavefront& wavefront, const Buffer<std::uint32_t>& tables,
                    std::uint32_t listed);
    void clear();
    void resize(std::uint32_t pixels);
    /// The mean of each layer, and what is left of `image`, by the pixels' `sums`. Blocks.
    [[nodiscard]] std::vector<LightLayer> read(const std::vector<glm::vec3>& image,
                                               const std::vector<FilmPixel>& sums) const;
    [[nodiscard]] std::uint64_t bytes() const { return buffer_bytes(sums_); }

private:
    bool lobes_;
    std::vector<LightGroup> groups_;
    float sample_clamp_;
    std::uint32_t pixels_;
    Buffer<ColorSum> sums_;  // for each layer one of each pixel
    Kernel accumulate_;
};

}  // namespace claray
