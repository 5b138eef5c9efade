// The scene of claray.h, and its textures.
#pragma once

#include <claray.h>

#include <optional>

#include "claray/scene.hpp"

struct claray_scene {
    claray::Scene scene;
};
struct claray_image {
    claray::Texture texture;
};

namespace claray::capi {

/// Throws ErrorKind::usage for wrong sizes. `name`: of the argument.
[[nodiscard]] Texture texture_of(const claray_texture* given, const char* name);

}  // namespace claray::capi
