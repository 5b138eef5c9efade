// claray scenes: the built-in scenes.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "claray/scene.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/output/table.hpp"

namespace claray::cli {
namespace {

/// In the order of builtin_scene_names().
constexpr const char* descriptions[] = {
    "the Cornell box: two blocks under a lamp",
    "spheres with every material on a chequered floor",
    "wooden crates under a small, bright sun",
    "hills with firs around a mirroring lake",
    "hills of sines that shine, for shading models",
    "eight statues of 100,000 triangles each, for heat maps",
    "every effect but primitives at once",
    "one effect, by its name in claray explain: effect:mirror",
    "mountains and bushes, N triangles in total",
    "N random triangles, the hardest input for a tree",
    "N triangles in fans, each around one vertex",
    "strands of hair, N long thin triangles in total",
    "the strands of hair:N as round curves, about N / 3 of them",
    "a ball of N triangles with a highlight, for shading models",
};

void list_scenes(bool json) {
    const std::span<const char* const> names = builtin_scene_names();
    if (json) return print_json(std::vector<std::string>(names.begin(), names.end()));
    std::vector<Row> rows;
    for (std::size_t i = 0; i < names.size(); ++i)
        rows.push_back({names[i], i < std::size(descriptions) ? descriptions[i] : ""});
    print_table(rows);
}

}  // namespace

void add_scenes_command(CLI::App& app, Action& action) {
    CLI::App* command = app.add_subcommand("scenes", "List the built-in scenes; N is a number of triangles");
    auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "Print as JSON");
    command->callback([&action, json] { action = [json] { list_scenes(*json); }; });
}

}  // namespace claray::cli
