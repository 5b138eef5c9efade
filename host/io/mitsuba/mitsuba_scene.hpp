// The objects of a Mitsuba 3 scene.
#pragma once

#include "host/io/mitsuba/mitsuba_node.hpp"
#include "host/io/world/scene_film.hpp"
#include "host/io/world/world.hpp"

namespace claray {

/// Colours, textures and BSDFs.
class MitsubaMaterials {
public:
    MitsubaMaterials(const MitsubaNode& scene, World& world);

    /// The object that a node is or refers to. Null for an unknown name.
    [[nodiscard]] const MitsubaNode* resolved(const MitsubaNode& node) const;
    /// The first child that is such an object, or refers to one.
    [[nodiscard]] const MitsubaNode* child(const MitsubaNode& node, std::string_view tag) const;
    /// A look of World for a BSDF; null: Mitsuba's default.
    [[nodiscard]] std::size_t look_of(const MitsubaNode* bsdf);
    /// A colour of light, or an image of it.
    [[nodiscard]] Paint light(const MitsubaNode& emitter, std::string_view name, float otherwise);

private:
    [[nodiscard]] Look make(const MitsubaNode& bsdf, int depth);
    [[nodiscard]] Look make_nested(const MitsubaNode& bsdf, int depth);
    [[nodiscard]] Look nested(const MitsubaNode& bsdf, std::size_t index, int depth);
    [[nodiscard]] Look metal(const MitsubaNode& bsdf);
    [[nodiscard]] Look principled(const MitsubaNode& bsdf);
    [[nodiscard]] Look relief(const MitsubaNode& bsdf, int depth);
    [[nodiscard]] Alphas alphas(const MitsubaNode& bsdf, double otherwise);
    [[nodiscard]] float ior(const MitsubaNode& bsdf, double inside);
    [[nodiscard]] Paint paint(const MitsubaNode& owner, std::string_view name, const Paint& otherwise);
    [[nodiscard]] Paint value_of(const MitsubaNode& node, bool is_light, bool is_index);
    [[nodiscard]] Paint texture(const MitsubaNode& node);
    [[nodiscard]] Paint spectrum(const MitsubaNode& node, bool is_light, bool is_index);
    void index(const MitsubaNode& node);

    World& world_;
    std::map<std::string, const MitsubaNode*> by_id_;
    std::map<const MitsubaNode*, std::size_t> looks_;
};

inline constexpr SceneFilm default_film{768, 576};
/// What a film's element states.
[[nodiscard]] SceneFilm film_of(const MitsubaNode& film);

/// Follows the objects and fills a World. The world is mirrored where the camera is.
class MitsubaScene {
public:
    MitsubaScene(const MitsubaNode& scene, World& world) : scene_(scene), world_(world), materials_(scene, world) {}

    void read();

private:
    void set_camera(const MitsubaNode& sensor);
    void set_fov(const MitsubaNode& sensor, View& view);

    void add_emitter(const MitsubaNode& emitter);
    void add_image_light(const MitsubaNode& emitter);

    void add_shape(const MitsubaNode& shape);
    void add_group(const MitsubaNode& group);
    void add_instance(const MitsubaNode& instance);
    void add_surface(Mesh mesh, const MitsubaNode& shape, bool has_normals, const glm::dmat4& local);
    void add_ball(const MitsubaNode& shape);
    [[nodiscard]] std::optional<Mesh> mesh_of_file(const MitsubaNode& shape);
    [[nodiscard]] std::optional<Glow> glow(const MitsubaNode& shape);
    [[nodiscard]] std::size_t look_of(const MitsubaNode& shape);

    const MitsubaNode& scene_;
    World& world_;
    MitsubaMaterials materials_;
    glm::dmat4 mirror_{1.0};
    std::size_t groups_ = 0;
    std::map<const MitsubaNode*, std::string> names_;  ///< of groups in World
};

}  // namespace claray
