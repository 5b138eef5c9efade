// The path tracer, on one device or on several.
#include "claray/renderer.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <exception>
#include <limits>

#include "arrays.hpp"
#include "callback.hpp"
#include "claray/cryptomatte.hpp"
#include "claray/scale/render_group.hpp"
#include "render_config.hpp"
#include "structures.hpp"
#include "typed.hpp"

namespace claray::python {
namespace {

struct PyRenderer {
    std::vector<PyDevice> devices;
    unsigned width = 0, height = 0;
    std::optional<Kept<Renderer>> alone;
    // Of several devices.
    std::shared_ptr<const Scene> scene;  // which the group reads
    std::shared_ptr<std::vector<std::string>> failures = std::make_shared<std::vector<std::string>>();
    Kept<std::shared_ptr<RenderGroup>> group;

    [[nodiscard]] Renderer& renderer() { return alone ? *alone : group->renderer(); }
    /// For what RenderGroup does not have.
    [[nodiscard]] Renderer& renderer_alone(const char* what) {
        if (alone) return *alone;
        throw Error(ErrorKind::usage, std::string(what) + ": a render of several devices cannot do this",
                    "make it with one device");
    }
};

PyRenderer make_renderer(const std::vector<PyDevice>& devices, const Scene& scene, const RenderConfig& config) {
    return without_gil(devices, [&] {
        PyRenderer self;
        self.devices = devices, self.width = config.image_width(), self.height = config.image_height();
        if (devices.size() == 1) {
            self.alone.emplace(Renderer(devices[0].device, scene, config));
            return self;
        }
        std::vector<Device> all;
        for (const PyDevice& device : devices) all.push_back(device.device);
        self.scene = std::make_shared<const Scene>(scene);
        self.group = std::make_shared<RenderGroup>(
            all, *self.scene, config,
            [failures = self.failures](const std::string& line) { failures->push_back(line); });
        return self;
    });
}

Dict as_dict(const RenderProgress& p) {
    const auto& [spp, spp_target, seconds, noise, error, error_bound, error_of_fireflies, error_spp, cut_off,
                 own_kernels, waits_for_kernels, dropped_samples, culled] = p;
    nb::dict dict;
    dict["spp"] = spp;
    dict["spp_target"] = spp_target;
    dict["seconds"] = seconds;
    dict["noise"] = noise;
    dict["error"] = error;
    dict["error_bound"] = error_bound;
    dict["error_of_fireflies"] = error_of_fireflies;
    dict["error_is_sure"] = p.error_is_sure();
    dict["error_spp"] = error_spp;
    dict["cut_off"] = cut_off;
    dict["own_kernels"] = own_kernels;
    dict["waits_for_kernels"] = waits_for_kernels;
    dict["dropped_samples"] = dropped_samples;
    dict["culled"] = culled;
    return dict;
}

/// `seconds`: as of Renderer::render_for; none: as of Renderer::render.
Dict render(PyRenderer& self, const nb::object& progress, const std::optional<double>& seconds) {
    Callback callback(progress);
    const auto report = [&](const RenderProgress& p) { return callback([&] { return as_dict(p); }); };
    const RenderProgress reached = without_gil(self.devices, [&] {
        if (seconds) return self.renderer_alone("seconds").render_for(*seconds, report);
        return self.alone ? self.alone->render(report) : self.group->render(report);
    });
    callback.rethrow();
    return as_dict(reached);
}

nb::object pixels_of(PyRenderer& self, std::vector<glm::vec3>&& pixels) {
    return array_of<float>(std::move(pixels), {self.height, self.width, 3});
}

void image(PyRenderer& self, const Output<float, nb::shape<-1, -1, 3>>& out) {
    const std::span<glm::vec3> pixels(reinterpret_cast<glm::vec3*>(out.data()), out.size() / 3);
    without_gil(self.devices, [&] { self.renderer().image(pixels, unsigned(out.shape(1)), unsigned(out.shape(0))); });
}

nb::object denoised(PyRenderer& self, const std::string& denoiser) {
    const DenoiserKind kind = kind_of("denoise", denoiser, denoisers);
    return pixels_of(self, without_gil(self.devices, [&] { return self.renderer().denoised(kind); }));
}

/// Red, green and blue of each pixel.
nb::object picture(PyRenderer& self, float exposure, const std::string& tone_map, unsigned width, unsigned height,
                   bool denoise) {
    const PictureConfig config{exposure, kind_of("tone_map", tone_map, tone_maps), width, height};
    std::vector<std::uint8_t> colors = without_gil(self.devices, [&] {
        Renderer& renderer = self.renderer();
        const auto bytes = denoise ? renderer.denoised_picture(config) : renderer.picture(config);
        std::vector<std::uint8_t> kept;
        kept.reserve(bytes.size() / 4 * 3);
        for (std::size_t i = 0; i < bytes.size(); ++i)
            if (i % 4 != 3) kept.push_back(bytes[i]);
        return kept;
    });
    return array_of<std::uint8_t>(std::move(colors), {height ? height : self.height, width ? width : self.width, 3});
}

Dict aovs(PyRenderer& self) {
    Aovs all = without_gil(self.devices, [&] { return self.renderer().aovs(); });
    nb::dict dict;
    for_each_aov(all, [&](const AovRow& row, auto& pixels) {
        using Pixel = typename std::remove_reference_t<decltype(pixels)>::value_type;
        using Word = std::conditional_t<std::is_same_v<Pixel, std::uint32_t>, std::uint32_t, float>;
        std::vector<std::size_t> shape = {self.height, self.width};
        if (sizeof(Pixel) != sizeof(Word)) shape.push_back(sizeof(Pixel) / sizeof(Word));
        dict[row.name] = array_of<Word>(std::move(pixels), shape);
    });
    return dict;
}

Dict light_layers(PyRenderer& self) {
    std::vector<LightLayer> layers = without_gil(self.devices, [&] { return self.renderer().light_layers(); });
    nb::dict dict;
    for (LightLayer& layer : layers) dict[nb::str(layer.name.c_str())] = pixels_of(self, std::move(layer.pixels));
    return dict;
}

/// Name, parts (height, width, ranks, 2), names and hashes.
Tuple cryptomatte_of(PyRenderer& self, const std::string& kind, unsigned samples) {
    const MatteKind of = kind_of("kind", kind, matte_kinds);
    Cryptomatte matte = without_gil(self.devices, [&] { return cryptomatte(self.renderer(), of, samples); });
    nb::dict manifest;
    for (const auto& [name, hash] : matte.manifest) manifest[nb::str(name.c_str())] = hash;
    return nb::make_tuple(matte.name,
                          array_of<float>(std::move(matte.parts), {self.height, self.width, matte.ranks, 2}), manifest);
}

/// Words of each pixel, normals, positions, and the matrix by rows.
Tuple gbuffer(PyRenderer& self, const std::string& packing) {
    const NormalPacking kind = kind_of("normals", packing, normal_packings);
    std::vector<glm::vec3> normals, positions;
    GBuffer buffer = without_gil(self.devices, [&] {
        GBuffer made = self.renderer().gbuffer(kind);
        for (std::size_t i = 0; i < made.pixels.size(); ++i) {
            normals.push_back(normal_of(made, i));
            positions.push_back(position_of(made, i));
        }
        return made;
    });
    std::vector<double> rows;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) rows.push_back(buffer.world_from_image[column][row]);
    return nb::make_tuple(array_of<std::uint32_t>(std::move(buffer.pixels), {self.height, self.width, 3}),
                          pixels_of(self, std::move(normals)), pixels_of(self, std::move(positions)),
                          array_of<double>(std::move(rows), {4, 4}));
}

/// A map of one number per pixel.
template <class Make>
nb::object map_of(PyRenderer& self, const Make& make) {
    std::vector<float> values = without_gil(self.devices, [&] { return make(self.renderer()); });
    return array_of<float>(std::move(values), {self.height, self.width});
}

double error_of(PyRenderer& self, const Input<float, nb::shape<-1, -1, 3>>& pixels) {
    return without_gil(self.devices, [&] { return self.renderer().error_of(span_of<glm::vec3>(pixels, 3)); });
}

void update(PyRenderer& self, const Scene& scene, bool camera, bool lights, bool materials, bool sky, bool instances,
            bool vertices) {
    const SceneChanges changes{camera, lights, materials, sky, instances, vertices};
    without_gil(self.devices, [&] { self.renderer_alone("update").update(scene, changes); });
}

void resize(PyRenderer& self, unsigned width, unsigned height) {
    without_gil(self.devices, [&] { self.renderer_alone("resize").resize(width, height); });
    self.width = width, self.height = height;
}

Dict as_dict(const RayCount& count) {
    nb::dict dict;
    dict["rays"] = count.rays;
    dict["milliseconds"] = count.milliseconds;
    return dict;
}

Dict statistics(PyRenderer& self) {
    const RenderStatistics all = without_gil(self.devices, [&] { return self.renderer().statistics(); });
    const auto& [first_pixel_seconds, first_pixel_processor_seconds, start, own_kernels_from, own_kernels,
                 build_milliseconds, bvh, primitives, camera, bounce, shadow, in_paths, effects, device_bytes,
                 most_device_bytes, parts, bytes_paged, longest_milliseconds, longest_command, dropped_samples,
                 measuring_seconds, adapted, guided] = all;
    nb::dict dict;
    dict["first_pixel_seconds"] = first_pixel_seconds;
    dict["first_pixel_processor_seconds"] = first_pixel_processor_seconds;
    dict["start"] = name_in(kernel_starts, start);
    dict["own_kernels_from"] = own_kernels_from;
    dict["own_kernels"] = own_kernels;
    dict["build_milliseconds"] = build_milliseconds;
    dict["bvh"] = tree_statistics(bvh);
    dict["primitives"] = primitives;
    dict["camera"] = as_dict(camera);
    dict["bounce"] = as_dict(bounce);
    dict["shadow"] = as_dict(shadow);
    dict["in_paths"] = as_dict(in_paths);
    dict["effects"] = to_string(effects);
    dict["device_bytes"] = device_bytes;
    dict["most_device_bytes"] = most_device_bytes;
    dict["parts"] = parts;
    dict["bytes_paged"] = bytes_paged;
    dict["longest_milliseconds"] = longest_milliseconds;
    dict["longest_command"] = longest_command;
    dict["dropped_samples"] = dropped_samples;
    dict["measuring_seconds"] = measuring_seconds;
    dict["adapted"] = adapted;
    dict["guided"] = guided;
    return dict;
}

List shares(PyRenderer& self) {
    nb::list list;
    if (!self.group) return list;
    for (const DeviceShare& share : without_gil(self.devices, [&] { return self.group->shares(); })) {
        nb::dict dict;
        dict["name"] = share.name;
        dict["samples"] = share.samples;
        dict["samples_per_second"] = share.samples_per_second;
        dict["failure"] = share.failure;
        list.append(dict);
    }
    return list;
}

/// The lines about devices that were dropped since the last call.
std::vector<std::string> take_failures(PyRenderer& self) { return std::exchange(*self.failures, {}); }

double error_between(PyRenderer& approximate, PyRenderer& exact) {
    std::vector<PyDevice> devices = approximate.devices;
    devices.insert(devices.end(), exact.devices.begin(), exact.devices.end());
    return without_gil(devices, [&] {
        return approximation_error(approximate.renderer_alone("approximate"), exact.renderer_alone("exact"));
    });
}

/// Calls a function of the renderer without the GIL. `what`: its name, if several devices cannot do it.
template <class Call>
auto of_one(const char* what, const Call& call) {
    return [what, call](PyRenderer& self) {
        return without_gil(self.devices, [&] { return call(self.renderer_alone(what)); });
    };
}
template <class Call>
auto of_lead(const Call& call) {
    return [call](PyRenderer& self) { return without_gil(self.devices, [&] { return call(self.renderer()); }); };
}

}  // namespace

void bind_renderer(nb::module_& module) {
    module.def("approximation_error", &error_between);
    nb::class_<PyRenderer>(module, "NativeRenderer")
        .def_static("make", &make_renderer)
        .def("render", &render, nb::arg("progress").none(), nb::arg("seconds").none())
        .def("restart",
             [](PyRenderer& self, std::uint32_t seed, unsigned spp, unsigned max_depth) {
                 without_gil(self.devices, [&] { self.renderer_alone("restart").restart(seed, spp, max_depth); });
             })
        .def("update", &update)
        .def("resize", &resize)
        .def("settle", of_one("settle", [](Renderer& r) { r.settle(); }))
        .def("load_kernels", of_lead([](Renderer& r) { r.load_kernels(); }))
        .def("rebuild",
             [](PyRenderer& self, const Bvh::Config& config) {
                 return without_gil(self.devices, [&] { return self.renderer_alone("rebuild").rebuild(config); });
             })
        .def("image", &image)
        .def("denoised", &denoised)
        .def("picture", &picture)
        .def("release_denoiser", of_lead([](Renderer& r) { r.release_denoiser(); }))
        .def("statistics", &statistics)
        .def("aovs", &aovs)
        .def("cryptomatte", &cryptomatte_of)
        .def("light_layers", &light_layers)
        .def("gbuffer", &gbuffer)
        .def("voxels",
             [](PyRenderer& self) {
                 return pixels_of(self, without_gil(self.devices, [&] { return self.renderer().voxels(); }));
             })
        .def("noise_map", [](PyRenderer& self) { return map_of(self, [](Renderer& r) { return r.noise_map(); }); })
        .def("alpha", [](PyRenderer& self) { return map_of(self, [](Renderer& r) { return r.alpha(); }); })
        .def("error_map", [](PyRenderer& self) { return map_of(self, [](Renderer& r) { return r.error_map(); }); })
        .def("error_of", &error_of)
        .def("cut_off", of_lead([](Renderer& r) { return r.cut_off(); }))
        .def("why_unguided", of_lead([](Renderer& r) { return r.why_unguided(); }))
        .def("checkpoint_error",
             [](PyRenderer& self) {
                 return without_gil(self.devices, [&] {
                     return self.alone ? self.alone->checkpoint_error() : self.group->checkpoint_error();
                 });
             })
        .def("shares", &shares)
        .def("take_failures", &take_failures)
        .def("size", [](const PyRenderer& self) { return std::make_pair(self.width, self.height); })
        .def("devices", [](const PyRenderer& self) { return self.devices; });
}

}  // namespace claray::python
