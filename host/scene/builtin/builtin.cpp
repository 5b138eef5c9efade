#include "host/scene/builtin/builtin.hpp"

#include <array>
#include <charconv>
#include <limits>
#include <string_view>

#include "claray/error.hpp"
#include "host/base/host_memory.hpp"

namespace claray {
namespace {

struct FixedScene {
    std::string_view name;
    Scene (*make)();
};
constexpr std::array fixed_scenes = {FixedScene{"cornell", scenes::cornell}, FixedScene{"spheres", scenes::spheres},
                                     FixedScene{"crate", scenes::crate},     FixedScene{"hills", scenes::hills},
                                     FixedScene{"effects", scenes::effects}, FixedScene{"waves", scenes::waves},
                                     FixedScene{"statues", scenes::statues}};

struct CountedScene {
    std::string_view name;
    std::size_t least;
    Scene (*make)(std::size_t);
};
constexpr std::array counted_scenes = {
    CountedScene{"terrain", 1, scenes::terrain}, CountedScene{"soup", 1, scenes::soup},
    CountedScene{"fan", 3, scenes::fan},         CountedScene{"hair", 1, scenes::hair},
    CountedScene{"curves", 1, scenes::curves},   CountedScene{"ball", 8, scenes::ball}};

/// With three vertices for each triangle, which have numbers of 32 bits.
constexpr std::size_t most_triangles = std::numeric_limits<std::uint32_t>::max() / 3;
/// Of the host: three vertices, their numbers and a material.
constexpr std::size_t bytes_per_triangle = 3 * sizeof(glm::vec3) + sizeof(glm::uvec3) + sizeof(std::uint32_t);
// host/cli/scenes.cpp describes them in this order.
constexpr std::array names = {"cornell",     "spheres",   "crate",  "hills", "waves",  "statues",  "effects",
                              "effect:NAME", "terrain:N", "soup:N", "fan:N", "hair:N", "curves:N", "ball:N"};

std::size_t parse_count(const CountedScene& scene, std::string_view text) {
    std::size_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size() || count < scene.least || count > most_triangles) {
        const std::string name(scene.name);
        throw Error(ErrorKind::usage, "scene '" + name + ":N': N is '" + std::string(text) + "'",
                    "use a number of triangles from " + std::to_string(scene.least) + " to " +
                        std::to_string(most_triangles) + ", for example " + name + ":10000");
    }
    if (const std::uint64_t bytes = count * bytes_per_triangle, left = free_host_memory(); bytes > left)
        throw Error(ErrorKind::user,
                    "scene '" + std::string(scene.name) + ':' + std::string(text) + "' takes up to " +
                        std::to_string(bytes >> 20) + " MiB of the host's memory, of which " +
                        std::to_string(left >> 20) + " MiB are free",
                    "use fewer triangles, or a machine with more memory");
    return count;
}

std::optional<Scene> made_scene(const std::string& name) {
    for (const FixedScene& scene : fixed_scenes)
        if (name == scene.name) return scene.make();
    const std::size_t colon = name.find(':');
    const std::string rest = colon == std::string::npos ? "" : name.substr(colon + 1);
    if (name.starts_with("effect:")) return scenes::effect_alone(rest);
    for (const CountedScene& scene : counted_scenes)
        if (name.substr(0, colon) == scene.name) return scene.make(parse_count(scene, rest));
    return {};
}

}  // namespace

std::optional<Scene> builtin_scene(const std::string& name) {
    std::optional<Scene> scene = made_scene(name);
    if (scene) scene->name = name;
    return scene;
}

std::span<const char* const> builtin_scene_names() { return names; }

}  // namespace claray
