#include "host/render/material_data.hpp"

#include "host/render/lights.hpp"

namespace claray {
namespace {

bool is_principled(const Material& m) { return m.kind == MaterialKind::principled; }
bool transmits(const Material& m) { return m.kind == MaterialKind::glass || (is_principled(m) && m.transmission > 0); }

/// Beer's coefficient: what is black after the distance still lets 1e-30 through, so that 0 * infinity does not occur.
glm::vec3 absorption_of(const Material& m) {
    if (!absorbs_inside(m)) return glm::vec3(0.f);
    return -glm::log(glm::clamp(m.attenuation, glm::vec3(1e-30f), glm::vec3(1.f))) / m.attenuation_distance;
}

}  // namespace

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
bool has_coated_metal(const Material& m) { return has_clearcoat(m) && has_metal(m); }
bool absorbs_inside(const Material& m) {
    return has_glass(m) && m.attenuation_distance > 0 && m.attenuation != glm::vec3(1.f);
}

MaterialData material_data(const Material& m, const EnergyTables& tables) {
    glm::vec3 albedo = m.albedo, specular = m.specular;
    if (m.kind == MaterialKind::blinn_phong) {  // both parts may reflect all light, together no more than that
        const glm::vec3 excess = glm::max(albedo + specular, glm::vec3(1.f));
        albedo /= excess, specular /= excess;
    }
    const glm::vec3 absorption = absorption_of(m);
    return {.albedo_r = albedo.x,
            .albedo_g = albedo.y,
            .albedo_b = albedo.z,
            .kind = m.kind == MaterialKind::glass && m.thin_walled ? CLARAY_THIN_GLASS : std::uint32_t(m.kind),
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
            .shininess = m.shininess,
            .absorption_r = absorption.x,
            .absorption_g = absorption.y,
            .absorption_b = absorption.z,
            .energy = tables.block_of(m.ior),
            .coat_energy = tables.block_of(CLARAY_COAT_IOR),
            .thin_walled = m.thin_walled};
}

}  // namespace claray
