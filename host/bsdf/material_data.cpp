#include "host/bsdf/material_data.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace claray {
namespace {

bool is_principled(const Material& m) { return kind_of(m) == MaterialKind::principled; }

/// Of a principled material: neither a metal, nor transparent, nor under layers.
bool is_opaque_dielectric(const Material& m) {
    const bool layered = m.clearcoat > 0 || m.sheen != glm::vec3(0.f) || m.iridescence > 0;
    return m.metallic == 0 && m.transmission == 0 && !layered;
}
bool transmits(const Material& m) { return m.kind == MaterialKind::glass || (is_principled(m) && m.transmission > 0); }

/// An angle in 0..2 pi.
float turn_of(float angle) { return angle - glm::two_pi<float>() * std::floor(angle / glm::two_pi<float>()); }

std::uint32_t layers_of(const Material& m) {
    return (has_specular_layer(m) ? CLARAY_SPECULAR_LAYER : 0) | (has_film(m) ? CLARAY_FILM_LAYER : 0) |
           (has_sheen(m) ? CLARAY_SHEEN_LAYER : 0) | (is_anisotropic(m) ? CLARAY_ANISOTROPIC_LAYER : 0) |
           (has_layered_coat(m) ? CLARAY_COAT_LAYER : 0);
}

}  // namespace

MaterialKind kind_of(const Material& m) {
    const bool diffuse =
        (m.kind == MaterialKind::principled && is_opaque_dielectric(m) && (m.specular_weight == 0 || m.ior == 1)) ||
        (m.kind == MaterialKind::oren_nayar && m.roughness == 0) ||
        (m.kind == MaterialKind::blinn_phong && m.specular == glm::vec3(0.f));
    return diffuse ? MaterialKind::lambert : m.kind;
}
float ior_of_tables(const Material& m) {
    return has_specular_layer(m) ? std::min(m.ior, CLARAY_MOST_CURVE_IOR) : m.ior;
}

bool has_diffuse_dielectric(const Material& m) {
    return is_principled(m) && (m.metallic < 1 || m.metallic_roughness_map.used()) &&
           (m.transmission < 1 || m.transmission_map.used());
}
bool has_metal(const Material& m) { return m.kind == MaterialKind::metal || (is_principled(m) && m.metallic > 0); }
bool has_glass(const Material& m) { return transmits(m) && !m.thin_walled; }
bool has_thin_walls(const Material& m) { return transmits(m) && m.thin_walled; }
bool has_rough_glass(const Material& m) {
    return has_glass(m) && (m.roughness > 0 || (has_clearcoat(m) && m.clearcoat_roughness > 0));
}
bool has_clearcoat(const Material& m) { return is_principled(m) && m.clearcoat > 0; }
bool has_coated_metal(const Material& m) { return has_clearcoat(m) && has_metal(m) && !has_layered_coat(m); }
bool has_coated_dielectric(const Material& m) {
    return has_clearcoat(m) && has_diffuse_dielectric(m) && !has_layered_coat(m);
}
bool has_layered_coat(const Material& m) {
    const bool relief = m.normal_map.used() || m.height_map.used() || m.clearcoat_normal_map.used();
    return has_clearcoat(m) && (relief || has_specular_layer(m) || has_film(m) || has_sheen(m) || is_anisotropic(m));
}
bool has_specular_layer(const Material& m) {
    return is_principled(m) && (m.specular_weight != 1 || m.specular_tint != glm::vec3(1.f) || m.specular_map.used() ||
                                m.specular_weight_map.used());
}
bool has_film(const Material& m) {
    const bool thick = m.film_thickness.y > 0 || (m.film_thickness_map.used() && m.film_thickness.x > 0);
    return is_principled(m) && m.iridescence > 0 && thick;
}
bool has_sheen(const Material& m) { return is_principled(m) && m.sheen != glm::vec3(0.f); }
bool is_anisotropic(const Material& m) { return is_principled(m) && m.anisotropy > 0; }
bool absorbs_inside(const Material& m) {
    return has_glass(m) && m.attenuation_distance > 0 && m.attenuation != glm::vec3(1.f);
}
/// Beer's coefficient. Black at the distance is treated as 1e-30, so that 0 * infinity does not occur.
glm::vec3 absorption_of(const Material& m) {
    if (!absorbs_inside(m)) return glm::vec3(0.f);
    return -glm::log(glm::clamp(m.attenuation, glm::vec3(1e-30f), glm::vec3(1.f))) / m.attenuation_distance;
}

MaterialData material_data(const Material& m, const EnergyTables& tables) {
    glm::vec3 albedo = m.albedo, specular = is_principled(m) ? m.specular_tint : m.specular;
    const bool textured = m.albedo_map.used() || m.specular_map.used();  // then shade/maps.clh scales them
    if (kind_of(m) == MaterialKind::blinn_phong &&
        !textured) {  // scaled so that both together reflect at most all light
        const glm::vec3 excess = glm::max(albedo + specular, glm::vec3(1.f));
        albedo /= excess, specular /= excess;
    }
    const glm::vec3 absorption = absorption_of(m);
    return {.albedo_r = albedo.x,
            .albedo_g = albedo.y,
            .albedo_b = albedo.z,
            .kind = m.kind == MaterialKind::glass && m.thin_walled ? CLARAY_THIN_WALLS : std::uint32_t(kind_of(m)),
            .emission_r = m.emission.x,
            .emission_g = m.emission.y,
            .emission_b = m.emission.z,
            .roughness = m.roughness,
            .ior = m.ior,
            .sampled_emission = sampled_emission(m),
            .metallic = m.metallic,
            .transmission = m.transmission,
            .clearcoat = m.clearcoat,
            .clearcoat_roughness = m.clearcoat_roughness,
            .specular_r = specular.x,
            .specular_g = specular.y,
            .specular_b = specular.z,
            .absorption_r = absorption.x,
            .absorption_g = absorption.y,
            .absorption_b = absorption.z,
            .energy = m.kind == MaterialKind::custom ? tables.parameters_of(m) : tables.block_of(ior_of_tables(m)),
            .coat_energy = tables.block_of(CLARAY_COAT_IOR),
            .thin_walled = m.thin_walled,
            .layers = layers_of(m),
            .specular_weight = m.specular_weight,
            .sheen_r = m.sheen.x,
            .sheen_g = m.sheen.y,
            .sheen_b = m.sheen.z,
            .sheen_roughness = m.sheen_roughness,
            .anisotropy = m.anisotropy,
            .anisotropy_rotation = turn_of(m.anisotropy_rotation),
            .iridescence = m.iridescence,
            .film_ior = m.iridescence_ior,
            .film_thickness = m.film_thickness.y,
            .film_thickness_min = m.film_thickness.x,
            .coat_x = 0.f,
            .coat_y = 0.f,
            .coat_z = 1.f,
            .custom = m.custom,
            .maps = 0,    // of a scene with textures
            .shader = 0,  // of a scene whose materials share one
#define CLARAY_ROW(name, text, standard, check) .name = m.name,
            CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
    };
}

bool has_emission_map(const Material& material) {
    return material.emission_map.used() && material.emission != glm::vec3(0.f);
}

float sampled_emission(const Material& material) {
    if (material.alpha_mode != AlphaMode::opaque) return 0.f;  // lamps with holes are only found by BSDF sampling
    if (has_emission_map(material)) return -1.f;
    const glm::vec3 c = material.emission;
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;  // as in math/vector.clh
}

}  // namespace claray
