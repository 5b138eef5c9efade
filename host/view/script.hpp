// Replays commands from a file and writes frames, without a display.
#pragma once

#include <filesystem>

#include "host/view/view.hpp"

namespace claray::view {

struct ScriptReport {
    unsigned frames = 0;
    std::vector<double> seconds;         ///< of each frame
    std::vector<double> answer_seconds;  ///< from a command to the picture of the first frame after it
};

/// Runs the commands of a file, one per line; empty lines and lines that begin with # are skipped. All lines are
/// checked first. Every frame of `frames N` and `finish` is written to `folder` as frame-00001.png and so on, unless
/// `folder` is empty. Relative names of `save` are in `folder`. `tell` receives the lines of commands. Throws
/// ErrorKind::user, naming file and line.
ScriptReport run_script(View& view, const std::filesystem::path& file, const std::filesystem::path& folder,
                        const std::function<void(const std::string&)>& tell);

}  // namespace claray::view
