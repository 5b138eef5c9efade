// The built-in scenes, one function each. `count` is the number of triangles, exactly.
#pragma once

#include "claray/scene.hpp"

namespace claray::scenes {

[[nodiscard]] Scene cornell();
[[nodiscard]] Scene spheres();
[[nodiscard]] Scene crate();
[[nodiscard]] Scene hills();
[[nodiscard]] Scene effects();
[[nodiscard]] Scene waves();
[[nodiscard]] Scene statues();
/// Throws ErrorKind::usage, naming those that exist, where there is no effect of this name.
[[nodiscard]] Scene effect_alone(const std::string& name);
[[nodiscard]] Scene terrain(std::size_t count);
[[nodiscard]] Scene soup(std::size_t count);
[[nodiscard]] Scene fan(std::size_t count);
[[nodiscard]] Scene hair(std::size_t count);
[[nodiscard]] Scene curves(std::size_t count);
[[nodiscard]] Scene ball(std::size_t count);

}  // namespace claray::scenes
