#include "host/cli/options/view_options.hpp"

#include <algorithm>

#include "claray/error.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/picture/lens_options.hpp"
#include "host/view/edit/scene_edits.hpp"

namespace claray::cli {
namespace {

/// "1,-2,3.5" -> vector
glm::vec3 parse_vector(const std::string& option, const std::string& text) {
    const std::vector<float> numbers = parse_numbers(text);
    if (numbers.size() != 3)
        throw Error(ErrorKind::usage, option + ": '" + text + "' is not a vector", "write three numbers: X,Y,Z");
    return {numbers[0], numbers[1], numbers[2]};
}

bool is_fisheye(const Camera& camera) {
    return camera.projection == Projection::fisheye || camera.projection == Projection::equisolid;
}

/// The field of view by which a camera is placed: that of a fisheye may be more than half of the surroundings.
std::optional<float> flat_fov(const ViewOptions& options) {
    const bool is_wide = options.projection && is_fisheye(Camera{.projection = *options.projection});
    return is_wide ? std::nullopt : options.fov;
}

/// The scene's own camera or the automatic one, with the changes of the command line.
Camera choose_camera(Camera camera, const ViewOptions& options) {
    // A camera at another place does not keep the motion of the scene's camera.
    if (options.camera) camera.position = *options.camera, camera.position_end.reset();
    if (options.look_at) camera.target = *options.look_at, camera.target_end.reset();
    if (options.camera_end) camera.position_end = options.camera_end;
    if (options.look_at_end) camera.target_end = options.look_at_end;
    if (options.projection) camera.projection = *options.projection;
    if (options.fov && !options.projection && !is_fisheye(camera)) camera.projection = Projection::perspective;
    if (options.fov) camera.vertical_fov = *options.fov;
    if (options.projection && is_fisheye(camera) && !options.fov) camera.vertical_fov = 180.f;
    if (options.ortho) camera.orthographic_height = *options.ortho, camera.projection = Projection::orthographic;
    camera = with_lens(camera, options.lens);
    if (options.aperture) camera.aperture_radius = *options.aperture;
    if (options.focus_distance) camera.focus_distance = *options.focus_distance;
    if (options.focus_distance && camera.aperture_radius == 0.f)
        throw Error(ErrorKind::usage, "--focus-distance has no effect without a lens", "add --aperture");
    if (options.up) camera.up = *options.up;
    return camera;
}

void apply(const std::string& edit, Scene& scene) {
    try {
        view::apply_edit(scene, edit);
    } catch (const Error& error) {
        throw Error(error.kind(), std::string("--set ") + error.what());
    }
}

}  // namespace

CLI::Option* add_vector_option(CLI::App& command, const char* name, glm::vec3& vector, const char* description) {
    return command.add_option_function<std::string>(
        name, [name, &vector](const std::string& text) { vector = parse_vector(name, text); }, description);
}

void add_view_options(CLI::App& command, ViewOptions& o) {
    const auto add_vector = [&](const char* name, std::optional<glm::vec3>& vector, const char* description) {
        command
            .add_option_function<std::string>(
                name, [name, &vector](const std::string& text) { vector = parse_vector(name, text); }, description)
            ->type_name("X,Y,Z");
    };
    add_load_options(command, o.load);
    OptionGroup group(command, "File");
    command.add_option("--file-camera", o.load.camera,
                       "Camera of a glTF, by name or by index in the scene [the first; if there is none, a camera that "
                       "sees the whole scene]");
    group.next("Camera");
    add_vector("--camera", o.camera, "Position of the camera, X,Y,Z [scene's camera]");
    add_vector("--look-at", o.look_at, "Point in the middle of the image, X,Y,Z [scene's camera]");
    add_vector("--up", o.up, "Direction that is up in the image, X,Y,Z [scene's camera, else 0,1,0]");
    command.add_option("--fov", o.fov, "Vertical field of view in degrees [scene's camera, else 40; of fisheyes 180]")
        ->check(finite_number());
    group.next("Lens and motion");
    std::vector<std::pair<std::string, Projection>> kinds;
    for (const ProjectionTraits& traits : projections) kinds.emplace_back(traits.name, traits.kind);
    std::string names;
    for (const auto& [name, kind] : kinds) names += (names.empty() ? "" : ", ") + name;
    command.add_option("--projection", o.projection, "How the camera shows space: " + names + " [perspective]")
        ->transform(choice_of(kinds))
        ->type_name("NAME");
    command.add_option("--ortho", o.ortho, "Use parallel rays; height of the image, in units of the scene")
        ->check(positive_number())
        ->type_name("HEIGHT");
    command.add_option("--aperture", o.aperture, "Radius of the lens, in units of the scene, for depth of field [0]")
        ->check(number_from_0());
    command
        .add_option("--focus-distance", o.focus_distance,
                    "Distance of the sharp plane along the view [that of --look-at]")
        ->check(positive_number());
    add_lens_options(command, o.lens);
    add_vector("--camera-end", o.camera_end, "Position at shutter close, X,Y,Z, for motion blur");
    add_vector("--look-at-end", o.look_at_end, "Point in the middle at shutter close, X,Y,Z");
    add_light_options(command, o.lights);
    add_surface_options(command, o.surfaces);
    group.next("File");
    command
        .add_option("--set", o.edits,
                    "Change a material, a light or an instance, which count from 0, as claray view does: 'material 2 "
                    "roughness 0.3', 'light 0 intensity 5 5 5' or 'instance 3 transform' with three rows of four "
                    "numbers")
        ->take_all()
        ->type_name("TEXT");
}

Scene load_view(const std::string& name, const ViewOptions& options, unsigned width, unsigned height,
                FirstFrame* first) {
    if (options.fov && options.ortho)
        throw Error(ErrorKind::usage, "--fov and --ortho contradict each other: parallel rays have no angle",
                    "leave one of them out");
    FirstFrame alone;
    FirstFrame& frames = first ? *first : alone;
    ViewChoice choice;
    choice.aspect = float(width) / float(height), choice.exposes = options.exposes;
    choice.camera = [&](const Scene& scene) {
        if (scene.camera) return choose_camera(*scene.camera, options);
        if (!frames.camera) frames.camera = automatic_camera(scene, flat_fov(options).value_or(40.f), choice.aspect);
        return choose_camera(*frames.camera, options);
    };
    const bool placed = options.camera || options.look_at || options.camera_end || options.look_at_end || options.up;
    if (!placed && !options.ortho) choice.inside = flat_fov(options).value_or(MayChoose{}.inside_fov);
    LoadOptions parts = options.load;
    parts.live |= std::ranges::any_of(options.edits, view::moves_instance);
    Scene scene = load(name, parts, options.lights, options.surfaces, choice, &frames.light);
    if (frames.camera) {  // which may be inside now
        frames.camera = scene.camera;
        scene.camera = choose_camera(*frames.camera, options);
    }
    for (const std::string& edit : options.edits) apply(edit, scene);
    return scene;
}

}  // namespace claray::cli
