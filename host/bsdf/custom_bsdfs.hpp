// The BSDFs that add_bsdf has added: claray/bsdf.hpp.
#pragma once

#include <span>

#include "claray/bsdf.hpp"
#include "claray/scene.hpp"

namespace claray {

[[nodiscard]] std::span<const CustomBsdf> custom_bsdfs();
/// Throws ErrorKind::user if the material uses a BSDF that was not added, or has another number of parameters.
void check_custom(const Material& material);

}  // namespace claray
