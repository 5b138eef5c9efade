// The BSDFs added by add_bsdf: claray/scene.hpp.
#pragma once

#include <span>

#include "claray/scene.hpp"

namespace claray {

[[nodiscard]] std::span<const CustomBsdf> custom_bsdfs();
/// Throws ErrorKind::user if the material uses a BSDF that was not added, or has another number of parameters.
void check_custom(const Material& material);

}  // namespace claray
