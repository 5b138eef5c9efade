#include "host/view/view_command.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "claray/error.hpp"
#include "claray/shared/lists/aovs.h"

namespace claray::view {
namespace {

#define CLARAY_OR_NAME(name, kind, letters, meaning) "|" #name

constexpr CommandRow commands[] = {
    {"orbit", nullptr, 2, "RIGHT UP", "turn round the target, in degrees"},
    {"turn", nullptr, 2, "RIGHT UP", "look elsewhere from the same place, in degrees"},
    {"pan", nullptr, 2, "RIGHT UP", "shift the camera, in heights of the image at the target"},
    {"fly", nullptr, 3, "FORWARD RIGHT UP", "move the camera, in hundredths of the scene's size"},
    {"zoom", nullptr, 1, "FACTOR", "divide the distance from the target by a factor"},
    {"home", nullptr, 0, "", "return to the first camera"},
    {"look", nullptr, 6, "X Y Z X Y Z", "place the camera and its target"},
    {"spin", nullptr, 1, "DEGREES", "orbit by itself, so many degrees a second; 0: stop"},
    {"fov", nullptr, 1, "DEGREES", "set the vertical field of view"},
    {"focus", nullptr, 2, "X Y", "make the surface at a pixel the target and the sharp plane"},
    {"aperture", nullptr, 1, "RADIUS", "radius of the lens, in units of the scene; 0: all is sharp"},
    {"exposure", nullptr, 1, "STOPS", "brighten by so many stops"},
    {"stops", nullptr, 1, "STOPS", "set the exposure"},
    {"tone", "NAME", 0, "none|aces", "tone map"},
    {"show", "NAME", 0, "image" CLARAY_AOVS(CLARAY_OR_NAME) "|error", "what is seen"},
    {"denoise", "NAME", 0, "on|off", "show the image without most of its noise"},
    {"pick", nullptr, 2, "X Y", "select the object at a pixel, and tell what it is"},
    {"object", nullptr, 1, "NUMBER", "select an object and its material by an instance of it"},
    {"edit", nullptr, 1, "NUMBER", "select a material; they count from 0"},
    {"deselect", nullptr, 0, "", "select nothing"},
    {"material", "NAME", 3, "NAME R G B, or NAME V 0 0", "change the selected material"},
    {"move", nullptr, 3, "X Y Z", "move the selected object"},
    {"rotate", nullptr, 4, "X Y Z DEGREES", "turn the selected object round an axis through its middle"},
    {"scale", nullptr, 3, "X Y Z", "scale the selected object along its own axes"},
    {"light", nullptr, 4, "NUMBER X Y Z", "move a light by a distance"},
    {"lamp", "NAME", 3, "NAME X Y Z, or NAME V 0 0", "change the selected light"},
    {"select", nullptr, 1, "NUMBER", "select a light; they count from 0"},
    {"next", nullptr, 0, "", "select the next light"},
    {"drag", nullptr, 2, "RIGHT UP", "move the selected object or light, in heights of the image at its distance"},
    {"undo", nullptr, 0, "", "take back the last change of objects, materials or lights"},
    {"redo", nullptr, 0, "", "make a change again that was taken back"},
    {"hold", "NAME", 0, "on|off", "while on, changes of one kind are undone together"},
    {"explain", nullptr, 0, "", "measure the cost of each effect of the scene, for the web page"},
    {"time", nullptr, 1, "SECONDS", "show an animated file at a time"},
    {"play", nullptr, 0, "", "let the time of an animated file pass, or stop it"},
    {"resize", nullptr, 2, "WIDTH HEIGHT", "change the size of the image, in pixels"},
    {"pause", nullptr, 0, "", "stop sampling, or continue"},
    {"frames", nullptr, 1, "COUNT", "render so many frames"},
    {"finish", nullptr, 0, "", "sample until the image has all samples"},
    {"save", "FILE", 0, "FILE", "write what is seen as a PNG"},
    {"camera", nullptr, 0, "", "print the camera as options of the command line"},
    {"quit", nullptr, 0, "", "end the view"},
};

[[noreturn]] void refuse_line(const std::string& line, const std::string& why, const std::string& remedy) {
    throw Error(ErrorKind::user, "'" + line + "': " + why, remedy);
}

std::string usage_of(const CommandRow& row) {
    return std::string(row.name) + (*row.arguments ? " " : "") + row.arguments;
}

float parse_number(const std::string& word, const std::string& line, const CommandRow& row) {
    float value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        refuse_line(line, "'" + word + "' is not a finite number", "write " + usage_of(row));
    return value;
}

}  // namespace

std::span<const CommandRow> view_commands() { return commands; }

std::vector<std::string> choices_of(const CommandRow& row) {
    const std::string arguments = row.arguments;
    if (arguments.find('|') == std::string::npos || arguments.find(' ') != std::string::npos) return {};
    std::vector<std::string> choices;
    std::istringstream input(arguments);
    for (std::string choice; std::getline(input, choice, '|');) choices.push_back(choice);
    return choices;
}

ViewCommand parse_command(const std::string& line) {
    std::istringstream words(line);
    ViewCommand command;
    words >> command.name;
    const auto row = std::find_if(std::begin(commands), std::end(commands),
                                  [&](const CommandRow& r) { return command.name == r.name; });
    if (row == std::end(commands)) refuse_line(line, "unknown command", "claray view --help lists the commands");
    if (row->word != nullptr && !(words >> command.word))
        refuse_line(line, "an argument is missing", "write " + usage_of(*row));
    const std::vector<std::string> choices = choices_of(*row);
    if (!choices.empty() && std::find(choices.begin(), choices.end(), command.word) == choices.end())
        refuse_line(line, "unknown name '" + command.word + "'", "write " + usage_of(*row));
    for (std::string word; words >> word;) command.numbers.push_back(parse_number(word, line, *row));
    if (command.numbers.size() != row->numbers)
        refuse_line(line,
                    std::to_string(command.numbers.size()) + " numbers instead of " + std::to_string(row->numbers),
                    "write " + usage_of(*row));
    return command;
}

}  // namespace claray::view
