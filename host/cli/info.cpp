// claray info: what a scene file contains, without a device.
#include <memory>
#include <nlohmann/json.hpp>

#include "claray/effects.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options/load.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

struct InfoOptions {
    std::string scene;
    LoadOptions load;
    bool json = false;
};

struct Contents {
    const char* name;
    std::size_t count;
};

std::vector<Contents> contents_of(const Scene& scene) {
    std::size_t vertices = 0, texels = 0, primitives = 0;
    for (const Mesh& mesh : scene.meshes) vertices += mesh.positions.size();
    for (const PrimitiveSet& set : scene.primitives) primitives += primitive_count(set);
    for (const Texture& texture : scene.textures) texels += std::size_t(texture.width) * texture.height;
    return {{"meshes", scene.meshes.size()},      {"vertices", vertices},     {"instances", scene.instances.size()},
            {"triangles", triangle_count(scene)}, {"primitives", primitives}, {"materials", scene.materials.size()},
            {"textures", scene.textures.size()},  {"texels", texels},         {"lights", scene.lights.size()},
            {"cameras", scene.camera ? 1u : 0u}};
}

void print_contents(const Scene& scene, const Bounds& bounds) {
    std::vector<Row> rows;
    for (const Contents& of : contents_of(scene)) rows.push_back({of.name, std::to_string(of.count)});
    print_table(rows, 1);
    const auto point = [](const glm::vec3& p) { return number(p.x) + "," + number(p.y) + "," + number(p.z); };
    std::printf("from %s to %s\neffects: %s\n", point(bounds.lo).c_str(), point(bounds.hi).c_str(),
                to_string(effects_of(scene)).c_str());
}

void print_contents_as_json(const Scene& scene, const Bounds& bounds) {
    nlohmann::ordered_json json;
    for (const Contents& of : contents_of(scene)) json[of.name] = of.count;
    json["from"] = {bounds.lo.x, bounds.lo.y, bounds.lo.z};
    json["to"] = {bounds.hi.x, bounds.hi.y, bounds.hi.z};
    json["effects"] = nlohmann::ordered_json::array();
    for (const EffectCause& cause : causes_of_effects(scene)) json["effects"].push_back(name_of(cause.effect));
    print_json(json);
}

void print_info(const InfoOptions& options) {
    Warnings warnings;
    const Scene scene = load_scene(options.scene, warnings, options.load);
    print_warnings(warnings);
    const Bounds bounds = bounds_of(scene);
    options.json ? print_contents_as_json(scene, bounds) : print_contents(scene, bounds);
}

}  // namespace

void add_info_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("info", "Print what a scene contains: counts, bounds and effects");
    command->footer(
        "Needs no OpenCL device.\n"
        "Examples:\n"
        "  claray info scene.gltf\n"
        "  claray info scene.obj --json");
    auto o = std::make_shared<InfoOptions>();
    command->add_option("scene", o->scene, "A scene file, or a built-in scene (see claray scenes)")->required();
    add_load_options(*command, o->load);
    command->add_flag("--json", o->json, "Print as JSON");
    command->callback([&action, o] { action = [o] { print_info(*o); }; });
}

}  // namespace claray::cli
