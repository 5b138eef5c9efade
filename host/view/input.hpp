// What keys and the mouse do, in every front end.
#pragma once

#include <span>
#include <string>

namespace claray::view {

struct KeyRow {
    const char* key;  ///< as browsers name it (W3C UI Events, KeyboardEvent.key); letters are small
    const char* command;
};
[[nodiscard]] std::span<const KeyRow> key_rows();
/// Returns the command of a key; empty if it has none.
[[nodiscard]] std::string command_of_key(const std::string& key);
inline constexpr const char* key_help =
    "arrows: orbit, W A S D Q E: fly, + -: exposure, 1 to 7: show, N M: denoise on or off, L: play, H: home, "
    "P or blank: pause, T: next light, K: save view.png, C: copy the camera, X: quit";

// The mouse: a drag orbits, with Shift it pans, with Ctrl it moves what is selected, the wheel zooms, a click selects,
// a double click focuses.
inline constexpr double degrees_per_pixel = 0.4, zoom_per_step = 1.1;
inline constexpr int farthest_click = 4;  ///< pixels: a button that was moved less far before its release is a click
inline constexpr const char* mouse_help =
    "drag: orbit, Shift and drag: pan, Ctrl and drag: move what is selected, wheel: zoom, click: select, "
    "double click: focus";

}  // namespace claray::view
