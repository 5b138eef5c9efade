// The members of the structs of a scene, by structured bindings: this file does not compile after a member is added
// until it is named here. The first member is the name, except where there is none.
#pragma once

#include <concepts>
#include <type_traits>

#include "claray/scene.hpp"

namespace claray {

template <class T, class Struct>
concept IsOf = std::same_as<std::remove_const_t<T>, Struct>;

/// Calls `visit(member, ...)` with references to all members.
template <IsOf<Mesh> T, class Visit>
void visit_members(T& mesh, const Visit& visit) {
    auto& [name, positions, normals, uvs, uvs1, tangents, colors, triangles, materials, mask] = mesh;
    visit(name, positions, normals, uvs, uvs1, tangents, colors, triangles, materials, mask);
}

template <IsOf<PrimitiveSet> T, class Visit>
void visit_members(T& set, const Visit& visit) {
    auto& [name, kind, points, segments, colors, materials] = set;
    visit(name, kind, points, segments, colors, materials);
}

template <IsOf<Texture> T, class Visit>
void visit_members(T& texture, const Visit& visit) {
    auto& [name, width, height, channels, format, bytes, floats, wrap_u, wrap_v, filter] = texture;
    visit(name, width, height, channels, format, bytes, floats, wrap_u, wrap_v, filter);
}

template <IsOf<Light> T, class Visit>
void visit_members(T& light, const Visit& visit) {
    auto& [name, kind, position, direction, intensity, inner_angle, outer_angle, range, attenuation, linear_range] =
        light;
    visit(name, kind, position, direction, intensity, inner_angle, outer_angle, range, attenuation, linear_range);
}

template <IsOf<Scene> T, class Visit>
void visit_members(T& scene, const Visit& visit) {
    auto& [name, meshes, instances, primitives, materials, textures, lights, sky, environment, camera] = scene;
    visit(name, meshes, instances, primitives, materials, textures, lights, sky, environment, camera);
}

template <IsOf<Material> T, class Visit>
void visit_members(T& material, const Visit& visit) {
#define CLARAY_ROW(name, text, standard, check) , name
    auto& [name, kind, albedo, emission, roughness, ior, metallic, transmission, thin_walled, clearcoat,
           clearcoat_roughness, specular, specular_weight, specular_tint, sheen, sheen_roughness, anisotropy,
           anisotropy_rotation, iridescence, iridescence_ior, film_thickness, attenuation, attenuation_distance,
           opacity, alpha_mode, alpha_cutoff, alpha_test, cull_back, role, albedo_map, emission_map,
           metallic_roughness_map, transmission_map, clearcoat_map, clearcoat_roughness_map, clearcoat_normal_map,
           clearcoat_normal_scale, specular_map, specular_weight_map, shininess_map, sheen_map, sheen_roughness_map,
           anisotropy_map, iridescence_map, film_thickness_map, opacity_map, normal_map, normal_scale, height_map,
           height_scale, light_map, custom, parameters CLARAY_BSDF_PARAMETERS(CLARAY_ROW)] = material;
    visit(name, kind, albedo, emission, roughness, ior, metallic, transmission, thin_walled, clearcoat,
          clearcoat_roughness, specular, specular_weight, specular_tint, sheen, sheen_roughness, anisotropy,
          anisotropy_rotation, iridescence, iridescence_ior, film_thickness, attenuation, attenuation_distance, opacity,
          alpha_mode, alpha_cutoff, alpha_test, cull_back, role, albedo_map, emission_map, metallic_roughness_map,
          transmission_map, clearcoat_map, clearcoat_roughness_map, clearcoat_normal_map, clearcoat_normal_scale,
          specular_map, specular_weight_map, shininess_map, sheen_map, sheen_roughness_map, anisotropy_map,
          iridescence_map, film_thickness_map, opacity_map, normal_map, normal_scale, height_map, height_scale,
          light_map, custom, parameters CLARAY_BSDF_PARAMETERS(CLARAY_ROW));
#undef CLARAY_ROW
}

template <IsOf<Environment> T, class Visit>
void visit_members(T& environment, const Visit& visit) {
    auto& [images, strength, rotation] = environment;
    visit(images, strength, rotation);
}

template <IsOf<Sky> T, class Visit>
void visit_members(T& sky, const Visit& visit) {
#define CLARAY_ROW(name, text) visit(sky.name);
    CLARAY_SKY(CLARAY_ROW, CLARAY_ROW)
#undef CLARAY_ROW
}

template <IsOf<MeshInstance> T, class Visit>
void visit_members(T& instance, const Visit& visit) {
    auto& [mesh, transform, transform_end, name] = instance;
    visit(mesh, transform, transform_end, name);
}

template <IsOf<TextureUse> T, class Visit>
void visit_members(T& use, const Visit& visit) {
    auto& [texture, uv_set, offset, scale, rotation] = use;
    visit(texture, uv_set, offset, scale, rotation);
}

template <IsOf<Camera> T, class Visit>
void visit_members(T& camera, const Visit& visit) {
    auto& [position, target, up, vertical_fov, aperture_radius, focus_distance, position_end, target_end, projection,
           orthographic_height, shift, tilt, stereo, eye_distance] = camera;
    visit(position, target, up, vertical_fov, aperture_radius, focus_distance, position_end, target_end, projection,
          orthographic_height, shift, tilt, stereo, eye_distance);
}

/// Has `visit_members`.
template <class T>
concept Described = requires(T& value) {
    visit_members(value, [](auto&...) {});
};

}  // namespace claray
