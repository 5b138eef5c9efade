// The view in a terminal: two pixels per character, by half blocks in 24-bit colours. Works over ssh.
#pragma once

#include <functional>

#include "host/view/view.hpp"

namespace claray::view {

/// Returns the text that draws a frame from the top left corner of a terminal; the last line of the screen is left to
/// the caller.
[[nodiscard]] std::string half_blocks(const Frame& frame);

/// Returns the name of a key (see input.hpp) from the bytes that a terminal sends for it.
[[nodiscard]] std::string key_of_bytes(const std::string& bytes);

/// Shows the view in the terminal of standard input and output until it ends or `goes_on` returns false. The terminal
/// is left as it was. Throws ErrorKind::user if these are no terminal.
void run_in_terminal(View& view, const std::function<bool()>& goes_on);

}  // namespace claray::view
