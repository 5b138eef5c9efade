#include "host/io/obj/mtl.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace claray {
namespace {

glm::vec3 rgb(const tinyobj::real_t (&c)[3]) { return {c[0], c[1], c[2]}; }
float largest(const glm::vec3& c) { return std::max({c.x, c.y, c.z}); }

/// GGX roughness of a Phong exponent: alpha^2 = 2 / (Ns + 2) (Walter et al. 2007, section 5.2), roughness^2 = alpha.
float roughness_from_exponent(float exponent) { return std::pow(2.f / (std::max(exponent, 0.f) + 2.f), 0.25f); }

bool is_transparent(const tinyobj::material_t& mtl) {
    return mtl.illum == 4 || mtl.illum == 6 || mtl.illum == 7 || mtl.illum == 9 ||
           (mtl.dissolve < 0.5f && mtl.alpha_texname.empty());
}
bool is_reflecting(const tinyobj::material_t& mtl) { return mtl.illum == 3 || mtl.illum == 5 || mtl.illum == 8; }

/// The keys of the PBR extension are there; 0 is what tinyobjloader says of those that are not.
bool is_physical(const tinyobj::material_t& mtl) {
    return mtl.roughness > 0.f || mtl.metallic > 0.f || mtl.clearcoat_thickness > 0.f ||
           mtl.clearcoat_roughness > 0.f || !mtl.roughness_texname.empty() || !mtl.metallic_texname.empty();
}
/// A metal and nothing else, which the simpler kind says as well.
bool is_bare_metal(const tinyobj::material_t& mtl) {
    return mtl.metallic >= 1.f && mtl.clearcoat_thickness <= 0.f && mtl.roughness_texname.empty() &&
           mtl.metallic_texname.empty();
}

void make_glass(Material& material, const tinyobj::material_t& mtl) {
    material.kind = MaterialKind::glass;
    material.roughness = mtl.roughness;
    const glm::vec3 filter = rgb(mtl.transmittance);  // 0 where the file doesn't say
    material.albedo = largest(filter) > 0.f ? filter : glm::vec3(1.f);
    material.ior = mtl.ior > 1.f ? mtl.ior : 1.5f;  // 1 where the file doesn't say
}

/// A lobe narrower than alpha = 1e-3 is a mirror's.
void make_metal(Material& material, const glm::vec3& reflectance, float roughness) {
    material.kind = roughness * roughness < 1e-3f ? MaterialKind::mirror : MaterialKind::metal;
    material.albedo = reflectance;
    material.roughness = roughness;
}

/// A texture multiplies the value beside it: where the file names only the texture, that is 1.
void make_principled(Material& material, const tinyobj::material_t& mtl, float by_exponent) {
    material.kind = MaterialKind::principled;
    material.metallic = mtl.metallic == 0.f && !mtl.metallic_texname.empty() ? 1.f : mtl.metallic;
    material.roughness = mtl.roughness != 0.f             ? mtl.roughness
                         : !mtl.roughness_texname.empty() ? 1.f
                         : mtl.shininess > 1.f            ? by_exponent
                                                          : 0.f;
    material.clearcoat = mtl.clearcoat_thickness;
    material.clearcoat_roughness = mtl.clearcoat_roughness;
    material.ior = mtl.ior > 1.f ? mtl.ior : 1.5f;
}

/// Asks for a highlight beside the diffuse colour (illumination model 2).
bool has_highlight(const tinyobj::material_t& mtl) {
    return mtl.illum >= 2 && (largest(rgb(mtl.specular)) > 0.f || !mtl.specular_texname.empty());
}

/// A texture multiplies the value beside it: where the file names only the texture, that is 1.
void make_blinn_phong(Material& material, const tinyobj::material_t& mtl) {
    material.kind = MaterialKind::blinn_phong;
    material.specular = rgb(mtl.specular);
    if (material.specular == glm::vec3(0.f)) material.specular = glm::vec3(1.f);
    material.shininess = mtl.shininess;
}

/// What is dissolved but still no glass lets a share of the light pass straight on.
void set_opacity(Material& material, const tinyobj::material_t& mtl) {
    if (material.kind == MaterialKind::glass || !(mtl.dissolve < 1.f)) return;
    material.opacity = mtl.dissolve;
    material.alpha_mode = AlphaMode::blend;
}

/// Clamps into lo..hi; NaN becomes lo.
bool clamp(float& value, float lo, float hi) {
    const float before = value;
    value = value >= lo ? std::min(value, hi) : lo;
    return value != before;
}

void repair(Material& material, Warnings& warnings) {
    bool moved = false;
    for (int k = 0; k < 3; ++k) {
        moved |= clamp(material.albedo[k], 0.f, 1.f) | clamp(material.specular[k], 0.f, 1.f);
        if (!std::isfinite(material.emission[k])) material.emission[k] = -1.f;  // there is no sensible radiance for it
        moved |= clamp(material.emission[k], 0.f, std::numeric_limits<float>::max());
    }
    for (float* value : {&material.roughness, &material.metallic, &material.clearcoat, &material.clearcoat_roughness,
                         &material.opacity})
        moved |= clamp(*value, 0.f, 1.f);
    moved |= clamp(material.ior, 1e-3f, 1e3f) | clamp(material.shininess, 0.f, 1e6f);
    if (moved) warnings.push_back("material '" + material.name + "': values out of range were clamped");
}

}  // namespace

Material material_from_mtl(const tinyobj::material_t& mtl, Warnings& warnings) {
    Material material;
    material.name = mtl.name;
    material.emission = rgb(mtl.emission);
    material.albedo = rgb(mtl.diffuse);
    const glm::vec3 specular = rgb(mtl.specular);
    const float by_exponent = roughness_from_exponent(mtl.shininess);
    const bool has_exponent = mtl.shininess > 1.f;  // 1 where the file doesn't say
    if (is_transparent(mtl))
        make_glass(material, mtl);
    else if (is_bare_metal(mtl))
        make_metal(material, material.albedo, mtl.roughness > 0.f || !has_exponent ? mtl.roughness : by_exponent);
    else if (is_physical(mtl))
        make_principled(material, mtl, by_exponent);
    else if (is_reflecting(mtl) && largest(specular) > 0.f)
        make_metal(material, specular, has_exponent && mtl.shininess < 500.f ? by_exponent : 0.f);
    else if (largest(material.albedo) <= 0.f && largest(specular) > 0.f)
        make_metal(material, specular, by_exponent);
    else if (has_highlight(mtl))
        make_blinn_phong(material, mtl);
    set_opacity(material, mtl);
    repair(material, warnings);
    return material;
}

Material grey_lambert(const std::string& name) {
    Material material;
    material.name = name;
    return material;
}

}  // namespace claray
