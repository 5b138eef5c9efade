// What is to be rendered: meshes, materials, lights, sky and camera, on the host.
#pragma once

#include <optional>
#include <span>

#include "claray/mesh.hpp"
#include "claray/shared/scene.h"

namespace claray {

enum class MaterialKind : std::uint32_t {
    lambert = CLARAY_LAMBERT,
    mirror = CLARAY_MIRROR,
    glass = CLARAY_GLASS,
    metal = CLARAY_METAL
};

/// Colours are linear Rec. 709.
struct Material {
    std::string name;
    MaterialKind kind = MaterialKind::lambert;
    glm::vec3 albedo{0.7f};   ///< Lambert: albedo; mirror and metal: reflectance at normal incidence; glass: tint
    glm::vec3 emission{0.f};  ///< radiance of the front and the back, W / (m^2 sr)
    float roughness = 0.3f;   ///< metal only, 0..1; GGX alpha = roughness^2
    float ior = 1.5f;         ///< glass only
};

struct PointLight {
    glm::vec3 position{0.f};
    glm::vec3 intensity{1.f};  ///< W / sr
};

/// Radiance of rays that leave the scene, from `horizon` (and below) to `zenith`. Black unless set.
struct Sky {
    glm::vec3 horizon{0.f};
    glm::vec3 zenith{0.f};
};

/// A pinhole camera.
struct Camera {
    glm::vec3 position{0.f, 0.f, 5.f};
    glm::vec3 target{0.f};
    glm::vec3 up{0.f, 1.f, 0.f};
    float vertical_fov = 40.f;  ///< degrees
};

struct Scene {
    std::string name;
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<PointLight> point_lights;
    Sky sky;
    std::optional<Camera> camera;  ///< empty: `automatic_camera` looks at the whole
};

[[nodiscard]] Bounds bounds_of(const Scene& scene);
[[nodiscard]] std::size_t triangle_count(const Scene& scene);

/// Looks at the centre of the bounds from the front, a little from above and from the right, so far away that the
/// bounding sphere just fits. A scene without extent is looked at from distance 1.
[[nodiscard]] Camera automatic_camera(const Bounds& bounds, float vertical_fov = 40.f, float aspect = 1.f);

/// Camera as kernels read it. `aspect` = width / height. Throws ErrorKind::usage where the position is the target, `up`
/// is parallel to the view, or the angle is outside (0, 180).
[[nodiscard]] CameraData camera_data(const Camera& camera, float aspect);

/// Throws ErrorKind::user where an index is out of range (naming the mesh and the triangle), a per-vertex or
/// per-triangle array has the wrong length, or a material value is not finite or negative. Positions may be anything:
/// triangles that are not finite are culled and counted when the structure is built.
void validate(const Scene& scene);

/// The built-in scenes: "cornell", "spheres", "crate", "hills", "terrain:N", "soup:N", "fan:N", "hair:N" (N
/// triangles). Nothing where `name` is none of them. Throws ErrorKind::usage for a bad N.
[[nodiscard]] std::optional<Scene> builtin_scene(const std::string& name);
[[nodiscard]] std::span<const char* const> builtin_scene_names();

}  // namespace claray
