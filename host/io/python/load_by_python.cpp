// Scenes of USD and Blender: Python, or Blender, turns them into a glTF in a process of its own, which is read as any
// other.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/base/folders.hpp"
#include "host/base/message.hpp"
#include "host/base/process/environment.hpp"
#include "host/base/process/process.hpp"
#include "host/io/python/blend_script.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using ConverterEnd = ProgramOutput::End;
using Json = nlohmann::json;

constexpr const char* glb_name = "scene.glb";
constexpr int missing_package = 77;  // the exit code of a process whose Python lacks a package
// claray's module imports what reads USD; another ImportError than its own must not look like a missing package.
constexpr const char* usd_script =
    "import sys\n"
    "try:\n"
    "    from claray.usd import main\n"
    "except ImportError:\n"
    "    sys.exit(77)\n"
    "main(sys.argv[1:])\n";

/// Five minutes, or $CLARAY_IMPORT_SECONDS.
double most_converter_seconds() {
    const std::optional<double> given = number_in(environment("CLARAY_IMPORT_SECONDS"));
    return given && *given > 0 ? std::min(*given, 1e6) : 300;
}

/// The value of a variable, or a program of $PATH.
std::string program_of(const char* variable, const char* name) {
    const std::string given = environment(variable);
    return given.empty() ? name : given;
}

/// What a process is called in messages, and how it is started.
struct Converter {
    std::string name;
    std::vector<std::string> arguments;
};

ProgramOutput run_converter(const Converter& converter) {
    return run_program(converter.arguments, {most_converter_seconds(), std::size_t(1) << 24});
}

/// Throws unless the process ended well.
void check_converter_end(const ProgramOutput& result, const Converter& converter, const std::string& file) {
    const std::string who = file + ": " + converter.name;
    if (result.end == ConverterEnd::too_slow)
        throw Error(ErrorKind::user,
                    who + " took more than " + std::to_string(std::int64_t(most_converter_seconds())) + " s",
                    "give it more by CLARAY_IMPORT_SECONDS");
    if (result.end == ConverterEnd::killed)
        throw Error(ErrorKind::user, who + " crashed (signal " + std::to_string(result.code) + ")",
                    "the file may be damaged; export it again, or as glTF");
    if (result.end == ConverterEnd::exited && result.code == 0) return;
    std::string reason = result.errors;  // of which the last line says what failed
    while (!reason.empty() && std::isspace(static_cast<unsigned char>(reason.back())) != 0) reason.pop_back();
    reason = one_line(reason.substr(reason.rfind('\n') + 1), 200);
    throw Error(ErrorKind::user, who + " says: " + (reason.empty() ? "nothing" : reason),
                "export it again, or as glTF");
}

/// A glTF that a converter wrote, and what it says besides.
struct Converted {
    std::string glb;
    Json extra;
    std::shared_ptr<const fs::path> folder;  // which has the image around the scene
};

Converted read_converted(std::shared_ptr<const fs::path> folder, const Converter& converter, const std::string& file) {
    const fs::path glb = *folder / glb_name;
    const std::string remedy = "export the scene again, or as glTF";
    std::error_code none;
    if (!fs::exists(glb, none)) throw Error(ErrorKind::user, file + ": " + converter.name + " wrote nothing", remedy);
    Json extra = Json::parse(read_file(fs::path(glb).replace_extension(".json"), remedy), nullptr, false);
    if (!extra.is_object()) throw Error(ErrorKind::user, file + ": " + converter.name + " wrote no JSON", remedy);
    return {read_file(glb, remedy), std::move(extra), std::move(folder)};
}

glm::vec3 json_vector(const Json& values) {
    const auto v = values.get<std::array<float, 3>>();
    return {v[0], v[1], v[2]};
}

/// What glTF lacks: a sky, an image around the scene, and suns with an extent.
void add_extra(const Json& extra, Scene& scene, Warnings& warnings, const std::string& file) try {
    for (const Json& line : extra.at("warnings"))
        warnings.push_back(file + ": " + one_line(line.get<std::string>(), 200));
    if (const Json& sky = extra.at("sky"); !sky.is_null()) scene.sky.horizon = scene.sky.zenith = json_vector(sky);
    if (const Json& image = extra.at("environment"); !image.is_null()) {
        scene.environment = load_environment(image.at("file").get<std::string>(), warnings);
        scene.environment.strength = image.at("strength").get<float>();
        scene.environment.rotation = image.at("rotation").get<float>();
    }
    for (const Json& sun : extra.at("suns")) {
        Light light;
        light.kind = LightKind::sun;
        light.direction = json_vector(sun.at("direction"));
        light.intensity = json_vector(sun.at("irradiance"));
        light.outer_angle = sun.at("angle").get<float>();
        scene.lights.push_back(light);
    }
} catch (const Json::exception& error) {
    throw Error(ErrorKind::user, file + ": " + one_line(error.what(), 120), "report this as a fault of claray");
}

Converted converted_usd(const fs::path& path, const LoadOptions& options) {
    check_file_readable(path, "check the path");
    const std::string file = "'" + path.string() + "'";
    const auto folder = scratch_folder();
    const fs::path glb = *folder / glb_name;
    Converter usd{"the library of USD",
                  {program_of("CLARAY_PYTHON", "python3"), "-c", usd_script, path.string(), glb.string()}};
    if (options.time) usd.arguments.push_back(std::to_string(*options.time));
    const ProgramOutput result = run_converter(usd);
    if (result.end == ConverterEnd::not_started ||
        (result.end == ConverterEnd::exited && result.code == missing_package))
        throw Error(
            ErrorKind::user,
            file + ": USD is read by Python's claray and usd-core, which " + usd.arguments[0] + " does not have",
            "pip install claray usd-core, or name another interpreter by CLARAY_PYTHON");
    check_converter_end(result, usd, file);
    return read_converted(folder, usd, file);
}

/// Blender, if it is installed, otherwise Python's bpy.
std::vector<Converter> blenders(const std::string& source, const std::string& target) {
    const std::string blender = program_of("CLARAY_BLENDER", "blender"),
                      python = program_of("CLARAY_PYTHON", "python3");
    return {{"Blender",
             {blender, "-b", "--factory-startup", "--disable-autoexec", "--python-exit-code", "1", "--python-expr",
              blend_script, "--", source, target}},
            {"Blender (bpy)", {python, "-c", blend_script, source, target}}};
}

Converted converted_blend(const fs::path& path) {
    check_file_readable(path, "check the path");
    const std::string file = "'" + path.string() + "'";
    const auto folder = scratch_folder();
    const fs::path glb = *folder / glb_name;
    for (const Converter& converter : blenders(fs::absolute(path).string(), glb.string())) {
        const ProgramOutput result = run_converter(converter);
        if (result.end == ConverterEnd::not_started ||
            (result.end == ConverterEnd::exited && result.code == missing_package))
            continue;
        check_converter_end(result, converter, file);
        return read_converted(folder, converter, file);
    }
    throw Error(ErrorKind::user, file + ": files of Blender are read by Blender, which is not installed",
                "install it, or pip install bpy, or name it by CLARAY_BLENDER or CLARAY_PYTHON");
}

Scene load_converted(const fs::path& path, const Converted& made, Warnings& warnings, const LoadOptions& options) {
    Scene scene = load_gltf_bytes(path, made.glb, warnings, options);
    add_extra(made.extra, scene, warnings, "'" + path.string() + "'");
    return scene;
}

}  // namespace

Scene load_usd_without_light(const fs::path& path, Warnings& warnings, const LoadOptions& options) {
    LoadOptions at_that_time = options;
    at_that_time.time.reset();
    return load_converted(path, converted_usd(path, options), warnings, at_that_time);
}

std::optional<double> usd_animation_seconds(const fs::path& path, const LoadOptions& options) {
    const Json seconds = converted_usd(path, options).extra.value("seconds", Json());
    return seconds.is_number() ? seconds.get<double>() : std::optional<double>();
}

Scene load_blend_without_light(const fs::path& path, Warnings& warnings, const LoadOptions& options) {
    return load_converted(path, converted_blend(path), warnings, options);
}

std::optional<double> blend_animation_seconds(const fs::path& path, const LoadOptions& options) {
    return gltf_animation_seconds(path, converted_blend(path).glb, options);
}

}  // namespace claray
