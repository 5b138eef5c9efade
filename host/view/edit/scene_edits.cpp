#include "host/view/edit/scene_edits.hpp"

#include <charconv>
#include <cmath>
#include <sstream>

#include "claray/error.hpp"
#include "host/base/format.hpp"
#include "host/view/edit/values.hpp"

namespace claray::view {
namespace {

constexpr const char* material_kind = "material";
constexpr const char* light_kind = "light";
constexpr const char* instance_kind = "instance";

/// An edit by its parts.
struct Edit {
    const std::string& text;
    std::string kind, name;
    std::size_t number = 0;
    std::vector<float> values;

    [[noreturn]] void refuse(const std::string& why, const std::string& remedy) const {
        throw Error(ErrorKind::usage, "'" + text + "': " + why, remedy);
    }
    void expect(std::size_t count) const {
        if (values.size() != count)
            refuse(printed("%s has %zu numbers", name.c_str(), values.size()), printed("give %zu", count));
    }
    [[nodiscard]] glm::vec3 triple() const { return expect(3), glm::vec3(values[0], values[1], values[2]); }
    template <class Thing>
    [[nodiscard]] Thing& of(std::vector<Thing>& things) const {
        if (number >= things.size())
            refuse(printed("there is no %s %zu", kind.c_str(), number),
                   printed("the scene has %zu; count from 0", things.size()));
        return things[number];
    }
};

template <class Number>
bool parses(const std::string& word, Number& number) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    return error == std::errc() && end == word.data() + word.size();
}

Edit parsed(const std::string& text) {
    Edit edit{text, {}, {}, 0, {}};
    std::istringstream words(text);
    std::string number;
    if (!(words >> edit.kind >> number >> edit.name) || !parses(number, edit.number))
        edit.refuse("it is no change of a scene", std::string("write ") + edit_help);
    for (std::string word; words >> word;) {
        float value = 0;
        if (!parses(word, value) || !std::isfinite(value))
            edit.refuse("'" + word + "' is not a finite number", std::string("write ") + edit_help);
        edit.values.push_back(value);
    }
    return edit;
}

template <class Thing, std::size_t triples, std::size_t numbers>
void set(Thing& thing, const Edit& edit, const TripleRow<Thing> (&of_three)[triples],
         const NumberRow<Thing> (&of_one)[numbers]) {
    for (const TripleRow<Thing>& row : of_three)
        if (edit.name == row.name) return void(thing.*row.member = edit.triple());
    for (const NumberRow<Thing>& row : of_one)
        if (edit.name == row.name) return edit.expect(1), void(thing.*row.member = edit.values[0]);
    edit.refuse("unknown value '" + edit.name + "'", "use " + names_of_values(of_three, of_one));
}

glm::mat4 matrix_of(const Edit& edit) {
    edit.expect(12);
    glm::mat4 matrix(1);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) matrix[column][row] = edit.values[std::size_t(4 * row + column)];
    return matrix;
}

void set(MeshInstance& instance, const Edit& edit) {
    if (edit.name == "transform")
        instance.transform = matrix_of(edit);
    else if (edit.name == "transform_end")
        instance.transform_end = matrix_of(edit);
    else
        edit.refuse("unknown value '" + edit.name + "'", "use transform or transform_end");
}

/// With as many digits as float32 needs.
class Writer {
public:
    Writer(const char* kind, std::size_t number, std::vector<std::string>& edits)
        : begin_(printed("%s %zu ", kind, number)), edits_(edits) {}

    void add(const char* name, const std::vector<float>& values) const {
        std::string edit = begin_ + name;
        for (const float value : values) edit += printed(" %.9g", double(value));
        edits_.push_back(edit);
    }
    void add(const char* name, const glm::mat4& matrix) const {
        std::vector<float> rows;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) rows.push_back(matrix[column][row]);
        add(name, rows);
    }

private:
    std::string begin_;
    std::vector<std::string>& edits_;
};

template <class Thing, std::size_t triples, std::size_t numbers>
void write_changes(const Thing& before, const Thing& after, const TripleRow<Thing> (&of_three)[triples],
                   const NumberRow<Thing> (&of_one)[numbers], const Writer& to) {
    for (const TripleRow<Thing>& row : of_three) {
        const glm::vec3& value = after.*row.member;
        if (before.*row.member != value) to.add(row.name, {value.x, value.y, value.z});
    }
    for (const NumberRow<Thing>& row : of_one)
        if (before.*row.member != after.*row.member) to.add(row.name, std::vector<float>{after.*row.member});
}

void write_changes(const MeshInstance& before, const MeshInstance& after, const Writer& to) {
    if (before.transform != after.transform) to.add("transform", after.transform);
    if (after.transform_end && before.transform_end != after.transform_end)
        to.add("transform_end", *after.transform_end);
}

}  // namespace

void place_all(Scene& scene) {
    if (scene.instances.empty())
        for (std::uint32_t mesh = 0; mesh < scene.meshes.size(); ++mesh) scene.instances.push_back({mesh});
}

void apply_edit(Scene& scene, const std::string& text) {
    const Edit edit = parsed(text);
    if (edit.kind == material_kind) return set(edit.of(scene.materials), edit, material_triples, material_numbers);
    if (edit.kind == light_kind) return set(edit.of(scene.lights), edit, light_triples, light_numbers);
    if (edit.kind != instance_kind) edit.refuse("unknown kind '" + edit.kind + "'", "use material, light or instance");
    place_all(scene);
    set(edit.of(scene.instances), edit);
}

bool moves_instance(const std::string& edit) { return edit.starts_with(instance_kind); }

std::vector<std::string> edits_between(const Scene& before, const Scene& after) {
    std::vector<std::string> edits;
    for (std::size_t i = 0; i < before.materials.size(); ++i)
        write_changes(before.materials[i], after.materials[i], material_triples, material_numbers,
                      {material_kind, i, edits});
    for (std::size_t i = 0; i < before.lights.size(); ++i)
        write_changes(before.lights[i], after.lights[i], light_triples, light_numbers, {light_kind, i, edits});
    for (std::size_t i = 0; i < before.instances.size(); ++i)
        write_changes(before.instances[i], after.instances[i], {instance_kind, i, edits});
    return edits;
}

}  // namespace claray::view
