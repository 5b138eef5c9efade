#include "host/view/script.hpp"

#include <chrono>
#include <sstream>

#include "host/base/file.hpp"
#include "host/base/format.hpp"

namespace claray::view {
namespace {

using Clock = std::chrono::steady_clock;

template <class Act>
auto at_line(const std::filesystem::path& file, unsigned number, const Act& act) try {
    return act();
} catch (const Error& error) {
    throw Error(error.kind(), file.string() + ":" + std::to_string(number) + ": " + error.what());
}

/// Runs the lines and counts their frames.
class Player {
public:
    Player(View& view, std::filesystem::path folder) : view_(view), folder_(std::move(folder)) {}

    std::string play(ViewCommand command) {
        if (command.name == "frames" || command.name == "finish") {
            const bool all = command.name == "finish";
            const unsigned count = all ? 1 : unsigned(std::max(command.numbers[0], 0.f));
            for (unsigned i = 0; i < count; ++i) add_frame(all);
            return {};
        }
        if (command.name == "save" && std::filesystem::path(command.word).is_relative())
            command.word = (folder_ / command.word).string();
        if (!asked_) asked_ = Clock::now();
        return view_.run(command);
    }
    ScriptReport report;

private:
    void add_frame(bool complete) {
        const Clock::time_point begin = Clock::now();
        (void)(complete ? view_.complete_frame() : view_.next_frame());
        const Clock::time_point end = Clock::now();
        std::vector<double>& seconds = complete ? report.finish_seconds : report.frame_seconds;
        seconds.push_back(std::chrono::duration<double>(end - begin).count());
        if (asked_ && !complete) report.answer_seconds.push_back(std::chrono::duration<double>(end - *asked_).count());
        asked_.reset();
        ++frames_;
        if (folder_.empty()) return;
        ViewCommand save{"save", (folder_ / printed("frame-%05u.png", frames_)).string(), {}};
        (void)view_.run(save);
    }

    View& view_;
    std::filesystem::path folder_;
    unsigned frames_ = 0;
    std::optional<Clock::time_point> asked_;  // the first command since the last frame
};

}  // namespace

Script read_script(const std::filesystem::path& file) {
    std::istringstream input(read_file(file, "check the path"));
    Script script{file, {}};
    std::string text;
    for (unsigned number = 1; std::getline(input, text); ++number) {
        const std::size_t begin = text.find_first_not_of(" \t\r");
        if (begin == std::string::npos || text[begin] == '#') continue;
        script.lines.push_back({number, at_line(file, number, [&] { return parse_command(text); })});
    }
    return script;
}

ScriptReport run_script(View& view, const Script& script, const std::filesystem::path& folder,
                        const std::function<void(const std::string&)>& tell) {
    Player player(view, folder);
    for (const Script::Line& line : script.lines) {
        const std::string told = at_line(script.file, line.number, [&] { return player.play(line.command); });
        if (!told.empty()) tell(told);
        if (view.ended()) break;
    }
    return player.report;
}

}  // namespace claray::view
