// Scenes: loaded from files or put together from arrays.
#include "claray/scene.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "claray/io.hpp"
#include "host/io/default_light.hpp"
#include "host/primitives/scene_primitives.hpp"
#include "vectors.hpp"

namespace claray::python {
namespace {

using Vertices = Input<float, nb::shape<-1, 3>>;
using Triangles = Input<std::uint32_t, nb::shape<-1, 3>>;
using Words = Input<std::uint32_t, nb::shape<-1>>;
using Uvs = Input<float, nb::shape<-1, 2>>;

template <class T, class Array>
std::vector<T> copy_of(const Array& array, std::size_t numbers_each) {
    const auto span = span_of<T>(array, numbers_each);
    return {span.begin(), span.end()};
}

/// The scene, warnings, and a line about the light and the view that were chosen, or None.
nb::tuple load(const std::string& path, const LoadOptions& options) {
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
                     const Vertices& normals, const Uvs& uvs, std::uint32_t material, std::uint32_t mask) {
    Mesh mesh;
    mesh.name = name;
    mesh.positions = copy_of<glm::vec3>(vertices, 3);
    mesh.triangles = copy_of<glm::uvec3>(triangles, 3);
    mesh.normals = copy_of<glm::vec3>(normals, 3);
    mesh.uvs = copy_of<glm::vec2>(uvs, 2);
    if (material != 0) mesh.materials.assign(mesh.triangles.size(), material);
    mesh.mask = mask;
    scene.meshes.push_back(std::move(mesh));
    return scene.meshes.size() - 1;
}

template <class Kind, class Rows>
Kind kind_of(const char* what, const std::string& name, const Rows& rows) {
    std::string names;
    for (const auto& row : rows) {
        if (name == row.name) return row.kind;
        names += std::string(names.empty() ? "" : ", ") + row.name;
    }
    throw Error(ErrorKind::usage, std::string(what) + ": unknown kind '" + name + "'", "use one of " + names);
}

std::size_t add_primitives(Scene& scene, const std::string& kind, const std::string& name,
                           const Input<float, nb::shape<-1, 4>>& points, const Words& segments, const Words& materials,
                           const Vertices& colors) {
    PrimitiveSet set;
    set.name = name;
    set.kind = kind_of<PrimitiveSet::Kind>("primitives", kind, primitive_kind_names);
    set.points = copy_of<glm::vec4>(points, 4);
    set.segments = copy_of<std::uint32_t>(segments, 1);
    set.materials = copy_of<std::uint32_t>(materials, 1);
    set.colors = copy_of<glm::vec3>(colors, 3);
    scene.primitives.push_back(std::move(set));
    return scene.primitives.size() - 1;
}

/// Arrays over the mesh's own memory.
nb::dict mesh_at(nb::handle self, std::size_t index) {
    const Scene& scene = nb::cast<const Scene&>(self);
    if (index >= scene.meshes.size()) throw nb::index_error("the scene has no such mesh");
    const Mesh& mesh = scene.meshes[index];
    nb::dict dict;
    dict["name"] = mesh.name;
    dict["vertices"] = view_of<float>(mesh.positions.data(), {mesh.positions.size(), 3}, self);
    dict["triangles"] = view_of<std::uint32_t>(mesh.triangles.data(), {mesh.triangles.size(), 3}, self);
    dict["normals"] = view_of<float>(mesh.normals.data(), {mesh.normals.size(), 3}, self);
    dict["uvs"] = view_of<float>(mesh.uvs.data(), {mesh.uvs.size(), 2}, self);
    dict["materials"] = view_of<std::uint32_t>(mesh.materials.data(), {mesh.materials.size()}, self);
    return dict;
}

/// The mesh of every instance, and its transforms at time 0 and 1: three rows of four numbers each.
nb::tuple placements_of(const Scene& scene) {
    std::vector<MeshInstance> instances = scene.instances;
    if (instances.empty())
        for (std::size_t i = 0; i < scene.meshes.size(); ++i) instances.push_back({.mesh = std::uint32_t(i)});
    std::vector<std::uint32_t> meshes;
    std::vector<float> begin, end;
    const auto append = [](std::vector<float>& rows, const glm::mat4& m) {
        for (int row = 0; row < 3; ++row) rows.insert(rows.end(), {m[0][row], m[1][row], m[2][row], m[3][row]});
    };
    for (const MeshInstance& instance : instances) {
        meshes.push_back(instance.mesh);
        append(begin, instance.transform);
        append(end, instance.transform_end.value_or(instance.transform));
    }
    return nb::make_tuple(meshes, begin, end);
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

void bind_material(nb::module_& module) {
    nb::class_<Material> material(module, "NativeMaterial");
    material.def(nb::init<>())
        .def("copy", [](const Material& from) { return Material(from); })
        .def_prop_rw(
            "kind", [](const Material& m) { return row_of(m.kind) ? row_of(m.kind)->name : "custom"; },
            [](Material& m, const std::string& name) {
                m.kind = kind_of<MaterialKind>("Material", name, material_kinds);
            })
        .def_rw("name", &Material::name)
        .def_rw("albedo", &Material::albedo)
        .def_rw("emission", &Material::emission)
        .def_rw("roughness", &Material::roughness)
        .def_rw("ior", &Material::ior)
        .def_rw("metallic", &Material::metallic)
        .def_rw("transmission", &Material::transmission)
        .def_rw("thin_walled", &Material::thin_walled)
        .def_rw("clearcoat", &Material::clearcoat)
        .def_rw("clearcoat_roughness", &Material::clearcoat_roughness)
        .def_rw("specular", &Material::specular)
        .def_rw("sheen", &Material::sheen)
        .def_rw("sheen_roughness", &Material::sheen_roughness)
        .def_rw("anisotropy", &Material::anisotropy)
        .def_rw("opacity", &Material::opacity)
        .def_rw("cull_back", &Material::cull_back);
#define CLARAY_ROW(name, text, standard, check) material.def_rw(#name, &Material::name);
    CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
}

void bind_light(nb::module_& module) {
    nb::class_<Light>(module, "NativeLight")
        .def(nb::init<>())
        .def("copy", [](const Light& from) { return Light(from); })
        .def_prop_rw(
            "kind", [](const Light& l) { return traits_of(l.kind) ? traits_of(l.kind)->name : "unknown"; },
            [](Light& l, const std::string& name) { l.kind = kind_of<LightKind>("Light", name, light_kinds); })
        .def_rw("name", &Light::name)
        .def_rw("position", &Light::position)
        .def_rw("direction", &Light::direction)
        .def_rw("intensity", &Light::intensity)
        .def_rw("inner_angle", &Light::inner_angle)
        .def_rw("outer_angle", &Light::outer_angle)
        .def_rw("range", &Light::range);
}

void bind_camera(nb::module_& module) {
    nb::class_<Camera>(module, "NativeCamera")
        .def(nb::init<>())
        .def("copy", [](const Camera& from) { return Camera(from); })
        .def_rw("position", &Camera::position)
        .def_rw("target", &Camera::target)
        .def_rw("up", &Camera::up)
        .def_rw("vertical_fov", &Camera::vertical_fov)
        .def_rw("aperture_radius", &Camera::aperture_radius)
        .def_rw("focus_distance", &Camera::focus_distance)
        .def_prop_rw(
            "projection", [](const Camera& c) { return traits_of(c.projection)->name; },
            [](Camera& c, const std::string& name) { c.projection = kind_of<Projection>("Camera", name, projections); })
        .def_prop_rw(
            "orthographic_height", [](const Camera& c) { return c.orthographic_height; },
            [](Camera& c, float height) { c.projection = Projection::orthographic, c.orthographic_height = height; });
}

void bind_load_options(nb::module_& module) {
    nb::class_<LoadOptions>(module, "NativeLoadOptions")
        .def(nb::init<>())
        .def_rw("time", &LoadOptions::time)
        .def_rw("animation", &LoadOptions::animation)
        .def_rw("variant", &LoadOptions::variant)
        .def_rw("camera", &LoadOptions::camera)
        .def_rw("scene", &LoadOptions::scene)
        .def_rw("images", &LoadOptions::images);
}

}  // namespace

void bind_scene(nb::module_& module) {
    bind_material(module);
    bind_light(module);
    bind_camera(module);
    bind_load_options(module);
    module.def("load", &load);
    module.def("builtin_scene_names", [] {
        const auto names = builtin_scene_names();
        return std::vector<std::string>(names.begin(), names.end());
    });
    nb::class_<Scene> scene(module, "NativeScene");
    bind_elements(scene, "material", &Scene::materials);
    bind_elements(scene, "light", &Scene::lights);
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
            "camera", [](const Scene& s) { return camera_of(s); },
            [](Scene& s, const Camera& camera) { s.camera = camera; })
        .def("add_mesh", &add_mesh)
        .def("add_primitives", &add_primitives)
        .def("primitive_count", [](const Scene& s) { return primitive_count(s); })
        .def("warning_of_lamps", [](const Scene& s) { return warning_of_lamps(s); })
        .def("placements", &placements_of)
        .def("mesh_count", [](const Scene& s) { return s.meshes.size(); })
        .def("mesh_at", [](nb::handle_t<Scene> self, std::size_t index) { return mesh_at(self, index); })
        .def("triangle_count", [](const Scene& s) { return triangle_count(s); })
        .def("bounds",
             [](const Scene& s) {
                 const Bounds bounds = bounds_of(s);
                 return std::make_pair(bounds.lo, bounds.hi);
             })
        .def("copy", [](const Scene& s) { return Scene(s); });
}

}  // namespace claray::python
