// Changes of a scene as text, for job files and command lines.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "claray/scene.hpp"

namespace claray::view {

/// "material 2 roughness 0.3", "light 0 intensity 5 5 5", or "instance 3 transform" with three rows of four numbers;
/// all count from 0. Instances are those of a scene that was loaded live (LoadOptions), after `place_all`.
inline constexpr const char* edit_help = "KIND NUMBER NAME NUMBERS...";

/// Instances place all meshes, so that each can be moved. Those that stay where they are do not change the picture.
void place_all(Scene& scene);

/// Changes the scene. Throws ErrorKind::usage, naming the edit, if it is none or does not fit the scene.
void apply_edit(Scene& scene, const std::string& edit);
/// Whether an edit is about an instance, so that its scene must be loaded live.
[[nodiscard]] bool moves_instance(const std::string& edit);

/// The edits that make `after` of `before`. Lists that are empty in `before` were not changed.
[[nodiscard]] std::vector<std::string> edits_between(const Scene& before, const Scene& after);

}  // namespace claray::view
