// Replays commands from a file and writes frames, without a display.
#pragma once

#include <filesystem>

#include "host/view/view.hpp"

namespace claray::view {

/// The commands of a file.
struct Script {
    struct Line {
        unsigned number = 0;
        ViewCommand command;
    };
    std::filesystem::path file;
    std::vector<Line> lines;
};

/// Reads commands, one per line; empty lines and lines that begin with # are skipped. Throws ErrorKind::user, naming
/// file and line, if one of them is none.
[[nodiscard]] Script read_script(const std::filesystem::path& file);

struct ScriptReport {
    std::vector<double> frame_seconds;   ///< of each frame of `frames N`
    std::vector<double> finish_seconds;  ///< of each image of `finish`, which has all samples
    std::vector<double> answer_seconds;  ///< from a command to the picture of the first frame after it
};

/// Every frame of `frames N` and `finish` is written to `folder` as frame-00001.png and so on, unless `folder` is
/// empty. Relative names of `save` are in `folder`. `tell` receives the lines of commands. Errors name file and line.
ScriptReport run_script(View& view, const Script& script, const std::filesystem::path& folder,
                        const std::function<void(const std::string&)>& tell);

}  // namespace claray::view
