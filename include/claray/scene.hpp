// What is to be rendered: meshes, materials, lights, sky and camera, on the host.
#pragma once

#include <optional>
#include <span>

#include "claray/mesh.hpp"
#include "claray/shared/scene.h"
#include "claray/texture.hpp"

namespace claray {

/// MaterialKind::lambert, mirror, glass, metal, blinn_phong, principled and unlit: those of CLARAY_MATERIAL_KINDS.
enum class MaterialKind : std::uint32_t {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) name = CLARAY_##NAME,
    CLARAY_MATERIAL_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// What claray/shared/bsdfs.h says of a kind.
struct MaterialKindRow {
    MaterialKind kind;
    const char* name;      ///< for users: "blinn-phong"
    bool transmits;        ///< light goes through
    bool reads_roughness;  ///< Material::roughness and its map count
};
inline constexpr MaterialKindRow material_kinds[] = {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) {MaterialKind::name, text, transmits != 0, rough != 0},
    CLARAY_MATERIAL_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// Null for a number that is no kind.
[[nodiscard]] constexpr const MaterialKindRow* row_of(MaterialKind kind) {
    for (const MaterialKindRow& row : material_kinds)
        if (row.kind == kind) return &row;
    return nullptr;
}
[[nodiscard]] constexpr bool transmits(MaterialKind kind) { return row_of(kind) && row_of(kind)->transmits; }
[[nodiscard]] constexpr bool reads_roughness(MaterialKind kind) {
    return row_of(kind) && row_of(kind)->reads_roughness;
}

/// What the opacity does (glTF's alphaMode).
enum class AlphaMode : std::uint32_t {
    opaque,  ///< nothing
    mask,    ///< the surface is there where the opacity reaches `alpha_cutoff`
    blend    ///< it is there with the opacity as probability
};

/// Colours are linear Rec. 709. A texture multiplies the value beside it.
struct Material {
    std::string name;
    MaterialKind kind = MaterialKind::lambert;
    /// Lambert, Blinn-Phong: diffuse albedo; mirror and metal: reflectance at normal incidence; glass: tint of what is
    /// transmitted; principled: glTF's base colour.
    glm::vec3 albedo{0.7f};
    glm::vec3 emission{0.f};  ///< radiance of the front and the back, W / (m^2 sr)
    float roughness = 0.3f;   ///< metal, glass, principled: 0..1; GGX alpha = roughness^2
    float ior = 1.5f;         ///< glass, principled

    float metallic = 0.f;      ///< principled: 0 a dielectric, 1 a metal
    float transmission = 0.f;  ///< principled: share of the dielectric's base that refracts instead of scattering
    bool thin_walled = false;  ///< glass, principled: a wall that does not bend what it transmits, not a solid's border
    float clearcoat = 0.f;     ///< principled: share of a dielectric coat of index 1.5
    float clearcoat_roughness = 0.f;  ///< 0..1
    glm::vec3 specular{0.f};          ///< Blinn-Phong: the highlight's colour

    // Layers of the principled kind, as glTF's extension of that name describes each.
    float specular_weight = 1.f;      ///< 0..1, strength of the dielectric's reflection (KHR_materials_specular)
    glm::vec3 specular_tint{1.f};     ///< multiplies its reflectance at normal incidence; may exceed 1
    glm::vec3 sheen{0.f};             ///< 0..1, colour of the fibres (KHR_materials_sheen)
    float sheen_roughness = 0.f;      ///< 0..1
    float anisotropy = 0.f;           ///< 0..1, stretches highlights (KHR_materials_anisotropy)
    float anisotropy_rotation = 0.f;  ///< radians, counter-clockwise from the tangent; along it they are stretched
    float iridescence = 0.f;          ///< 0..1, share of a thin film (KHR_materials_iridescence)
    float iridescence_ior = 1.3f;     ///< of the film
    glm::vec2 film_thickness{100.f, 400.f};  ///< nanometres where its map is 0 and where it is 1 (or absent)

    /// Beer's law inside: `attenuation` of white is left after `attenuation_distance`. 0: nothing is absorbed.
    glm::vec3 attenuation{1.f};
    float attenuation_distance = 0.f;

    float opacity = 1.f;
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool cull_back =
        false;  ///< rays pass through where they meet the back (glTF: doubleSided = false); solid glass has both

    TextureUse albedo_map;               ///< RGB; its alpha multiplies the opacity
    TextureUse emission_map;             ///< RGB
    TextureUse metallic_roughness_map;   ///< green: roughness, blue: metallic (glTF)
    TextureUse transmission_map;         ///< red
    TextureUse clearcoat_map;            ///< red: clearcoat
    TextureUse clearcoat_roughness_map;  ///< green: its roughness
    TextureUse clearcoat_normal_map;     ///< as normal_map; without it the coat lies on the mesh's own normals
    float clearcoat_normal_scale = 1.f;
    TextureUse specular_map;         ///< RGB: specular_tint; Blinn-Phong: specular
    TextureUse specular_weight_map;  ///< alpha: specular_weight
    TextureUse shininess_map;        ///< red: shininess
    TextureUse sheen_map;            ///< RGB: sheen
    TextureUse sheen_roughness_map;  ///< alpha: its roughness
    TextureUse anisotropy_map;       ///< red and green: direction, 0.5 is 0; blue: anisotropy
    TextureUse iridescence_map;      ///< red: iridescence
    TextureUse film_thickness_map;   ///< green: from the first thickness to the second
    TextureUse opacity_map;          ///< red
    TextureUse normal_map;           ///< tangent space, 0.5 is 0; +x to the right and +y up in the image, that is along
                                     ///< decreasing v (glTF, OpenGL)
    float normal_scale = 1.f;
    TextureUse height_map;  ///< red, times `height_scale` in units of the scene; shifts the normal only
    float height_scale = 1.f;
    TextureUse light_map;  ///< RGB irradiance that is used in place of light from elsewhere

    // `shininess` (Blinn-Phong: the highlight's exponent); those of CLARAY_BSDF_PARAMETERS.
#define CLARAY_ROW(name, text, standard, check) float name = standard;
    CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// LightKind::point, spot and directional: a row of claray/shared/lights.h each.
enum class LightKind : std::uint32_t {
#define CLARAY_ROW(name, NAME, text, far, cone) name = CLARAY_##NAME##_LIGHT,
    CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
};

struct LightTraits {
    LightKind kind;
    const char* name;
    bool far;   ///< shines on the whole scene from one direction
    bool cone;  ///< has a direction, and shines within `Light::outer_angle` of it
    bool seen;  ///< has an extent: rays that leave the scene meet it
};
inline constexpr LightTraits light_kinds[] = {
#define CLARAY_ROW(name, NAME, text, far, cone) {LightKind::name, text, (far) != 0, (cone) != 0, false},
    CLARAY_HIDDEN_LIGHTS(CLARAY_ROW)
#undef CLARAY_ROW
#define CLARAY_ROW(name, NAME, text, far, cone) {LightKind::name, text, (far) != 0, (cone) != 0, true},
        CLARAY_SEEN_LIGHTS(CLARAY_ROW)
#undef CLARAY_ROW
};
/// Null where there is no such kind.
[[nodiscard]] constexpr const LightTraits* traits_of(LightKind kind) {
    for (const LightTraits& traits : light_kinds)
        if (traits.kind == kind) return &traits;
    return nullptr;
}

/// A light that is neither a mesh nor an image.
struct Light {
    std::string name;
    LightKind kind = LightKind::point;
    glm::vec3 position{0.f};
    glm::vec3 direction{0.f, -1.f, 0.f};  ///< in which it shines; not for points
    glm::vec3 intensity{1.f};             ///< W / sr; far lights: irradiance of a surface that faces it, W / m^2
    float inner_angle = 0.f;              ///< near cones: radians from the axis, up to which it shines fully
    float outer_angle = 0.785398163f;     ///< cones: radians from the axis, beyond which it does not shine
    float range = 0.f;                    ///< beyond which it fades to nothing (KHR_lights_punctual); 0: none
    /// a0, a1, a2: intensity / (a0 + a1 d + a2 d^2) at distance d; the physical inverse square is 0, 0, 1.
    glm::vec3 attenuation{0.f, 0.f, 1.f};
};

[[nodiscard]] inline Light point_light(const glm::vec3& position, const glm::vec3& intensity) {
    Light light;
    light.position = position, light.intensity = intensity;
    return light;
}

/// Radiance of rays that leave the scene, from `horizon` (and below) to `zenith`. Black unless set.
struct Sky {
    glm::vec3 horizon{0.f};
    glm::vec3 zenith{0.f};
};

/// An image around the scene, in place of the sky.
struct Environment {
    /// One image: latitude and longitude, its middle column towards -z and +y at the top. Six: the faces +x -x +y -y +z
    /// -z of a cube, as OpenGL orients them. Linear or sRGB; none: there is no environment.
    std::vector<Texture> images;
    float strength = 1.f;
    float rotation = 0.f;  ///< radians about +y, counter-clockwise seen from above
};

struct Camera {
    glm::vec3 position{0.f, 0.f, 5.f};
    glm::vec3 target{0.f};
    glm::vec3 up{0.f, 1.f, 0.f};
    float vertical_fov = 40.f;    ///< degrees
    float aperture_radius = 0.f;  ///< of a thin lens; 0: a pinhole
    float focus_distance = 0.f;   ///< of the plane that is sharp, along the view; 0: the target's
    std::optional<glm::vec3> position_end = {}, target_end = {};  ///< when the shutter closes, where the camera moves
    /// Of the image, in units of the scene: all rays are parallel then and begin in the plane through the position, and
    /// `vertical_fov` is not used. 0: perspective.
    float orthographic_height = 0.f;
};

/// A mesh placed in the scene.
struct MeshInstance {
    std::uint32_t mesh = 0;
    glm::mat4 transform{1.f};                     ///< affine, invertible
    std::optional<glm::mat4> transform_end = {};  ///< when the shutter closes, where it moves; the path is linear
};

struct Scene {
    std::string name;
    std::vector<Mesh> meshes;
    std::vector<MeshInstance> instances;  ///< empty: every mesh once, where it is
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Light> lights;
    Sky sky;
    Environment environment;
    std::optional<Camera> camera;  ///< empty: `automatic_camera` looks at the whole
};

/// Of all that is placed in it, the ends of motion included; of what is turned, the box of its turned box.
[[nodiscard]] Bounds bounds_of(const Scene& scene);
/// Of all that is placed in it.
[[nodiscard]] std::size_t triangle_count(const Scene& scene);

/// Looks at the centre of the bounds from the front, a little from above and from the right, so far away that the
/// bounding sphere just fits. A scene without extent is looked at from distance 1.
[[nodiscard]] Camera automatic_camera(const Bounds& bounds, float vertical_fov = 40.f, float aspect = 1.f);

/// Camera as kernels read it. `aspect` = width / height. Throws ErrorKind::usage where at some time the position is the
/// target or `up` is parallel to the view, the angle is outside (0, 180), the orthographic height is negative or not
/// finite, or the lens is no lens.
[[nodiscard]] CameraData camera_data(const Camera& camera, float aspect);
/// Whether it moves while the shutter is open.
[[nodiscard]] bool moves(const Camera& camera);

/// Throws ErrorKind::user, naming the thing and the value, where an index is out of range, an array has the wrong
/// length, a value is not finite, negative or not in 0..1 where it must be, an instance's transform is not affine or
/// can't be inverted, or an environment is neither one image nor a cube. Positions may be anything: triangles that are
/// not finite are culled and counted when the structure is built.
void validate(const Scene& scene);

/// The built-in scenes: "cornell", "spheres", "crate", "hills", "effects" (all of them), "effect:NAME" (one of them, by
/// the name that `claray explain` gives it), "terrain:N", "soup:N", "fan:N", "hair:N" (N
/// triangles). Nothing where `name` is none of them. Throws ErrorKind::usage for a bad N.
[[nodiscard]] std::optional<Scene> builtin_scene(const std::string& name);
[[nodiscard]] std::span<const char* const> builtin_scene_names();

}  // namespace claray
