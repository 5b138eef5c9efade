// MTL materials to claray's.
#pragma once

#include <tiny_obj_loader.h>

#include "claray/io.hpp"

namespace claray {

/// Chooses the kind by what the file says of light: a transparent illumination model (4, 6, 7, 9) or d < 0.5 is glass;
/// Pm
/// >= 0.5, or Ks alone, is metal; a reflecting model (3, 5, 8) is mirror or metal by its exponent; all else is Lambert.
/// Values outside their range are moved into it, with a warning.
[[nodiscard]] Material material_from_mtl(const tinyobj::material_t& mtl, Warnings& warnings);

/// What a mesh without material is made of.
[[nodiscard]] Material grey_lambert(const std::string& name);

}  // namespace claray
