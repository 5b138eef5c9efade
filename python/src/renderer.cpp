// The path tracer.
#include "claray/renderer.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <exception>

#include "arrays.hpp"
#include "callback.hpp"
#include "claray/io.hpp"

namespace claray::python {
namespace {

struct PyRenderer {
    PyDevice device;
    unsigned width = 0, height = 0;
    Kept<Renderer> renderer;
};

PyRenderer make_renderer(const PyDevice& device, const Scene& scene, const RenderConfig& config) {
    return without_gil(device, [&] {
        return PyRenderer{device, config.width, config.height, Renderer(device.device, scene, config)};
    });
}

nb::dict as_dict(const RenderProgress& p) {
    nb::dict dict;
    dict["spp"] = p.spp;
    dict["spp_target"] = p.spp_target;
    dict["seconds"] = p.seconds;
    dict["noise"] = p.noise;
    dict["error"] = p.error;
    dict["error_bound"] = p.error_bound;
    dict["error_of_fireflies"] = p.error_of_fireflies;
    dict["dropped_samples"] = p.dropped_samples;
    dict["culled"] = p.culled;
    return dict;
}

nb::dict render(PyRenderer& self, const nb::object& progress) {
    Callback callback(progress);
    const RenderProgress reached = without_gil(self.device, [&] {
        return self.renderer.render([&](const RenderProgress& p) { return callback([&] { return as_dict(p); }); });
    });
    callback.rethrow();
    return as_dict(reached);
}

nb::object image(const PyRenderer& self, const std::optional<std::string>& denoiser) {
    std::vector<glm::vec3> pixels = without_gil(self.device, [&] {
        if (!denoiser) return self.renderer.image();
        if (*denoiser == "claray") return self.renderer.denoised(DenoiserKind::claray);
        if (*denoiser == "oidn") return self.renderer.denoised(DenoiserKind::oidn);
        if (*denoiser == "automatic") return self.renderer.denoised();
        throw Error(ErrorKind::usage, "denoise: unknown name '" + *denoiser + "'", "use automatic, claray or oidn");
    });
    return array_of<float>(std::move(pixels), {self.height, self.width, 3});
}

nb::dict aovs(const PyRenderer& self) {
    Aovs all = without_gil(self.device, [&] { return self.renderer.aovs(); });
    const std::vector<std::size_t> one = {self.height, self.width}, three = {self.height, self.width, 3};
    nb::dict dict;
    for_each_aov(all, [&](const AovRow& row, auto& pixels) {
        using Pixel = typename std::remove_reference_t<decltype(pixels)>::value_type;
        using Word = std::conditional_t<std::is_same_v<Pixel, std::uint32_t>, std::uint32_t, float>;
        dict[row.name] = array_of<Word>(std::move(pixels), sizeof(Pixel) == sizeof(Word) ? one : three);
    });
    return dict;
}

nb::object error_map(PyRenderer& self) {
    std::vector<float> widths = without_gil(self.device, [&] { return self.renderer.error_map(); });
    return array_of<float>(std::move(widths), {self.height, self.width});
}

void update(PyRenderer& self, const Scene& scene, bool camera, bool lights, bool materials, bool sky) {
    SceneChanges changes;
    changes.camera = camera, changes.lights = lights, changes.materials = materials, changes.sky = sky;
    without_gil(self.device, [&] { self.renderer.update(scene, changes); });
}

/// PNG in memory is what notebooks show; files get the same bytes.
Image image_from(const Input<float, nb::shape<-1, -1, 3>>& pixels) {
    Image image{unsigned(pixels.shape(1)), unsigned(pixels.shape(0)), {}};
    const auto values = span_of<glm::vec3>(pixels, 3);
    image.pixels.assign(values.begin(), values.end());
    return image;
}

ToneMap tone_map_of(const std::string& name) {
    if (name == "aces") return ToneMap::aces;
    if (name == "none") return ToneMap::none;
    throw Error(ErrorKind::usage, "tone_map: unknown name '" + name + "'", "use aces or none");
}

void save_image(const std::string& path, const Input<float, nb::shape<-1, -1, 3>>& pixels, float exposure,
                const std::string& tone_map) {
    write_image(path, image_from(pixels), exposure, tone_map_of(tone_map));
}

nb::object to_bytes(const Input<float, nb::shape<-1, -1, 3>>& pixels, float exposure, const std::string& tone_map) {
    const ToneMap map = tone_map_of(tone_map);
    const float gain = std::exp2(exposure);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(pixels.size());
    for (const float value : std::span(pixels.data(), pixels.size()))
        bytes.push_back(srgb_from_linear(tone_mapped(gain * value, map)));
    return array_of<std::uint8_t>(std::move(bytes), {pixels.shape(0), pixels.shape(1), 3});
}

void bind_config(nb::module_& module) {
    nb::class_<RenderConfig>(module, "NativeRenderConfig")
        .def(nb::init<>())
        .def_rw("width", &RenderConfig::width)
        .def_rw("height", &RenderConfig::height)
        .def_rw("spp", &RenderConfig::spp)
        .def_rw("max_depth", &RenderConfig::max_depth)
        .def_rw("sample_clamp", &RenderConfig::sample_clamp)
        .def_rw("seed", &RenderConfig::seed)
        .def_rw("seconds", &RenderConfig::seconds)
        .def_rw("noise", &RenderConfig::noise)
        .def_rw("error", &RenderConfig::error)
        .def_rw("report_seconds", &RenderConfig::report_seconds);
}

}  // namespace

void bind_renderer(nb::module_& module) {
    bind_config(module);
    module.def("save_image", &save_image);
    module.def("to_bytes", &to_bytes);
    nb::class_<PyRenderer>(module, "NativeRenderer")
        .def_static("make", &make_renderer)
        .def("render", &render, nb::arg("progress").none())
        .def("restart", [](PyRenderer& self,
                           std::uint32_t seed) { without_gil(self.device, [&] { self.renderer.restart(seed); }); })
        .def("update", &update)
        .def("image", &image, nb::arg("denoiser").none())
        .def("release_denoiser",
             [](PyRenderer& self) { without_gil(self.device, [&] { self.renderer.release_denoiser(); }); })
        .def("device_bytes",
             [](const PyRenderer& self) {
                 return without_gil(self.device, [&] { return self.renderer.statistics().device_bytes; });
             })
        .def("aovs", &aovs)
        .def("error_map", &error_map)
        .def("size", [](const PyRenderer& self) { return std::make_pair(self.width, self.height); })
        .def("device", [](const PyRenderer& self) { return self.device; });
}

}  // namespace claray::python
