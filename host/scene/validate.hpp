// The parts of `validate`. All throw as it does.
#pragma once

#include "claray/scene.hpp"

namespace claray {

void validate_materials(const Scene& scene);
void validate_meshes(const Scene& scene);
void validate_primitives(const Scene& scene);
void validate_instances(const Scene& scene);
void validate_lights(const Scene& scene);
void validate_sky(const Scene& scene);
void validate_camera(const Scene& scene);

/// Whether primitives of any kind can have the material.
[[nodiscard]] bool may_be_on_primitives(const Material& material);

}  // namespace claray
