// Shapes of Mitsuba 3.
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "claray/error.hpp"
#include "host/io/mitsuba/mitsuba_scene.hpp"
#include "host/io/mitsuba/serialized.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/words.hpp"
#include "host/io/world/shapes.hpp"

namespace claray {
namespace {

constexpr double whole_turn = 2 * std::numbers::pi;

/// Moves the unit tube to the one between two points.
glm::dmat4 between(const glm::dvec3& from, const glm::dvec3& to, double radius) {
    const glm::dvec3 axis = to - from;
    const double length = glm::length(axis);
    const glm::dvec3 z = length > 0 ? axis / length : glm::dvec3(0, 0, 1);
    const glm::dvec3 aside = std::abs(z.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(aside, z));
    glm::dmat4 m(1.0);
    m[0] = glm::dvec4(radius * x, 0), m[1] = glm::dvec4(radius * glm::cross(z, x), 0);
    m[2] = glm::dvec4(axis, 0), m[3] = glm::dvec4(from, 1);
    return m;
}

/// Mitsuba's v is a row of the image, as in claray; readers of files turned it over.
void turn_coordinates(Mesh& mesh) {
    for (glm::vec2& uv : mesh.uvs) uv.y = 1.f - uv.y;
}

}  // namespace

void MitsubaScene::read() {
    const MitsubaNode* sensor = materials_.child(scene_, "sensor");
    if (sensor) set_camera(*sensor);
    for (const MitsubaNode& each : scene_.children) {
        const MitsubaNode* object = materials_.resolved(each);
        if (!object) continue;
        if (object->tag == "shape") add_shape(*object);
        if (object->tag == "emitter") add_emitter(*object);
        if (object->tag == "medium") world_.warn("media, such as fog and smoke, are left out");
    }
}

std::size_t MitsubaScene::look_of(const MitsubaNode& shape) {
    for (const char* side : {"interior", "exterior"})
        if (shape.property(side)) world_.warn("media, such as fog and smoke, are left out");
    return materials_.look_of(materials_.child(shape, "bsdf"));
}

std::optional<Glow> MitsubaScene::glow(const MitsubaNode& shape) {
    const MitsubaNode* emitter = materials_.child(shape, "emitter");
    if (!emitter) return {};
    if (emitter->type != "area")
        world_.warn("emitters " + claray::quoted(emitter->type) + " of shapes are shown as 'area'");
    return Glow{materials_.light(*emitter, "radiance", 1.f), false};
}

std::optional<Mesh> MitsubaScene::mesh_of_file(const MitsubaNode& shape) {
    const std::string file = shape.text("filename");
    std::optional<Mesh> mesh;
    if (shape.type == "serialized") {
        const auto number = std::size_t(std::max(0.0, shape.number("shape_index", 0)));
        mesh = world_.mesh_file(file,
                                [number](const std::filesystem::path& path) { return load_serialized(path, number); });
        return mesh;
    }
    mesh = world_.mesh_file(file, shape.type == "obj" ? load_obj_without_light : load_ply_without_light);
    if (mesh && shape.flag("flip_tex_coords", shape.type == "obj") == false) turn_coordinates(*mesh);
    return mesh;
}

/// Without normals a mesh is smooth, unless "face_normals" says otherwise.
void MitsubaScene::add_surface(Mesh mesh, const MitsubaNode& shape, bool has_normals, const glm::dmat4& local) {
    const glm::dmat4 of_shape = shape.transform("to_world"), to_world = mirror_ * of_shape * local;
    if (shape.flag("face_normals", false)) mesh.normals.clear(), has_normals = false;
    face_normals(mesh);
    // The order of vertices in the world decides which side is the front of what has no normals of its own.
    if (!has_normals && glm::determinant(glm::dmat3(of_shape)) < 0) turn_round(mesh);
    if (!has_normals && !shape.flag("face_normals", false)) add_smooth_normals(mesh);
    if (shape.flag("flip_normals", false)) turn_round(mesh);
    mesh.name = shape.id.empty() ? mesh.name : shape.id;
    world_.add(std::move(mesh), to_world, look_of(shape), glow(shape));
}

void MitsubaScene::add_ball(const MitsubaNode& shape) {
    const glm::dvec3 center = shape.point("center", glm::dvec3(0));
    const glm::dmat4 local = glm::scale(glm::translate(glm::dmat4(1.0), center), glm::dvec3(shape.number("radius", 1)));
    world_.add_ball(mirror_ * shape.transform("to_world") * local, look_of(shape), glow(shape),
                    shape.flag("flip_normals", false));
}

void MitsubaScene::add_shape(const MitsubaNode& shape) {
    const std::string& type = shape.type;
    if (type == "shapegroup") return;  // placed by instances
    if (type == "instance") return add_instance(shape);
    if (type == "sphere") return add_ball(shape);
    if (type == "merge") {
        for (const MitsubaNode& each : shape.children)
            if (each.tag == "shape") add_shape(each);
        return;
    }
    if (type == "obj" || type == "ply" || type == "serialized") {
        std::optional<Mesh> mesh = mesh_of_file(shape);
        const bool has_normals = mesh && !mesh->normals.empty();
        if (mesh) add_surface(*std::move(mesh), shape, has_normals, glm::dmat4(1.0));
        return;
    }
    if (type == "rectangle") return add_surface(square(), shape, true, glm::dmat4(1.0));
    if (type == "cube") return add_surface(cube(), shape, true, glm::dmat4(1.0));
    if (type == "disk") {
        Mesh disc = disc_part(0, whole_turn);
        for (glm::vec2& uv : disc.uvs) uv = {1.f - uv.y, uv.x};  // Mitsuba's u is the radius
        return add_surface(std::move(disc), shape, true, glm::dmat4(1.0));
    }
    if (type == "cylinder")
        return add_surface(
            tube_part(whole_turn), shape, true,
            between(shape.point("p0", glm::dvec3(0)), shape.point("p1", {0, 0, 1}), shape.number("radius", 1)));
    world_.warn("shapes " + claray::quoted(type) + " are left out");
}

void MitsubaScene::add_group(const MitsubaNode& group) {
    const auto [found, is_new] = names_.try_emplace(&group, "group " + std::to_string(groups_));
    if (!is_new) return;
    ++groups_;
    world_.set_group(found->second);
    for (const MitsubaNode& each : group.children) {
        const MitsubaNode* object = materials_.resolved(each);
        if (!object || object->tag != "shape") continue;
        if (object->type == "instance" || object->type == "shapegroup")
            object->refuse("a group contains another one", "place shapes in groups only");
        add_shape(*object);
    }
    world_.set_group({});
}

void MitsubaScene::add_instance(const MitsubaNode& instance) {
    if (world_.in_group()) instance.refuse("an instance is within a group", "place it outside");
    const MitsubaNode* group = materials_.child(instance, "shape");
    if (!group || group->type != "shapegroup") return world_.warn("an instance without a group of shapes is left out");
    add_group(*group);
    world_.place(names_[group], mirror_ * instance.transform("to_world") * glm::inverse(mirror_));
}

}  // namespace claray
