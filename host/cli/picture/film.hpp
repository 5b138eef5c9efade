// The picture that a pbrt or Mitsuba file asks for.
#pragma once

#include "host/cli/options/render_options.hpp"

namespace claray::cli {

/// Takes size, crop and exposure of a scene file's film where the command line tells nothing of them. Throws as the
/// file's reader.
void use_film(RenderOptions& options);

}  // namespace claray::cli
