// Light that is rendered once and used by later images: light maps and probes.
#include <nanobind/stl/string.h>

#include "callback.hpp"
#include "claray/renderer.hpp"
#include "handles.hpp"
#include "vectors.hpp"

namespace claray::python {
namespace {

Texture bake(const PyDevice& device, const Scene& scene, std::size_t mesh, const LightMapConfig& config,
             const nb::object& progress) {
    Callback callback(progress);
    try {
        Texture map = without_gil(device, [&] {
            return bake_light_map(device.device, scene, mesh, config,
                                  [&](double done) { return callback([&] { return nb::cast(done); }); });
        });
        callback.rethrow();
        return map;
    } catch (const Error&) {
        callback.rethrow();  // which is why baking stopped
        throw;
    }
}

}  // namespace

void bind_bake(nb::module_& module) {
    module.def("bake_light_map", &bake, nb::arg("device"), nb::arg("scene"), nb::arg("mesh"), nb::arg("config"),
               nb::arg("progress").none());
    module.def("use_light_map", [](Scene& scene, std::size_t mesh, const Texture& map, std::uint32_t uv_set) {
        use_light_map(scene, mesh, map, uv_set);
    });
    module.def("light_map_uv_set", &light_map_uv_set);
    module.def("render_probe",
               [](const PyDevice& device, const Scene& scene, const glm::vec3& position, const RenderConfig& config) {
                   return without_gil(device, [&] { return render_probe(device.device, scene, position, config); });
               });
    module.def("compile_kernels", [](const PyDevice& device, const std::string& effects, const RenderConfig& config) {
        const EffectSet set = parse_effects(effects);
        without_gil(device, [&] { compile_kernels(device.device, set, config); });
    });
}

}  // namespace claray::python
