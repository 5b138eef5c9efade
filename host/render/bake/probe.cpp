// Light that arrives at a point: six perspective views, and their conversion to one panorama.
#include <algorithm>
#include <optional>

#include "claray/renderer.hpp"
#include "host/lights/environment.hpp"

namespace claray {
namespace {

struct Face {
    const char* name;
    glm::vec3 forward, up;
};
/// In the order of Environment::images.
const Face faces[] = {{"px", {1, 0, 0}, {0, 1, 0}},  {"nx", {-1, 0, 0}, {0, 1, 0}}, {"py", {0, 1, 0}, {0, 0, -1}},
                      {"ny", {0, -1, 0}, {0, 0, 1}}, {"pz", {0, 0, 1}, {0, 1, 0}},  {"nz", {0, 0, -1}, {0, 1, 0}}};

/// Faces of a cube are seen from outside (OpenGL 4.6, table 8.19), a camera looks from inside: left and right are
/// exchanged.
Texture mirrored(const std::vector<glm::vec3>& image, unsigned size, const char* name) {
    Texture texture;
    texture.name = name, texture.width = texture.height = size, texture.channels = 3;
    texture.format = TexelFormat::float32, texture.filter = Filter::bilinear;
    texture.wrap_u = texture.wrap_v = Wrap::clamp;
    for (std::size_t y = 0; y < size; ++y)
        for (std::size_t x = size; x-- > 0;)
            for (int k = 0; k < 3; ++k) texture.floats.push_back(image[y * size + x][k]);
    return texture;
}

}  // namespace

Environment render_probe(const Device& device, Scene scene, const glm::vec3& position, RenderConfig config) {
    config.width = config.height;
    const glm::vec3 size = glm::abs(position);
    const float away = std::max({1.f, size.x, size.y, size.z});  // so that rounding does not turn the view
    Environment probe;
    std::optional<Renderer> renderer;
    for (const Face& face : faces) {
        scene.camera = Camera{position, position + away * face.forward, face.up, 90.f};
        if (renderer)
            renderer->update(scene, {.camera = true});
        else
            renderer.emplace(device, scene, config);
        renderer->render();
        probe.images.push_back(mirrored(renderer->image(), config.height, face.name));
    }
    return probe;
}

Texture panorama_of(const Environment& environment) {
    const EnvironmentImage image = environment_image(environment);
    Texture panorama;
    panorama.width = image.width, panorama.height = image.height, panorama.channels = 3;
    panorama.format = TexelFormat::float32, panorama.filter = Filter::bilinear;
    panorama.floats = image.texels;
    return panorama;
}

}  // namespace claray
