// The statements of a pbrt file.
#pragma once

#include <map>

#include "host/io/pbrt/pbrt_materials.hpp"
#include "host/io/world/scene_film.hpp"

namespace claray {

/// The film of a statement whose first word was read. Its exposure is that of the film's speed alone.
[[nodiscard]] SceneFilm next_film(PbrtTokens& tokens);

/// Follows the statements and fills a World. pbrt's cameras look along +z with +x to the right, which mirrors a scene
/// in right-handed coordinates; the whole world is mirrored where the camera itself is not.
class PbrtScene {
public:
    PbrtScene(const std::filesystem::path& path, World& world) : tokens_(path), world_(world), materials_(world) {}

    void read();

private:
    struct AreaLight {
        PbrtParameters parameters;
        bool on = false;
    };
    struct State {
        glm::dmat4 to_world{1.0};
        bool reversed = false;
        std::size_t material = 0;
        AreaLight lamp = {};
        std::map<std::string, PbrtParameters> defaults = {};  ///< of the statement Attribute
        bool moves_start = true;                              ///< statements change the transform at shutter open
    };
    void follow(const std::string& statement);
    [[nodiscard]] bool follow_transform(const std::string& statement);
    void follow_blocks(const std::string& statement);
    void set_camera();
    void set_film();
    void push();
    void pop();
    void apply(const glm::dmat4& transform);
    [[nodiscard]] glm::dmat4 next_matrix();
    [[nodiscard]] PbrtParameters parameters_of(const std::string& target);
    /// From the coordinates in which the current statement is to those of the scene or of the object.
    [[nodiscard]] glm::dmat4 placed() const;

    void add_light();
    void add_infinite(const PbrtParameters& p);
    void add_image_light(const std::string& name, const glm::vec3& scale);

    void add_shape();
    void add_shape(const std::string& kind, const PbrtParameters& p);
    void add_mesh(Mesh mesh, const PbrtParameters& p);
    void add_sphere(const PbrtParameters& p);
    void add_curve(const PbrtParameters& p);
    [[nodiscard]] Mesh triangle_mesh(const PbrtParameters& p, unsigned corners);
    [[nodiscard]] std::optional<Glow> glow(double area);

    PbrtTokens tokens_;
    World& world_;
    PbrtMaterials materials_;
    State now_;
    std::vector<State> stack_;
    std::map<std::string, glm::dmat4> systems_;
    glm::dmat4 mirror_{1.0};
    std::string object_;
    View view_;
    PbrtParameters film_;
    bool has_camera_ = false, in_world_ = false;
};

}  // namespace claray
