// Scenes: loaded from files or put together from arrays.
#include "claray/scene.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "claray/effects.hpp"
#include "claray/io.hpp"
#include "host/io/default_light.hpp"
#include "host/primitives/scene_primitives.hpp"
#include "names.hpp"
#include "typed.hpp"
#include "vectors.hpp"

namespace claray::python {
namespace {

using Vertices = Input<float, nb::shape<-1, 3>>;
using Vectors4 = Input<float, nb::shape<-1, 4>>;
using Triangles = Input<std::uint32_t, nb::shape<-1, 3>>;
using Words = Input<std::uint32_t, nb::shape<-1>>;
using Uvs = Input<float, nb::shape<-1, 2>>;
using Transforms = Input<float, nb::shape<-1, 3, 4>>;

inline constexpr Named<Culling> cullings[] = {
    {Culling::by_file, "by-file"}, {Culling::back, "back"}, {Culling::none, "none"}};

/// A new member does not compile here: bind it below.
[[maybe_unused]] void name_all_members(Scene& scene, Mesh& mesh, MeshInstance& instance, LoadOptions& options) {
    [[maybe_unused]] auto& [scene_name, meshes, instances, primitives, scene_materials, textures, lights, sky,
                            environment, camera] = scene;
    [[maybe_unused]] auto& [name, positions, normals, uvs, uvs1, tangents, colors, triangles, materials, mask] = mesh;
    [[maybe_unused]] auto& [index, transform, transform_end, instance_name] = instance;
    [[maybe_unused]] auto& [time, animation, variant, chosen, file_scene, stroke_radius, images, live] = options;
}

template <class T, class Array>
std::vector<T> copy_of(const Array& array, std::size_t numbers_each) {
    const auto span = span_of<T>(array, numbers_each);
    return {span.begin(), span.end()};
}

/// The scene, warnings, and a line about the light and the view that were chosen, or None.
Tuple load(const std::string& path, const LoadOptions& options) {
    Warnings warnings;
    LoadedScene loaded;
    std::string chosen;
    {
        const nb::gil_scoped_release release;
        loaded = load_without_light(path, warnings, options);
        if (loaded.is_file) chosen = make_visible(loaded.scene).line();
    }
    return nb::make_tuple(std::move(loaded.scene), std::vector<std::string>(warnings.begin(), warnings.end()),
                          chosen.empty() ? std::nullopt : std::optional(chosen));
}

std::size_t add_mesh(Scene& scene, const std::string& name, const Vertices& vertices, const Triangles& triangles,
                     const Vertices& normals, const Uvs& uvs, const Uvs& uvs1, const Vectors4& tangents,
                     const Vectors4& colors, const Words& materials, std::uint32_t mask) {
    Mesh mesh;
    mesh.name = name;
    mesh.positions = copy_of<glm::vec3>(vertices, 3);
    mesh.triangles = copy_of<glm::uvec3>(triangles, 3);
    mesh.normals = copy_of<glm::vec3>(normals, 3);
    mesh.uvs = copy_of<glm::vec2>(uvs, 2);
    mesh.uvs1 = copy_of<glm::vec2>(uvs1, 2);
    mesh.tangents = copy_of<glm::vec4>(tangents, 4);
    mesh.colors = copy_of<glm::vec4>(colors, 4);
    mesh.materials = copy_of<std::uint32_t>(materials, 1);
    mesh.mask = mask;
    scene.meshes.push_back(std::move(mesh));
    return scene.meshes.size() - 1;
}

void move_vertices(Scene& scene, std::size_t mesh, const Vertices& vertices, const Vertices& normals) {
    scene.meshes.at(mesh).positions = copy_of<glm::vec3>(vertices, 3);
    scene.meshes.at(mesh).normals = copy_of<glm::vec3>(normals, 3);
}

std::size_t add_primitives(Scene& scene, const std::string& kind, const std::string& name, const Vectors4& points,
                           const Words& segments, const Words& materials, const Vertices& colors) {
    PrimitiveSet set;
    set.name = name;
    set.kind = kind_of("primitives", kind, primitive_kind_names);
    set.points = copy_of<glm::vec4>(points, 4);
    set.segments = copy_of<std::uint32_t>(segments, 1);
    set.materials = copy_of<std::uint32_t>(materials, 1);
    set.colors = copy_of<glm::vec3>(colors, 3);
    scene.primitives.push_back(std::move(set));
    return scene.primitives.size() - 1;
}

/// Arrays over the mesh's own memory.
Dict mesh_at(nb::handle self, std::size_t index) {
    const Scene& scene = nb::cast<const Scene&>(self);
    if (index >= scene.meshes.size()) throw nb::index_error("the scene has no such mesh");
    const Mesh& mesh = scene.meshes[index];
    nb::dict dict;
    dict["name"] = mesh.name;
    dict["vertices"] = view_of<float>(mesh.positions.data(), {mesh.positions.size(), 3}, self);
    dict["triangles"] = view_of<std::uint32_t>(mesh.triangles.data(), {mesh.triangles.size(), 3}, self);
    dict["normals"] = view_of<float>(mesh.normals.data(), {mesh.normals.size(), 3}, self);
    dict["uvs"] = view_of<float>(mesh.uvs.data(), {mesh.uvs.size(), 2}, self);
    dict["uvs1"] = view_of<float>(mesh.uvs1.data(), {mesh.uvs1.size(), 2}, self);
    dict["tangents"] = view_of<float>(mesh.tangents.data(), {mesh.tangents.size(), 4}, self);
    dict["colors"] = view_of<float>(mesh.colors.data(), {mesh.colors.size(), 4}, self);
    dict["materials"] = view_of<std::uint32_t>(mesh.materials.data(), {mesh.materials.size()}, self);
    dict["mask"] = mesh.mask;
    return dict;
}

Dict primitives_at(nb::handle self, std::size_t index) {
    const Scene& scene = nb::cast<const Scene&>(self);
    if (index >= scene.primitives.size()) throw nb::index_error("the scene has no such primitives");
    const PrimitiveSet& set = scene.primitives[index];
    nb::dict dict;
    dict["kind"] = name_in(primitive_kind_names, set.kind);
    dict["name"] = set.name;
    dict["points"] = view_of<float>(set.points.data(), {set.points.size(), 4}, self);
    dict["segments"] = view_of<std::uint32_t>(set.segments.data(), {set.segments.size()}, self);
    dict["materials"] = view_of<std::uint32_t>(set.materials.data(), {set.materials.size()}, self);
    dict["colors"] = view_of<float>(set.colors.data(), {set.colors.size(), 3}, self);
    return dict;
}

void append(std::vector<float>& rows, const glm::mat4& m) {
    for (int row = 0; row < 3; ++row) rows.insert(rows.end(), {m[0][row], m[1][row], m[2][row], m[3][row]});
}

glm::mat4 matrix_of(const float* rows) {
    glm::mat4 m(1.f);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) m[column][row] = rows[4 * row + column];
    return m;
}

/// The mesh of every instance, its transforms at time 0 and 1 (three rows of four numbers each), and its name.
Tuple placements_of(const Scene& scene) {
    std::vector<MeshInstance> instances = scene.instances;
    if (instances.empty())
        for (std::size_t i = 0; i < scene.meshes.size(); ++i) instances.push_back({.mesh = std::uint32_t(i)});
    std::vector<std::uint32_t> meshes;
    std::vector<float> begin, end;
    std::vector<std::string> names;
    for (const MeshInstance& instance : instances) {
        meshes.push_back(instance.mesh);
        append(begin, instance.transform);
        append(end, instance.transform_end.value_or(instance.transform));
        names.push_back(instance.name);
    }
    const std::size_t count = instances.size();
    return nb::make_tuple(array_of<std::uint32_t>(std::move(meshes), {count}),
                          array_of<float>(std::move(begin), {count, 3, 4}),
                          array_of<float>(std::move(end), {count, 3, 4}), names);
}

/// `ends` is empty if nothing moves, `names` if they have none.
void set_instances(Scene& scene, const Words& meshes, const Transforms& transforms, const Transforms& ends,
                   const std::vector<std::string>& names) {
    scene.instances.assign(meshes.size(), {});
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        MeshInstance& instance = scene.instances[i];
        instance.mesh = meshes.data()[i];
        instance.transform = matrix_of(transforms.data() + 12 * i);
        if (ends.size() != 0) instance.transform_end = matrix_of(ends.data() + 12 * i);
        if (!names.empty()) instance.name = names[i];
        if (instance.transform_end == instance.transform) instance.transform_end.reset();
    }
}

std::size_t add_instance(Scene& scene, std::uint32_t mesh, const Transforms& transforms, const std::string& name) {
    MeshInstance instance{.mesh = mesh, .transform = matrix_of(transforms.data())};
    if (transforms.shape(0) > 1) instance.transform_end = matrix_of(transforms.data() + 12);
    instance.name = name;
    scene.instances.push_back(std::move(instance));
    return scene.instances.size() - 1;
}

/// Elements of a list of the scene as copies: references would end with the next change of the list. `name`:
/// "material" or "light".
template <class Element>
void bind_elements(nb::class_<Scene>& scene, const std::string& name, std::vector<Element> Scene::*list) {
    const auto check = [list](const Scene& of, std::size_t index) {
        if (index >= (of.*list).size()) throw nb::index_error("the scene has no such element any more");
    };
    scene.def((name + "_count").c_str(), [list](const Scene& of) { return (of.*list).size(); })
        .def((name + "_at").c_str(),
             [=](const Scene& of, std::size_t index) {
                 check(of, index);
                 return Element((of.*list)[index]);
             })
        .def(("set_" + name).c_str(),
             [=](Scene& of, std::size_t index, const Element& element) {
                 check(of, index);
                 (of.*list)[index] = element;
             })
        .def(("set_" + name + "s").c_str(),
             [list](Scene& of, std::vector<Element> elements) { of.*list = std::move(elements); });
}

void bind_load_options(nb::module_& module) {
    const auto optional = [](const char* name) { return nb::for_setter(nb::arg(name).none()); };
    nb::class_<LoadOptions>(module, "NativeLoadOptions")
        .def(nb::init<>())
        .def_rw("time", &LoadOptions::time, optional("time"))
        .def_rw("animation", &LoadOptions::animation)
        .def_rw("variant", &LoadOptions::variant)
        .def_rw("camera", &LoadOptions::camera)
        .def_rw("scene", &LoadOptions::scene)
        .def_rw("stroke_radius", &LoadOptions::stroke_radius, optional("stroke_radius"))
        .def_rw("images", &LoadOptions::images)
        .def_rw("live", &LoadOptions::live);
    module.def("load", &load);
    module.def("animation_seconds", &animation_seconds);
}

void bind_parts(nb::class_<Scene>& scene) {
    bind_elements(scene, "material", &Scene::materials);
    bind_elements(scene, "light", &Scene::lights);
    bind_elements(scene, "texture", &Scene::textures);
    scene.def("add_texture", [](Scene& s, const Texture& texture) { s.textures.push_back(texture); });
    scene.def("add_mesh", &add_mesh)
        .def("move_vertices", &move_vertices)
        .def("mesh_count", [](const Scene& s) { return s.meshes.size(); })
        .def("mesh_at", [](nb::handle_t<Scene> self, std::size_t index) { return mesh_at(self, index); })
        .def("add_primitives", &add_primitives)
        .def("primitive_count", [](const Scene& s) { return primitive_count(s); })
        .def("primitives_count", [](const Scene& s) { return s.primitives.size(); })
        .def("primitives_at", [](nb::handle_t<Scene> self, std::size_t index) { return primitives_at(self, index); })
        .def("placements", &placements_of)
        .def("has_instances", [](const Scene& s) { return !s.instances.empty(); })
        .def("set_instances", &set_instances)
        .def("add_instance", &add_instance);
}

}  // namespace

void bind_scene(nb::module_& module) {
    bind_load_options(module);
    module.def("builtin_scene_names", [] {
        const auto names = builtin_scene_names();
        return std::vector<std::string>(names.begin(), names.end());
    });
    nb::class_<Scene> scene(module, "NativeScene");
    bind_parts(scene);
    scene.def(nb::init<>())
        .def_rw("name", &Scene::name)
        .def_prop_rw(
            "sky", [](const Scene& s) { return std::make_pair(s.sky.horizon, s.sky.zenith); },
            [](Scene& s, const std::pair<glm::vec3, glm::vec3>& colors) {
                s.sky.horizon = colors.first, s.sky.zenith = colors.second;
                s.environment = {};
            })
        .def_prop_rw(
            "fog", [](const Scene& s) { return std::make_tuple(s.sky.fog_density, s.sky.fog_color, s.sky.fog_depth); },
            [](Scene& s, const std::tuple<float, glm::vec3, float>& fog) {
                std::tie(s.sky.fog_density, s.sky.fog_color, s.sky.fog_depth) = fog;
            })
        .def_prop_rw(
            "environment", [](const Scene& s) { return Environment(s.environment); },
            [](Scene& s, const Environment& environment) { s.environment = environment; })
        .def_prop_rw(
            "camera", [](const Scene& s) { return camera_of(s); },
            [](Scene& s, const Camera& camera) { s.camera = camera; })
        .def("has_camera", [](const Scene& s) { return s.camera.has_value(); })
        .def("automatic_camera",
             [](const Scene& s, float vertical_fov, float aspect) { return automatic_camera(s, vertical_fov, aspect); })
        .def("warning_of_lamps", [](const Scene& s) { return warning_of_lamps(s); })
        .def("triangle_count", [](const Scene& s) { return triangle_count(s); })
        .def("bounds",
             [](const Scene& s) {
                 const Bounds bounds = bounds_of(s);
                 return std::make_pair(bounds.lo, bounds.hi);
             })
        .def("validate", [](const Scene& s) { validate(s); })
        .def("set_culling",
             [](Scene& s, const std::string& name) { set_culling(s, kind_of("culling", name, cullings)); })
        .def("flip_fronts", [](Scene& s) { flip_fronts(s); })
        .def("without_effects",
             [](const Scene& s, const std::string& names) { return without_effects(s, parse_effects(names)); })
        .def("copy", [](const Scene& s) { return Scene(s); });
}

}  // namespace claray::python
