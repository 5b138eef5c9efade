// The alpha of an image, and what shadow catchers add to it: kernels/render/layers/mask_paths.cl.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "claray/renderer.hpp"
#include "host/render/film/film.hpp"
#include "host/render/wavefront/wavefront.hpp"

namespace claray {

/// The scene as light finds it if only its shadow catchers and its lights are there.
[[nodiscard]] Scene scene_of_catchers(const Scene& scene);

class Matte {
public:
    /// `scene` has the materials of the render; with shadow catchers a second renderer traces `scene_of_catchers`.
    Matte(const Device& device, const Scene& scene, const RenderConfig& config);

    [[nodiscard]] static KernelSet programs(const Device& device, const StructureFormat& structure);

    /// Takes the samples of a batch whose radiance was traced, and leaves in it what surfaces show; asynchronous.
    /// `in_film`: the batch as the film numbers its pixels.
    void take(const Batch& batch, const Batch& in_film, Wavefront& wavefront);
    /// Leaves in the radiance of a batch what surfaces show, for pixels beside the image.
    void hide(const Batch& batch, Wavefront& wavefront);

    [[nodiscard]] bool has_catchers() const { return catchers_.has_value(); }
    [[nodiscard]] std::vector<float> alpha() const;
    /// Adds what shadow catchers show to an image of the film in this size.
    void finish(const ImageSizes& size, std::span<glm::vec3> image) const;
    /// An image for as long as the next one is not made.
    [[nodiscard]] std::vector<glm::vec3>& room() { return image_; }

    void clear();
    void resize(unsigned width, unsigned height);
    /// Throws ErrorKind::usage if shadow catchers cannot follow the changes.
    void follow(const Scene& scene, const SceneChanges& changes);
    [[nodiscard]] std::uint64_t bytes() const;

private:
    struct Catchers {
        Renderer without;    // of the scene without what casts shadows
        Film caught, empty;  // light of catchers with the other surfaces, and without them
        Buffer<float> radiance;
    };
    void mask(const Batch& batch, Wavefront& wavefront);
    void trace_without(const Batch& batch, const Batch& in_film, const Wavefront& wavefront);

    Device device_;
    float sample_clamp_;
    Buffer<std::uint32_t> roles_;
    Film coverage_;
    Buffer<float> weights_;  // of each path
    std::optional<Catchers> catchers_;
    std::vector<glm::vec3> image_;
};

}  // namespace claray
