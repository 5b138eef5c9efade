// The view in a window, by SDL2 without OpenGL.
#pragma once

#include <functional>

#include "host/view/view.hpp"

namespace claray::view {

/// Throws ErrorKind::user if this build has no windows, or if there is no display.
void require_window();

/// Shows the view in a window until it is closed, the view ends or `goes_on` returns false. The image has the size of
/// the window. Throws as require_window.
void run_in_window(View& view, const std::function<bool()>& goes_on);

}  // namespace claray::view
