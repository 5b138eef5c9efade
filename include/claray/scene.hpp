// The scene on the host: meshes, materials, lights, sky and camera.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "claray/mesh.hpp"
#include "claray/primitives/primitive_set.hpp"
#include "claray/shared/lists/projections.h"
#include "claray/shared/lists/sky.h"
#include "claray/shared/scene.h"
#include "claray/texture.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// MaterialKind::lambert, mirror, glass, metal, blinn_phong, principled and unlit: the rows of CLARAY_MATERIAL_KINDS;
/// and MaterialKind::custom (add_bsdf).
enum class MaterialKind : std::uint32_t {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) name = CLARAY_##NAME,
    CLARAY_MATERIAL_KINDS(CLARAY_ROW) CLARAY_CUSTOM_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// Properties of a material kind, from claray/shared/lists/bsdfs.h.
struct MaterialKindRow {
    MaterialKind kind;
    const char* name;      ///< name for users: "blinn-phong"
    bool transmits;        ///< light passes through
    bool reads_roughness;  ///< uses Material::roughness and its map
};
/// All but MaterialKind::custom.
inline constexpr MaterialKindRow material_kinds[] = {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) {MaterialKind::name, text, transmits != 0, rough != 0},
    CLARAY_MATERIAL_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// Returns null for MaterialKind::custom and for an invalid number.
[[nodiscard]] constexpr const MaterialKindRow* row_of(MaterialKind kind) {
    for (const MaterialKindRow& row : material_kinds)
        if (row.kind == kind) return &row;
    return nullptr;
}
[[nodiscard]] constexpr bool transmits(MaterialKind kind) { return row_of(kind) && row_of(kind)->transmits; }
[[nodiscard]] constexpr bool reads_roughness(MaterialKind kind) {
    return kind == MaterialKind::custom || (row_of(kind) && row_of(kind)->reads_roughness);
}

/// How the opacity is used (glTF's alphaMode).
enum class AlphaMode : std::uint32_t {
    opaque,  ///< ignored
    mask,    ///< the surface exists where the opacity reaches `alpha_cutoff` (or as `alpha_test` says)
    blend    ///< the surface exists with the opacity as probability
};

/// The masks that exist: those whose opacity is ... `alpha_cutoff`. glTF has only greater_equal.
enum class AlphaTest : std::uint32_t { greater_equal, greater, less, less_equal, equal, not_equal };

/// What a camera ray that meets the surface first adds to an image with alpha (RenderConfig::alpha). Light and other
/// rays meet it like any other.
enum class MaterialRole : std::uint32_t {
    surface,        ///< its light, and an alpha of 1
    holdout,        ///< nothing: what is behind it is cut out, too
    shadow_catcher  ///< only what the other surfaces change of its light, by alpha and colour
};

/// Surface properties. Colours are linear Rec. 709. A texture multiplies the corresponding value.
struct Material {
    std::string name = {};
    MaterialKind kind = MaterialKind::lambert;
    /// Lambert, Blinn-Phong: diffuse albedo; mirror and metal: reflectance at normal incidence; glass: tint of
    /// transmitted light; principled: glTF's base colour.
    glm::vec3 albedo{0.7f};
    glm::vec3 emission{0.f};  ///< radiance of the front and the back, W / (m^2 sr)
    float roughness = 0.3f;   ///< metal, glass, principled: 0..1; GGX alpha = roughness^2
    float ior = 1.5f;         ///< glass, principled

    float metallic = 0.f;      ///< principled: 0 is a dielectric, 1 a metal
    float transmission = 0.f;  ///< principled: share of the dielectric's base that refracts instead of scattering
    bool thin_walled = false;  ///< glass, principled: a thin wall without refraction, not the border of a solid
    float clearcoat = 0.f;     ///< principled: share of a dielectric coat of index 1.5
    float clearcoat_roughness = 0.f;  ///< 0..1
    glm::vec3 specular{0.f};          ///< Blinn-Phong: colour of the highlight

    // Layers of the principled kind. The glTF extension in parentheses describes each layer.
    float specular_weight = 1.f;      ///< 0..1, strength of the dielectric's reflection (KHR_materials_specular)
    glm::vec3 specular_tint{1.f};     ///< multiplies its reflectance at normal incidence; may exceed 1
    glm::vec3 sheen{0.f};             ///< 0..1, colour of the fibres (KHR_materials_sheen)
    float sheen_roughness = 0.f;      ///< 0..1
    float anisotropy = 0.f;           ///< 0..1, stretches highlights (KHR_materials_anisotropy)
    float anisotropy_rotation = 0.f;  ///< radians, counter-clockwise from the tangent, to the direction of stretching
    float iridescence = 0.f;          ///< 0..1, share of a thin film (KHR_materials_iridescence)
    float iridescence_ior = 1.3f;     ///< index of refraction of the film
    glm::vec2 film_thickness{100.f, 400.f};  ///< nanometres, where its map is 0 and where it is 1 (or absent)

    /// Beer's law inside: white light is reduced to `attenuation` after `attenuation_distance`. 0: no absorption.
    glm::vec3 attenuation{1.f};
    float attenuation_distance = 0.f;

    float opacity = 1.f;
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    AlphaTest alpha_test = AlphaTest::greater_equal;
    bool cull_back = false;  ///< rays pass through the back (glTF: doubleSided = false); ignored for solid glass
    MaterialRole role = MaterialRole::surface;  ///< in images with alpha

    TextureUse albedo_map = {};               ///< RGB; its alpha multiplies the opacity
    TextureUse emission_map = {};             ///< RGB
    TextureUse metallic_roughness_map = {};   ///< green: roughness, blue: metallic (glTF)
    TextureUse transmission_map = {};         ///< red
    TextureUse clearcoat_map = {};            ///< red: clearcoat
    TextureUse clearcoat_roughness_map = {};  ///< green: its roughness
    TextureUse clearcoat_normal_map = {};     ///< as normal_map; if unused, the coat has the normals of the mesh
    float clearcoat_normal_scale = 1.f;
    TextureUse specular_map = {};         ///< RGB: specular_tint; Blinn-Phong: specular
    TextureUse specular_weight_map = {};  ///< alpha: specular_weight
    TextureUse shininess_map = {};        ///< red: shininess
    TextureUse sheen_map = {};            ///< RGB: sheen
    TextureUse sheen_roughness_map = {};  ///< alpha: sheen_roughness
    TextureUse anisotropy_map = {};       ///< red and green: direction, 0.5 is 0; blue: anisotropy
    TextureUse iridescence_map = {};      ///< red: iridescence
    TextureUse film_thickness_map = {};   ///< green: interpolates from the first thickness to the second
    TextureUse opacity_map = {};          ///< red
    TextureUse normal_map = {};  ///< tangent space, 0.5 is 0; +x is right and +y is up in the image, towards decreasing
                                 ///< v (glTF, OpenGL)
    float normal_scale = 1.f;
    TextureUse height_map = {};  ///< red, times `height_scale` in units of the scene; changes the normal only
    float height_scale = 1.f;
    TextureUse light_map = {};  ///< RGB irradiance that replaces light from elsewhere

    std::uint32_t custom = 0;            ///< MaterialKind::custom: the number of the BSDF, from add_bsdf
    std::vector<float> parameters = {};  ///< MaterialKind::custom: CustomBsdf::parameters numbers that it reads

    // The members of CLARAY_BSDF_PARAMETERS: `shininess` (Blinn-Phong: exponent of the highlight).
#define CLARAY_ROW(name, text, standard, check) float name = standard;
    CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
};

/// A BSDF that reflects. Materials use it with MaterialKind::custom.
struct CustomBsdf {
    std::string name = {};  ///< a C identifier, such as "dust"
    /// OpenCL C that defines sample_NAME, eval_NAME and is_delta_NAME as kernels/bsdf/types.clh describes. It may
    /// include the files of kernels/bsdf and kernels/math, and reads Material::parameters by parameters_of(material,
    /// view). Compiler messages name the file NAME.
    /// The energy tables of claray's own BSDFs are not available to it.
    std::string source = {};
    std::uint32_t parameters = 0;  ///< floats in Material::parameters
};

/// Adds a BSDF to the kernels of this process and returns its number for Material::custom. Call it before a Renderer
/// is created; programs compiled earlier stay as they are. Throws ErrorKind::usage if the name is not an identifier or
/// is already in use.
std::uint32_t add_bsdf(CustomBsdf bsdf);

/// LightKind::point, spot and directional: a row of claray/shared/lists/lights.h each.
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
    std::string name = {};
    LightKind kind = LightKind::point;
    glm::vec3 position{0.f};
    glm::vec3 direction{0.f, -1.f, 0.f};  ///< in which it shines; not for points
    glm::vec3 intensity{1.f};             ///< W / sr; far lights: irradiance of a surface that faces it, W / m^2
    float inner_angle = 0.f;              ///< near cones: radians from the axis, up to which it shines fully
    float outer_angle = 0.785398163f;     ///< cones: radians from the axis, beyond which it does not shine
    float range = 0.f;                    ///< beyond which it fades to nothing (KHR_lights_punctual); 0: none
    /// a0, a1, a2: intensity / (a0 + a1 d + a2 d^2) at distance d; the physical inverse square is 0, 0, 1.
    glm::vec3 attenuation{0.f, 0.f, 1.f};
    /// The range ends as 1 - d / range, times the attenuation. With an attenuation of 1, 0, 0 this is the falloff of 2D
    /// engines.
    bool linear_range = false;
};

[[nodiscard]] inline Light point_light(const glm::vec3& position, const glm::vec3& intensity) {
    Light light;
    light.position = position, light.intensity = intensity;
    return light;
}

/// What surrounds the surfaces; claray/shared/lists/sky.h says what the members mean. Black by default.
struct Sky {
#define CLARAY_COLOR(name, text) glm::vec3 name{0.f};
#define CLARAY_NUMBER(name, text) float name = 0.f;
    CLARAY_SKY(CLARAY_COLOR, CLARAY_NUMBER)
#undef CLARAY_COLOR
#undef CLARAY_NUMBER
};

/// An image around the scene. It replaces the horizon and the zenith of the sky.
struct Environment {
    /// One image: latitude and longitude, its middle column towards -z and +y at the top. Six images: the faces +x -x
    /// +y -y +z -z of a cube, oriented as in OpenGL. Linear or sRGB. Empty: no environment.
    std::vector<Texture> images = {};
    float strength = 1.f;
    float rotation = 0.f;  ///< radians about +y, counter-clockwise seen from above
};

/// How points of space become points of the image: a row of claray/shared/lists/projections.h each.
enum class Projection : std::uint32_t {
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch) name = CLARAY_##NAME,
    CLARAY_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
};

struct ProjectionTraits {
    Projection kind;
    const char* name;
    bool flat;      ///< the image is a plane: it has lenses, and a matrix describes it
    bool parallel;  ///< all rays are parallel
};
inline constexpr ProjectionTraits projections[] = {
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch) {Projection::name, text, (flat) != 0, (parallel) != 0},
    CLARAY_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
};
/// Null where there is no such projection.
[[nodiscard]] constexpr const ProjectionTraits* traits_of(Projection projection) {
    for (const ProjectionTraits& traits : projections)
        if (traits.kind == projection) return &traits;
    return nullptr;
}

/// Two images of one camera, one for each eye, in one image.
enum class Stereo : std::uint32_t {
    none,
    side_by_side,  ///< the left eye's image is the left half
    top_bottom     ///< the left eye's image is the upper half
};

struct Camera {
    glm::vec3 position{0.f, 0.f, 5.f};
    glm::vec3 target{0.f};
    glm::vec3 up{0.f, 1.f, 0.f};
    float vertical_fov = 40.f;    ///< degrees, below 180; of a fisheye from edge to edge, up to 360
    float aperture_radius = 0.f;  ///< radius of a thin lens, in units of the scene; 0: a pinhole
    float focus_distance = 0.f;   ///< distance of the sharp plane along the view; 0: that of the target
    std::optional<glm::vec3> position_end = {}, target_end = {};  ///< at shutter close, if the camera moves
    Projection projection = Projection::perspective;
    /// Height of the image in units of the scene, if all rays are parallel; they start in the plane through the
    /// position.
    float orthographic_height = 2.f;
    /// Lens shift of a perspective camera: moves what is seen, in parts of the image's width to the right and of its
    /// height upwards. Parallel lines stay parallel. Not for cameras that move.
    glm::vec2 shift{0.f};
    /// Degrees by which the sharp plane of a lens is turned, below 90. x: round the image's x axis, so that its top
    /// goes away. y: round its y axis, so that its right goes away. Not for cameras that move.
    glm::vec2 tilt{0.f};
    /// Eyes look along parallel axes; both see what is at the target's distance at the same place. A panorama's eyes
    /// turn with its columns (omnidirectional stereo). Not for cameras that move.
    Stereo stereo = Stereo::none;
    float eye_distance = 0.064f;  ///< between the eyes, in units of the scene
};

/// A mesh placed in the scene.
struct MeshInstance {
    std::uint32_t mesh = 0;
    glm::mat4 transform{1.f};                     ///< affine, invertible
    std::optional<glm::mat4> transform_end = {};  ///< at shutter close, if it moves; motion is linear
    std::string name = {};  ///< of the object that it is a part of; all parts have the same name and transform
};

struct Scene {
    std::string name = {};
    std::vector<Mesh> meshes = {};
    std::vector<MeshInstance> instances = {};   ///< empty: every mesh once, without transform
    std::vector<PrimitiveSet> primitives = {};  ///< in the world; they have no instances
    std::vector<Material> materials = {};
    std::vector<Texture> textures = {};
    std::vector<Light> lights = {};
    Sky sky = {};
    Environment environment = {};
    std::optional<Camera> camera = {};  ///< empty: use `automatic_camera`
};

/// Returns the box of all placed meshes, including the ends of motion, and of all primitives. A rotated mesh counts
/// with the box of its rotated box, which may be larger than its own.
[[nodiscard]] Bounds bounds_of(const Scene& scene);
/// As above, with the boxes of its meshes given.
[[nodiscard]] Bounds bounds_of(const Scene& scene, std::span<const Bounds> meshes);
[[nodiscard]] std::vector<Bounds> bounds_of_meshes(const Scene& scene);
/// Returns the number of triangles of all placed meshes.
[[nodiscard]] std::size_t triangle_count(const Scene& scene);

/// Returns a camera that looks at the centre of the bounds from the front, slightly from above and from the right. The
/// bounding sphere just fits into the image. If the bounds have no extent, the distance is 1.
[[nodiscard]] Camera automatic_camera(const Bounds& bounds, float vertical_fov = 40.f, float aspect = 1.f);
/// Returns a camera that looks from the same direction at all of the scene, whose surfaces span 85 % of the image's
/// height or width.
[[nodiscard]] Camera automatic_camera(const Scene& scene, float vertical_fov = 40.f, float aspect = 1.f);
/// Returns the camera of the scene, or an automatic one that sees it all.
[[nodiscard]] Camera camera_of(const Scene& scene, float aspect = 1.f);

/// Returns the camera turned by `degrees` round the axis through its target along `up`, counter-clockwise seen from
/// above. Its motion turns with it.
[[nodiscard]] Camera orbited(const Camera& camera, float degrees);

/// Returns the camera in the form that kernels read. `aspect` = width / height. Throws ErrorKind::usage if at some time
/// the position equals the target or `up` is parallel to the view. It also throws if the angle is outside (0, 180), if
/// the orthographic height is not positive and finite, or if the lens is invalid.
[[nodiscard]] CameraData camera_data(const Camera& camera, float aspect);
/// Returns whether the camera moves while the shutter is open.
[[nodiscard]] bool moves(const Camera& camera);

/// Throws ErrorKind::user, naming the object and the value, if an index is out of range or an array has the wrong
/// length. It also throws if a value is not finite, or if it is negative or outside 0..1 where that is not allowed. It
/// also throws if an instance's transform is not affine or not invertible, or if an environment has neither one image
/// nor six. Positions are not checked: triangles that are not finite are culled and counted when the structure is
/// built.
void validate(const Scene& scene);

/// Returns a line about primitives that emit light, which only scattered rays find; nothing if there are none.
[[nodiscard]] std::optional<std::string> warning_of_lamps(const Scene& scene);

/// Returns a built-in scene: "cornell", "spheres", "crate", "hills", "effects" (all but primitives), or "effect:NAME"
/// (one effect, by its name in `claray explain`). "terrain:N", "soup:N", "fan:N", "hair:N" and "ball:N" have N
/// triangles. "curves:N" are the strands of "hair:N" as curves. Returns no scene for an unknown name. Throws
/// ErrorKind::usage for an invalid N.
[[nodiscard]] std::optional<Scene> builtin_scene(const std::string& name);
[[nodiscard]] std::span<const char* const> builtin_scene_names();

}  // namespace claray
#pragma GCC visibility pop
