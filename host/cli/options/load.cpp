#include "host/cli/options/load.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/cli/help/help.hpp"
#include "host/cli/options/option_rules.hpp"
#include "host/cli/output/messages.hpp"
#include "host/io/default_light.hpp"

namespace claray::cli {
namespace {

/// Builders leave out triangles that are huge or not finite, and no ray hits a triangle without area.
bool can_be_seen(const Mesh& mesh, const glm::uvec3& triangle) {
    constexpr float huge = 1e18f;
    glm::dvec3 corners[3];
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& p = mesh.positions[triangle[k]];
        if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= huge)) return false;
        corners[k] = p;
    }
    return glm::cross(corners[1] - corners[0], corners[2] - corners[0]) != glm::dvec3(0.);
}

void refuse_unseen(const std::string& name, const Scene& scene) {
    const bool any = std::any_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& mesh) {
        return std::any_of(mesh.triangles.begin(), mesh.triangles.end(),
                           [&](const glm::uvec3& triangle) { return can_be_seen(mesh, triangle); });
    });
    const std::size_t triangles = triangle_count(scene);
    if (any || triangles == 0) return;
    throw Error(ErrorKind::user,
                "'" + name + "' has no visible triangle: all " + std::to_string(triangles) +
                    " are without area, not finite or beyond 1e18",
                "export the mesh again");
}

/// Lines about what was chosen to show a file, with the options that choose otherwise.
Warnings lines_of(const Chosen& chosen, bool exposes) {
    const std::string sides = chosen.past_backs ? "; --cull none shows one-sided surfaces from both sides" : "";
    Warnings lines;
    if (!chosen.view.empty()) lines.push_back(chosen.view + "; choose another with --camera and --look-at" + sides);
    exposes = exposes && chosen.added.exposure;
    if (!chosen.light.empty())
        lines.push_back(chosen.light +
                        (exposes ? printed(", with an exposure of %+.1f stops", double(*chosen.added.exposure)) : "") +
                        "; choose other light with --light, --sky or --environment" +
                        (exposes ? ", and another exposure with --exposure" : "") + (chosen.view.empty() ? sides : ""));
    return lines;
}

}  // namespace

void print_warnings(const Warnings& warnings) {
    static std::set<std::string> printed;  // frames of an animation warn of the same things
    for (const std::string& warning : warnings)
        if (printed.insert(warning).second) print_warning(warning);
}

void add_load_options(CLI::App& command, LoadOptions& o) {
    const OptionGroup group(command, "File");
    command.add_option("--at", o.time, "Time in the animation of a glTF, in seconds [rest pose]")
        ->check(number_from_0())
        ->type_name("SECONDS");
    command.add_option("--animation", o.animation, "Animation by name or index; all: all at once [the first]");
    command.add_option("--variant", o.variant, "Material variant of a glTF, by name or index [the default materials]");
    command.add_option("--file-scene", o.scene, "Scene of a glTF with several scenes, by name or index [its default]");
    command
        .add_option(
            "--stroke-radius", o.stroke_radius,
            "Radius of the spheres and tubes for points and lines of a file; 0: leave them out [by the scene's size]")
        ->check(number_from_0())
        ->type_name("R");
}

void add_surface_options(CLI::App& command, SurfaceOptions& o) {
    const OptionGroup group(command, "Surfaces");
    command
        .add_option("--cull", o.culling,
                    "Sides of surfaces to leave out: back, none, or file (as in the materials) [file]")
        ->transform(choice_of<Culling>({{"file", Culling::by_file}, {"back", Culling::back}, {"none", Culling::none}}))
        ->type_name("NAME");
    command
        .add_option("--front", o.clockwise_front,
                    "Order of the vertices of a front: ccw (counter-clockwise) or cw [ccw]")
        ->transform(choice_of({{"ccw", 0}, {"cw", 1}}))
        ->type_name("NAME");
    command
        .add_option("--alpha-test", o.alpha_test,
                    "Where masks exist, by opacity and cut-off: greater-equal, greater, less, less-equal, equal or "
                    "not-equal [greater-equal]")
        ->transform(choice_of<AlphaTest>({{"greater-equal", AlphaTest::greater_equal},
                                          {"greater", AlphaTest::greater},
                                          {"less", AlphaTest::less},
                                          {"less-equal", AlphaTest::less_equal},
                                          {"equal", AlphaTest::equal},
                                          {"not-equal", AlphaTest::not_equal}}))
        ->type_name("NAME");
    command
        .add_option("--texture-filter", o.texture_filter,
                    "Filter of all textures: nearest, bilinear, trilinear or nearest-level [as in the file]")
        ->transform(choice_of<Filter>({{"nearest", Filter::nearest},
                                       {"bilinear", Filter::bilinear},
                                       {"trilinear", Filter::trilinear},
                                       {"nearest-level", Filter::nearest_level}}))
        ->type_name("NAME");
}

Scene load(const std::string& name, const LoadOptions& options, const LightOptions& lights,
           const SurfaceOptions& surfaces, const ViewChoice& view, std::optional<DefaultLight>* default_light) {
    Warnings warnings;
    auto [scene, is_file] = load_without_light(name, warnings, options);
    if (surfaces.clockwise_front) flip_fronts(scene);
    set_culling(scene, Culling(surfaces.culling));
    for (Material& material : scene.materials)
        if (surfaces.alpha_test) material.alpha_test = AlphaTest(*surfaces.alpha_test);
    for (Texture& texture : scene.textures)
        if (surfaces.texture_filter) texture.filter = Filter(*surfaces.texture_filter);
    print_warnings(warnings);
    if (!options.time) refuse_unseen(name, scene);  // an animation may hide all for a while
    const bool lit = add_lights(scene, lights), has_camera = scene.camera.has_value();
    if (view.camera) scene.camera = view.camera(scene);
    add_studio(scene, lights);
    if (!is_file) return scene;
    const bool is_later_frame = default_light && *default_light;
    if (is_later_frame && !lit) add(scene, **default_light);
    if (is_later_frame) return scene;
    const bool shows_walls = surfaces.culling == int(Culling::none);
    const MayChoose may{!lit, !has_camera && view.inside && !shows_walls, view.inside.value_or(0.f)};
    const Chosen chosen = make_visible(scene, camera_of(scene), view.aspect, may);
    print_warnings(lines_of(chosen, view.exposes));
    if (default_light) *default_light = chosen.added;
    return scene;
}

}  // namespace claray::cli
