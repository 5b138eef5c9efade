// Materials as the kernels read them, and what each of them needs.
#pragma once

#include "host/render/energy_tables.hpp"

namespace claray {

[[nodiscard]] MaterialData material_data(const Material& material, const EnergyTables& tables);

// What of a material needs code and tables of its own. Textures only multiply, so that what is 0 stays 0.

[[nodiscard]] bool has_diffuse_dielectric(const Material& material);
[[nodiscard]] bool has_metal(const Material& material);
/// Of solids.
[[nodiscard]] bool has_glass(const Material& material);
[[nodiscard]] bool has_thin_walls(const Material& material);
[[nodiscard]] bool has_rough_glass(const Material& material);
[[nodiscard]] bool has_clearcoat(const Material& material);
[[nodiscard]] bool has_coated_metal(const Material& material);
[[nodiscard]] bool absorbs_inside(const Material& material);

}  // namespace claray
