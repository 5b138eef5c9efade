// Acceleration structures over arrays and scenes.
#include "claray/bvh.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "claray/scene.hpp"
#include "host/scene/placement.hpp"
#include "structures.hpp"

namespace claray::python {
namespace {

using Vertices = Input<float, nb::shape<-1, 3>>;
using Triangles = Input<std::uint32_t, nb::shape<-1, 3>>;
using Words = Input<std::uint32_t, nb::shape<-1>>;

/// `learns`: as in claray_bvh_config.
Bvh::Config full_config_of(const std::string& builder, double split_budget, const std::string& layout, int learns) {
    Bvh::Config config = config_of(builder);
    config.split_budget = split_budget;
    if (learns != 0) config.learns = learns > 0;
    if (layout == "binary")
        config.layout = Layout::binary;
    else if (layout == "wide")
        config.layout = Layout::wide;
    else if (layout != "automatic")
        throw Error(ErrorKind::usage, "layout: unknown name '" + layout + "'", "use automatic, binary or wide");
    return config;
}

PyBvh build(const PyDevice& device, const Vertices& vertices, const Triangles& triangles, const Words& geometries,
            const Words& masks, const std::string& builder, double split_budget, const std::string& layout,
            int learns) {
    const Bvh::Config config = full_config_of(builder, split_budget, layout, learns);
    return without_gil(device, [&] {
        const auto words = [&](const auto& array) {
            return array.size() ? Buffer<std::uint32_t>(device.device, span_of<std::uint32_t>(array))
                                : Buffer<std::uint32_t>();
        };
        const TriangleBuffers buffers{Buffer<float>(device.device, span_of<float>(vertices)), words(triangles),
                                      words(geometries), words(masks)};
        return PyBvh{device, Bvh::build(device.device, buffers, config)};
    });
}

/// Meshes in world space, in the order of the instances.
std::vector<Mesh> placed_meshes(const Scene& scene) {
    if (scene.instances.empty()) return scene.meshes;
    std::vector<Mesh> meshes;
    for (const MeshInstance& instance : scene.instances)
        meshes.push_back(transformed(scene.meshes.at(instance.mesh), instance.transform));
    return meshes;
}

PyBvh build_of_mesh(const PyDevice& device, const Scene& scene, std::size_t mesh, const std::string& builder) {
    const Bvh::Config config = config_of(builder);
    return without_gil(device, [&] {
        return PyBvh{device, Bvh::build(device.device, std::span(&scene.meshes.at(mesh), 1), config)};
    });
}

PyBvh build_of_scene(const PyDevice& device, const Scene& scene, const std::string& builder, double split_budget,
                     const std::string& layout, int learns) {
    const Bvh::Config config = full_config_of(builder, split_budget, layout, learns);
    return without_gil(device, [&] { return PyBvh{device, Bvh::build(device.device, placed_meshes(scene), config)}; });
}

void move_vertices(PyBvh& self, const Vertices& vertices, bool rebuild) {
    without_gil(self.device, [&] {
        Buffer<float> positions = self.bvh.triangles().positions;
        if (vertices.size() != positions.size())
            throw Error(ErrorKind::usage, "vertices: " + std::to_string(vertices.size() / 3) +
                                              " rows, and the structure has " + std::to_string(positions.size() / 3) +
                                              " vertices");
        positions.write(span_of<float>(vertices));
        rebuild ? self.bvh.rebuild() : self.bvh.refit();
    });
}

Dict statistics(const PyBvh& self) {
    return tree_statistics(without_gil(self.device, [&] { return self.bvh.statistics(); }));
}

}  // namespace

Dict tree_statistics(const BvhStatistics& s) {
    nb::dict dict;
    dict["triangles"] = s.triangles;
    dict["culled"] = s.culled;
    dict["references"] = s.references;
    dict["height"] = s.height;
    dict["sah_cost"] = s.sah_cost;
    dict["bytes"] = s.bytes;
    return dict;
}

Bvh::Config config_of(const std::string& builder) {
    if (builder == automatic_traits.name) return {};
    const auto* row =
        std::find_if(std::begin(builders), std::end(builders), [&](auto& b) { return builder == b.name; });
    if (row == std::end(builders)) {
        std::string names = automatic_traits.name;
        for (const BuilderTraits& b : builders) names += std::string(", ") + b.name;
        throw Error(ErrorKind::usage, "builder: unknown name '" + builder + "'", "use one of " + names);
    }
    Bvh::Config config;
    config.builder = row->builder;
    return config;
}

void bind_bvh(nb::module_& module) {
    nb::class_<PyBvh>(module, "NativeBvh")
        .def_static("build", &build)
        .def_static("build_of_scene", &build_of_scene)
        .def_static("build_of_mesh", &build_of_mesh)
        .def_static(
            "load",
            [](const PyDevice& device, const std::filesystem::path& path) {
                return without_gil(device, [&] { return PyBvh{device, Bvh::load(device.device, path)}; });
            },
            nb::sig("def load(device: NativeDevice, path: str | os.PathLike[str], /) -> NativeBvh"))
        .def(
            "save",
            [](const PyBvh& self, const std::filesystem::path& path) {
                without_gil(self.device, [&] { self.bvh.save(path); });
            },
            nb::sig("def save(self, path: str | os.PathLike[str], /) -> None"))
        .def("move_vertices", &move_vertices)
        .def("cost_growth",
             [](const PyBvh& self) { return without_gil(self.device, [&] { return self.bvh.cost_growth(); }); })
        .def("is_closed",
             [](const PyBvh& self) { return without_gil(self.device, [&] { return is_closed(self.bvh); }); })
        .def("is_valid",
             [](const PyBvh& self) { return without_gil(self.device, [&] { return self.bvh.validate().ok(); }); })
        .def("hash", [](const PyBvh& self) { return without_gil(self.device, [&] { return self.bvh.hash(); }); })
        .def("statistics", &statistics)
        .def("is_replaced",
             [](const PyBvh& self) { return without_gil(self.device, [&] { return is_replaced(self.bvh); }); })
        .def("triangle_count", [](const PyBvh& self) { return self.bvh.triangle_count(); })
        .def("device", [](const PyBvh& self) { return self.device; });
}

}  // namespace claray::python
