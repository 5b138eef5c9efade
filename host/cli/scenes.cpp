// claray scenes: the built-in scenes.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "claray/scene.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

/// What they show, in the order of their names.
constexpr const char* descriptions[] = {
    "the Cornell box: two blocks under a lamp",
    "spheres of every material on a chequered floor",
    "wooden crates under a small strong sun",
    "hills with firs round a lake that mirrors them",
    "every effect at once",
    "one effect, by a name that claray explain gives it: effect:mirror",
    "mountains and bushes, N triangles in all",
    "N random triangles, the hardest input for a tree",
    "N triangles in fans, each round one vertex",
    "strands of hair, N long thin triangles in all",
};

void list_scenes(bool json) {
    const std::span<const char* const> names = builtin_scene_names();
    if (json) {
        std::printf("%s\n",
                    nlohmann::ordered_json(std::vector<std::string>(names.begin(), names.end())).dump(2).c_str());
        return;
    }
    std::vector<Row> rows;
    for (std::size_t i = 0; i < names.size(); ++i)
        rows.push_back({names[i], i < std::size(descriptions) ? descriptions[i] : ""});
    print_table(rows);
}

}  // namespace

void add_scenes_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("scenes", "List the built-in scenes; N is a number of triangles");
    auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "As JSON");
    command->callback([&action, json] { action = [json] { list_scenes(*json); }; });
}

}  // namespace claray::cli
