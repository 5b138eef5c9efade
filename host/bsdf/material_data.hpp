// Materials in the form that kernels read, and the features that each material needs.
#pragma once

#include "host/bsdf/energy_tables.hpp"

namespace claray {

/// What a material is, however it is named: a principled one that only its base reflects is a Lambertian, and so are
/// Oren and Nayar's of roughness 0 and Blinn's without a highlight. Kernels, effects and maps go by this kind.
[[nodiscard]] MaterialKind kind_of(const Material& material);
/// The index of refraction of its energy tables.
[[nodiscard]] float ior_of_tables(const Material& material);

[[nodiscard]] MaterialData material_data(const Material& material, const EnergyTables& tables);

/// The maps of a material except its opacity map.
inline constexpr TextureUse Material::*material_maps[] = {
    &Material::albedo_map,           &Material::emission_map,    &Material::metallic_roughness_map,
    &Material::transmission_map,     &Material::clearcoat_map,   &Material::clearcoat_roughness_map,
    &Material::clearcoat_normal_map, &Material::specular_map,    &Material::specular_weight_map,
    &Material::shininess_map,        &Material::sheen_map,       &Material::sheen_roughness_map,
    &Material::anisotropy_map,       &Material::iridescence_map, &Material::film_thickness_map,
    &Material::normal_map,           &Material::height_map,      &Material::light_map};

// Features of a material that need code and tables of their own. Textures only multiply, so a factor of 0 stays 0.

[[nodiscard]] bool has_diffuse_dielectric(const Material& material);
[[nodiscard]] bool has_metal(const Material& material);
/// For solid materials.
[[nodiscard]] bool has_glass(const Material& material);
[[nodiscard]] bool has_thin_walls(const Material& material);
[[nodiscard]] bool has_rough_glass(const Material& material);
[[nodiscard]] bool has_clearcoat(const Material& material);
[[nodiscard]] bool has_coated_metal(const Material& material);
[[nodiscard]] bool has_coated_dielectric(const Material& material);
/// A coat that is evaluated separately: it has normals of its own, or the material below has further layers.
[[nodiscard]] bool has_layered_coat(const Material& material);
/// The dielectric has KHR_materials_specular.
[[nodiscard]] bool has_specular_layer(const Material& material);
[[nodiscard]] bool has_film(const Material& material);
[[nodiscard]] bool has_sheen(const Material& material);
[[nodiscard]] bool is_anisotropic(const Material& material);
[[nodiscard]] bool absorbs_inside(const Material& material);
/// Inside, per unit of length.
[[nodiscard]] glm::vec3 absorption_of(const Material& material);

/// Returns whether this material has emission that varies over its triangles.
[[nodiscard]] bool has_emission_map(const Material& material);
/// The luminance by which emissive triangles of a material are sampled: MaterialData::sampled_emission; negative with
/// an emission map.
[[nodiscard]] float sampled_emission(const Material& material);

}  // namespace claray
