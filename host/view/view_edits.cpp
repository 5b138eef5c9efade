// What the commands of a view change in its scene.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "host/base/format.hpp"
#include "host/view/camera_control.hpp"
#include "host/view/edit/scene_edits.hpp"
#include "host/view/edit/values.hpp"
#include "host/view/refuse.hpp"
#include "host/view/view.hpp"

namespace claray::view {
namespace {

std::string name_of(const std::string& name, std::size_t number) {
    return name.empty() ? std::to_string(number) : "'" + name + "'";
}

/// A command counts objects, materials and lights from 0.
std::uint32_t number_in(const std::string& command, const char* what, float number, std::size_t count) {
    if (!(number >= 0 && double(number) < double(count)))
        refuse(command + printed(": there is no %s %g", what, double(number)),
               printed("the scene has %zu; count from 0", count));
    return std::uint32_t(number);
}

}  // namespace

template <class Part, class Edit>
void View::change(std::vector<Part> Scene::*part, const SceneChanges& changes, const Edit& edit) {
    std::vector<Part> before = scene_.*part;
    try {
        edit(scene_.*part);
        renderer_->update(scene_, changes);
    } catch (...) {
        scene_.*part = std::move(before);
        throw;
    }
    if ((original_.*part).empty()) original_.*part = before;
    history_.add(std::move(before));
    spp_ = 0;
}

std::vector<std::string> View::edits() const { return edits_between(original_, scene_); }

void View::exchange_step(Step& step) {
    const auto with = [&](auto Scene::*part, auto& list, const SceneChanges& changes) {
        std::swap(scene_.*part, list);
        try {
            renderer_->update(scene_, changes);
        } catch (...) {
            std::swap(scene_.*part, list);
            throw;
        }
    };
    if (auto* materials = std::get_if<std::vector<Material>>(&step))
        with(&Scene::materials, *materials, {.materials = true});
    if (auto* lights = std::get_if<std::vector<Light>>(&step)) with(&Scene::lights, *lights, {.lights = true});
    if (auto* instances = std::get_if<std::vector<MeshInstance>>(&step))
        with(&Scene::instances, *instances, {.instances = true});
    if (selected_) held_ = middle_of_object();
    spp_ = 0;
}

std::string View::change_history(const ViewCommand& command) {
    if (command.name == "hold") {
        history_.hold(command.word == "on");
        return {};
    }
    const auto exchange = [&](Step& step) { exchange_step(step); };
    const bool any = command.name == "undo" ? history_.undo(exchange) : history_.redo(exchange);
    return any ? "" : "nothing to " + command.name;
}

void View::hold_nothing() { selected_.reset(), light_.reset(), material_.reset(), parts_.clear(); }

/// Parts of one object have its name and its transform.
void View::hold_object(const Selection& selection) {
    hold_nothing();
    selected_ = selection, material_ = selection.material;
    const MeshInstance& first = scene_.instances[*selection.instance];
    Bounds bounds;
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
        const MeshInstance& other = scene_.instances[i];
        const bool part = !first.name.empty() && other.name == first.name && other.transform == first.transform;
        if (i != *selection.instance && !part) continue;
        parts_.push_back(i);
        if (const Bounds more = bounds_of(scene_.meshes[other.mesh]); !more.empty())
            bounds.grow(more.lo), bounds.grow(more.hi);
    }
    middle_ = bounds.empty() ? glm::vec3(0) : bounds.center();
    held_ = middle_of_object();
}

glm::vec3 View::middle_of_object() const {
    return glm::vec3(scene_.instances[*selected_->instance].transform * glm::vec4(middle_, 1));
}

std::string View::select(const ViewCommand& command) {
    if (command.name == "deselect") hold_nothing();
    if (command.name == "edit") {
        const std::uint32_t material = number_in(command.name, "material", command.numbers[0], scene_.materials.size());
        material_ = material;
    }
    if (command.name != "object") return {};
    const std::uint32_t instance = number_in(command.name, "instance", command.numbers[0], scene_.instances.size());
    const std::uint32_t mesh = scene_.instances[instance].mesh;
    const std::vector<std::uint32_t>& materials = scene_.meshes[mesh].materials;
    hold_object({.mesh = mesh, .material = materials.empty() ? 0 : materials[0], .instance = instance});
    return {};
}

std::string View::pick(const ViewCommand& command) {
    const std::size_t pixel = pixel_of(command);
    const Aovs aovs = complete_renderer().aovs();
    hold_nothing();
    if (aovs.primitive[pixel] == CLARAY_MISS) return "no surface there";
    const glm::vec3 point = point_at(pixel, aovs.depth[pixel]);
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene_.meshes) triangles += mesh.triangles.size();
    if (aovs.primitive[pixel] >= triangles)
        return "primitive " + std::to_string(aovs.primitive[pixel] - triangles) +
               ", which cannot be changed, distance " + printed("%.6g", double(aovs.depth[pixel]));
    hold_object(selection_of(scene_, aovs.primitive[pixel], point));
    held_ = point;
    const Material& material = scene_.materials[selected_->material];
    const std::string& object = scene_.instances[*selected_->instance].name;
    return (object.empty() ? "" : "object " + name_of(object, 0) + ", ") + "mesh " +
           name_of(scene_.meshes[selected_->mesh].name, selected_->mesh) + ", triangle " +
           std::to_string(selected_->triangle) + ", material " + name_of(material.name, selected_->material) + " (" +
           effects_of_surface(scene_, *selected_) + "), distance " + printed("%.6g", double(aovs.depth[pixel])) + ", " +
           std::to_string(aovs.heat[pixel]) + " boxes and triangles tested";
}

std::string View::set_material(const ViewCommand& command) {
    if (!material_)
        refuse("material: nothing is selected", "select an object with pick X Y, or a material with edit N");
    const std::vector<float>& n = command.numbers;
    change(&Scene::materials, {.materials = true}, [&](std::vector<Material>& materials) {
        if (!set_value(materials[*material_], material_triples, material_numbers, command.word, {n[0], n[1], n[2]}))
            refuse("material: unknown value '" + command.word + "'",
                   "use " + names_of_values(material_triples, material_numbers));
    });
    return {};
}

std::size_t View::light_number(const std::string& command, double number) const {
    return number_in(command, "light", float(number), scene_.lights.size());
}

void View::shift_light(std::size_t light, const glm::vec3& way) {
    change(&Scene::lights, {.lights = true}, [&](std::vector<Light>& lights) { lights[light].position += way; });
}

std::string View::move_light(const ViewCommand& command) {
    const std::vector<float>& n = command.numbers;
    shift_light(light_number(command.name, double(n[0])), {n[1], n[2], n[3]});
    return {};
}

std::string View::set_light(const ViewCommand& command) {
    if (!light_) refuse("lamp: no light is selected", "select one with select NUMBER");
    const std::size_t light = light_number(command.name, double(*light_));
    const std::vector<float>& n = command.numbers;
    change(&Scene::lights, {.lights = true}, [&](std::vector<Light>& lights) {
        if (!set_value(lights[light], light_triples, light_numbers, command.word, {n[0], n[1], n[2]}))
            refuse("lamp: unknown value '" + command.word + "'",
                   "use " + names_of_values(light_triples, light_numbers));
    });
    return {};
}

void View::change_object(const std::string& command, const std::function<glm::mat4(const glm::mat4&)>& edit) {
    if (!selected_) refuse(command + ": nothing is selected", "select an object with pick X Y");
    change(&Scene::instances, {.instances = true}, [&](std::vector<MeshInstance>& instances) {
        for (const std::uint32_t part : parts_) {
            MeshInstance& instance = instances[part];
            instance.transform = edit(instance.transform);
            if (instance.transform_end) instance.transform_end = edit(*instance.transform_end);
        }
    });
}

void View::shift_object(const std::string& command, const glm::vec3& way) {
    change_object(command, [&](glm::mat4 transform) {
        transform[3] += glm::vec4(way, 0.f);
        return transform;
    });
    held_ += way;
}

/// `move`, `rotate` and `scale`.
std::string View::move_object(const ViewCommand& command) {
    const std::vector<float>& n = command.numbers;
    const glm::vec3 numbers{n[0], n[1], n[2]};
    if (command.name == "move") {
        shift_object(command.name, numbers);
        return {};
    }
    const glm::mat4 one(1);
    if (command.name == "scale") {
        if (glm::any(glm::equal(numbers, glm::vec3(0))))
            refuse("scale: a factor is 0", "use factors that keep the object's extent");
        const glm::mat4 by = glm::translate(glm::scale(glm::translate(one, middle_), numbers), -middle_);
        change_object(command.name, [&](const glm::mat4& transform) { return transform * by; });
    } else {
        if (!(glm::length(numbers) > 0)) refuse("rotate: the axis has no length", "use for example 0 1 0");
        const glm::vec3 middle = selected_ ? middle_of_object() : glm::vec3(0);
        const glm::mat4 turn = glm::rotate(glm::translate(one, middle), glm::radians(n[3]), glm::normalize(numbers));
        const glm::mat4 by = glm::translate(turn, -middle);
        change_object(command.name, [&](const glm::mat4& transform) { return by * transform; });
    }
    held_ = middle_of_object();
    return {};
}

std::string View::select_light(const ViewCommand& command) {
    const std::size_t next = light_ && *light_ + 1 < scene_.lights.size() ? *light_ + 1 : 0;
    const std::size_t number =
        light_number(command.name, command.name == "next" ? double(next) : double(command.numbers[0]));
    hold_nothing();
    light_ = number;
    const Light& light = scene_.lights[*light_];
    return printed("light %zu: %s", *light_, traits_of(light.kind)->name) +
           (traits_of(light.kind)->far ? std::string()
                                       : printed(" at %.6g %.6g %.6g", double(light.position.x),
                                                 double(light.position.y), double(light.position.z)));
}

std::string View::drag(const ViewCommand& command) {
    if (!selected_ && !light_)
        refuse("drag: nothing is selected", "select an object with pick X Y, or a light with select NUMBER");
    if (light_) (void)light_number(command.name, double(*light_));
    if (light_ && traits_of(scene_.lights[*light_].kind)->far)
        refuse("drag: the selected light has no place", "select a point or a spot");
    const glm::vec3 held = light_ ? scene_.lights[*light_].position : held_;
    const glm::vec3 way = along_image(*scene_.camera, held, command.numbers[0], command.numbers[1]);
    light_ ? shift_light(*light_, way) : shift_object(command.name, way);
    return {};
}

/// With the scene as it is now.
std::string View::explain(const ViewCommand&) {
    costs_.begin(device_, scene_, config_.render);
    return "measures the cost of each effect";
}

void View::take_costs() try {
    if (costs_.take()) ++revision_;
} catch (const Error& error) {
    if (error.kind() == ErrorKind::device) throw;
    ++revision_;  // what cannot be measured has no cost
}

}  // namespace claray::view
