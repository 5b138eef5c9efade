// Scenes of other programs: claray-import, a process of its own, turns them into a glTF, which is read as any other.
#include <algorithm>
#include <sstream>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/base/format.hpp"
#include "host/base/message.hpp"
#include "host/base/process/environment.hpp"
#include "host/base/process/process.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using ProgramEnd = ProgramOutput::End;

constexpr const char* import_name = "claray-import";
constexpr const char* convert_to_gltf = "convert it to glTF, for example by Blender";

bool is_program(const fs::path& path) {
    std::error_code error;
    return fs::is_regular_file(path, error);
}

/// $CLARAY_IMPORT, else beside this program, where installations have it, or in the folders of $PATH. Empty: none.
std::string import_program() {
    const std::string given = environment("CLARAY_IMPORT");
    if (!given.empty()) return is_program(given) ? given : std::string();
    const std::string own = fs::path(this_program()).parent_path().string();
    std::istringstream folders(own + ":" + own + "/../libexec/claray:" + environment("PATH") +
                               ":/usr/local/libexec/claray:/usr/libexec/claray");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (!folder.empty() && is_program(fs::path(folder) / import_name)) return fs::path(folder) / import_name;
    return {};
}

/// Five minutes, or $CLARAY_IMPORT_SECONDS.
double most_import_seconds() {
    const std::optional<double> given = number_in(environment("CLARAY_IMPORT_SECONDS"));
    return given && *given > 0 ? std::min(*given, 1e6) : 300;
}

/// By which Assimp knows the format: the file's extension, or the first of its row if its content told the format.
std::string assimp_extension(const fs::path& path, const SceneReader& reader) {
    const std::string own = lower_case(path.extension().string());
    std::string_view known = reader.extensions;
    const std::string_view first = next_word(known);
    for (std::string_view word = first; !word.empty(); word = next_word(known))
        if (word == own) return own.substr(1);
    return std::string(first.substr(1));
}

[[noreturn]] void refuse_output(const ProgramOutput& result, const std::string& file, const std::string& format) {
    const std::string reader = "Assimp's reader of " + format;
    switch (result.end) {
        case ProgramEnd::not_started:
            throw Error(ErrorKind::user, file + ": " + import_name + " cannot be started", "install it again");
        case ProgramEnd::too_slow:
            throw Error(ErrorKind::user,
                        file + ": " + reader + printed(" took more than %.3g s", most_import_seconds()),
                        std::string("give it more by CLARAY_IMPORT_SECONDS, or ") + convert_to_gltf);
        case ProgramEnd::too_long:
            throw Error(ErrorKind::user, file + ": its glTF has more than 4 GiB", "use a smaller scene");
        case ProgramEnd::killed:
            throw Error(ErrorKind::user, file + ": " + reader + " crashed (signal " + std::to_string(result.code) + ")",
                        convert_to_gltf);
        case ProgramEnd::exited: break;
    }
    const std::string reason = one_line(result.errors.substr(0, result.errors.find('\n')), 120);
    throw Error(ErrorKind::user, file + ": " + reader + " says: " + (reason.empty() ? "nothing" : reason),
                std::string("export it again, or ") + convert_to_gltf);
}

/// The scene as a binary glTF. What was left out becomes warnings.
std::string imported_by_assimp(const fs::path& path, Warnings& warnings) {
    check_file_readable(path, "check the path");
    const SceneReader& reader = *scene_reader_of(path);
    const std::string file = "'" + path.string() + "'", program = import_program();
    if (program.empty())
        throw Error(ErrorKind::user,
                    file + ": " + import_name + ", which reads " + reader.name + " by Assimp, is not installed",
                    "install the package claray-import, or build claray with libassimp-dev");
    constexpr std::size_t most = std::size_t(1) << 32;  // a .glb states its size in 32 bits
    ProgramOutput result =
        run_program({program, path.string(), assimp_extension(path, reader)}, {most_import_seconds(), most});
    if (result.end != ProgramEnd::exited || result.code != 0) refuse_output(result, file, reader.name);
    std::istringstream lines(result.errors);
    for (std::string line; std::getline(lines, line);) warnings.push_back(file + ": " + one_line(line, 120));
    return std::move(result.output);
}

}  // namespace

Scene load_by_assimp_without_light(const fs::path& path, Warnings& warnings, const LoadOptions& options) {
    return load_gltf_bytes(path, imported_by_assimp(path, warnings), warnings, options);
}

std::optional<double> assimp_animation_seconds(const fs::path& path, const LoadOptions& options) {
    Warnings ignored;  // they are those of loading
    return gltf_animation_seconds(path, imported_by_assimp(path, ignored), options);
}

}  // namespace claray
