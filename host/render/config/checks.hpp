// Refuses configurations of renders that make no sense.
#pragma once

#include "claray/renderer.hpp"

namespace claray {

/// Throws ErrorKind::usage if an image cannot have so many pixels per side.
void check_size(unsigned width, unsigned height);
/// Returns the configuration, or throws ErrorKind::usage.
const RenderConfig& checked(const RenderConfig& config);
/// Throws ErrorKind::usage for what several devices cannot share.
void check_alone(const RenderConfig& config);

}  // namespace claray
