// A scene in the making: what the readers of pbrt's and Mitsuba's files share.
#pragma once

#include <optional>
#include <set>

#include "host/io/world/looks.hpp"

namespace claray {

/// Light of a surface.
struct Glow {
    Paint radiance{0.f};
    bool both_sides = false;
};

/// Gives a spot the cone from `inner` to `outer`, in radians, between which a file's falloff has the mean `share` over
/// cosines. claray's falls off in another way (KHR_lights_punctual): its inner angle is that with which the light has
/// as much power.
void set_cone(Light& light, double inner, double outer, double share);

/// A direction to the radiance that comes from there.
using Radiance = std::function<glm::dvec3(const glm::dvec3& direction)>;

/// The lens and the picture of a camera.
struct View {
    glm::dmat4 to_world{1.0};  ///< columns: right, up, forward, position; no scale and no mirror
    Projection projection = Projection::perspective;
    double fov = 90;  ///< degrees, along the axis of `fov_along`
    enum class Along { width, height, shorter, longer, diagonal } fov_along = Along::shorter;
    double half_height = 1;             ///< parallel rays: half of the image's height, units of the scene
    double width = 1280, height = 720;  ///< pixels
    double lens_radius = 0, focus_distance = 0;
};

class World {
public:
    World(const std::filesystem::path& path, Warnings& warnings);

    [[nodiscard]] Paints& paints() { return paints_; }
    /// A warning that names the file; each text once.
    void warn(const std::string& text);

    /// The triangles of a mesh's file, as `load` reads them; nothing if the file is missing, with a warning. Materials
    /// of the file are left to the scene.
    using LoadScene = Scene (*)(const std::filesystem::path&, Warnings&, const LoadOptions&);
    [[nodiscard]] std::optional<Mesh> mesh_file(const std::string& name, LoadScene load);
    [[nodiscard]] std::optional<Mesh> mesh_file(const std::string& name,
                                                const std::function<Mesh(const std::filesystem::path&)>& load);

    /// A look for `add`.
    [[nodiscard]] std::size_t add_look(Look look);
    /// Surfaces from here on belong to a group, which is placed later; empty: to the scene.
    void set_group(const std::string& name);
    [[nodiscard]] bool has_group(const std::string& name) const { return groups_.count(name) != 0; }
    /// A mesh, whose coordinates are moved by `to_world`. Without normals it is flat. Triangles face as their normals
    /// do.
    void add(Mesh mesh, const glm::dmat4& to_world, std::size_t look, const std::optional<Glow>& glow);
    /// A ball of radius 1; `turned`: its front is inside. Traced as it is where claray can.
    void add_ball(const glm::dmat4& to_world, std::size_t look, const std::optional<Glow>& glow, bool turned);
    void add_primitives(PrimitiveSet set, std::size_t look);
    [[nodiscard]] bool in_group() const { return group_ != nullptr; }
    void place(const std::string& group, const glm::dmat4& to_world);

    void add(const Light& light) { scene_.lights.push_back(light); }
    /// Light from all around: a constant, or a function that is sampled in `width` x `height` directions. They add up.
    void add_surroundings(const glm::vec3& radiance) { sky_ += radiance; }
    void add_surroundings(unsigned width, unsigned height, Radiance radiance);
    void set_view(const View& view) { view_ = view; }

    /// Throws ErrorKind::user if there is nothing to see.
    [[nodiscard]] Scene take();

private:
    struct Placed {
        std::uint32_t mesh;
        glm::mat4 transform;
    };
    [[nodiscard]] std::uint32_t material_of(std::size_t look);
    [[nodiscard]] std::uint32_t add_material(Material material);
    void add_part(Mesh mesh, std::uint32_t material);
    void add_back(Mesh mesh);
    void add_lamp(Mesh mesh, const Look& look, const Glow& glow);
    void add_sky();
    void add_camera();

    std::filesystem::path path_;
    Scene scene_;
    Warnings& warnings_;
    Paints paints_;
    std::set<std::string> warned_;
    std::vector<Look> looks_;
    std::map<std::size_t, std::uint32_t> materials_;
    std::optional<std::uint32_t> black_back_;
    std::map<std::string, std::vector<std::uint32_t>> groups_;
    std::vector<std::uint32_t>* group_ = nullptr;
    std::vector<Placed> placed_;
    bool has_placed_groups_ = false;
    glm::vec3 sky_{0.f};
    std::vector<Radiance> around_;
    unsigned around_width_ = 0, around_height_ = 0;
    std::optional<View> view_;
};

}  // namespace claray
