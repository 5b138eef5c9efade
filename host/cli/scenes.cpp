// claray scenes: the built-in scenes.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "claray/scene.hpp"
#include "host/cli/commands.hpp"

namespace claray::cli {
namespace {

void list_scenes(bool json) {
    if (json) {
        nlohmann::ordered_json names = nlohmann::ordered_json::array();
        for (const char* name : builtin_scene_names()) names.push_back(name);
        std::printf("%s\n", names.dump(2).c_str());
        return;
    }
    for (const char* name : builtin_scene_names()) std::printf("%s\n", name);
}

}  // namespace

void add_scenes_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("scenes", "List the built-in scenes; N is a number of triangles");
    auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "As JSON");
    command->callback([&action, json] { action = [json] { list_scenes(*json); }; });
}

}  // namespace claray::cli
