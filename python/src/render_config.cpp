// What a render can be asked for: RenderOptions of python/claray/_options.py.
#include "render_config.hpp"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>

#include "handles.hpp"
#include "structures.hpp"
#include "typed.hpp"

namespace claray::python {
namespace {

/// A new member does not compile here. Bind it below; a test then asks for it in python/claray/_options.py.
[[maybe_unused]] void name_all_members(RenderConfig& config, LightMapConfig& light_map) {
    [[maybe_unused]] auto& [width, height, spp, max_depth, sample_clamp, seed, seconds, noise, error, adaptive, guide,
                            report_seconds, sampler, bvh, parts, effects, approximate, light_grid, compiler, checkpoint,
                            checkpoint_seconds, resume, region, alpha, lobes, light_groups] = config;
    [[maybe_unused]] auto& [x, y, region_width, region_height] = region;
    [[maybe_unused]] auto& [builder, morton_bits, layout, split_budget, max_leaf_triangles, learns] = bvh;
    [[maybe_unused]] auto& [voxels, side, coefficients, levels, gather, rays, updates] = light_grid;
    [[maybe_unused]] auto& [w, h, paths, depth, first_seed, uv_set, by, tree] = light_map;
}

/// As parse_effect_overrides reads it.
std::string text_of(const EffectOverrides& overrides) {
    std::string text;
    for (const Effect effect : all_effects()) {
        if (overrides.add.has(effect)) text += std::string(text.empty() ? "+" : ",+") + name_of(effect);
        if (overrides.remove.has(effect)) text += std::string(text.empty() ? "-" : ",-") + name_of(effect);
    }
    return text;
}

/// The error of `parse`, beginning with the name of the option.
template <class Parse>
auto parsed(const char* option, const Parse& parse) {
    try {
        return parse();
    } catch (const Error& error) {
        throw Error(error.kind(), std::string(option) + ": " + error.what());
    }
}

void bind_bvh_config(nb::module_& module) {
    nb::class_<Bvh::Config> bvh(module, "NativeBvhConfig");
    bvh.def(nb::init<>())
        .def_prop_rw(
            "builder", [](const Bvh::Config& c) { return traits_of(c.builder).name; },
            [](Bvh::Config& c, const std::string& name) { c.builder = config_of(name).builder; })
        .def_rw("morton_bits", &Bvh::Config::morton_bits)
        .def_rw("split_budget", &Bvh::Config::split_budget)
        .def_rw("max_leaf_triangles", &Bvh::Config::max_leaf_triangles)
        .def_rw("learns", &Bvh::Config::learns, nb::for_setter(nb::arg("learns").none()));
    def_named(bvh, "layout", &Bvh::Config::layout, layouts);
}

void bind_light_grid(nb::module_& module) {
    nb::class_<LightGridConfig>(module, "NativeLightGridConfig")
        .def(nb::init<>())
        .def_rw("voxels", &LightGridConfig::voxels)
        .def_rw("side", &LightGridConfig::side)
        .def_rw("coefficients", &LightGridConfig::coefficients)
        .def_rw("levels", &LightGridConfig::levels)
        .def_rw("gather", &LightGridConfig::gather)
        .def_rw("rays", &LightGridConfig::rays)
        .def_rw("updates", &LightGridConfig::updates);
}

void bind_light_map_config(nb::module_& module) {
    nb::class_<LightMapConfig> config(module, "NativeLightMapConfig");
    config.def(nb::init<>())
        .def_rw("width", &LightMapConfig::width)
        .def_rw("height", &LightMapConfig::height)
        .def_rw("spp", &LightMapConfig::spp)
        .def_rw("max_depth", &LightMapConfig::max_depth)
        .def_rw("seed", &LightMapConfig::seed)
        .def_rw("uv_set", &LightMapConfig::uv_set)
        .def_rw("bvh", &LightMapConfig::bvh);
    def_named(config, "sampler", &LightMapConfig::sampler, samplers);
}

}  // namespace

void bind_render_config(nb::module_& module) {
    bind_bvh_config(module);
    bind_light_grid(module);
    bind_light_map_config(module);
    nb::class_<RenderConfig> config(module, "NativeRenderConfig");
    config.def(nb::init<>())
        .def_rw("width", &RenderConfig::width)
        .def_rw("height", &RenderConfig::height)
        .def_rw("spp", &RenderConfig::spp)
        .def_rw("max_depth", &RenderConfig::max_depth)
        .def_rw("sample_clamp", &RenderConfig::sample_clamp)
        .def_rw("seed", &RenderConfig::seed)
        .def_rw("seconds", &RenderConfig::seconds)
        .def_rw("noise", &RenderConfig::noise)
        .def_rw("error", &RenderConfig::error)
        .def_rw("adaptive", &RenderConfig::adaptive)
        .def_rw("guide", &RenderConfig::guide)
        .def_rw("report_seconds", &RenderConfig::report_seconds)
        .def_rw("bvh", &RenderConfig::bvh)
        .def_rw("parts", &RenderConfig::parts)
        .def_prop_rw(
            "effects", [](const RenderConfig& c) { return text_of(c.effects); },
            [](RenderConfig& c, const std::string& text) {
                c.effects =
                    text.empty() ? EffectOverrides() : parsed("effects", [&] { return parse_effect_overrides(text); });
            })
        .def_prop_rw(
            "approximate", [](const RenderConfig& c) { return to_string(c.approximate); },
            [](RenderConfig& c, const std::string& text) {
                c.approximate = parsed("approximate", [&] { return parse_approximations(text); });
            })
        .def_rw("light_grid", &RenderConfig::light_grid)
        .def_rw("compiler", &RenderConfig::compiler)
        .def_prop_rw(
            "region",
            [](const RenderConfig& c) { return std::tuple(c.region.x, c.region.y, c.region.width, c.region.height); },
            [](RenderConfig& c, const std::tuple<unsigned, unsigned, unsigned, unsigned>& region) {
                std::tie(c.region.x, c.region.y, c.region.width, c.region.height) = region;
            })
        .def_rw("alpha", &RenderConfig::alpha)
        .def_rw("lobes", &RenderConfig::lobes)
        .def_rw("light_groups", &RenderConfig::light_groups)
        .def_rw("checkpoint", &RenderConfig::checkpoint,
                nb::for_setter(nb::sig("def checkpoint(self, path: str | os.PathLike[str], /) -> None")))
        .def_rw("checkpoint_seconds", &RenderConfig::checkpoint_seconds)
        .def_rw("resume", &RenderConfig::resume,
                nb::for_setter(nb::sig("def resume(self, path: str | os.PathLike[str], /) -> None")));
    def_named(config, "sampler", &RenderConfig::sampler, samplers);
    module.def("names", []() -> Dict {
        nb::dict names;
        names["Sampler"] = names_of(samplers);
        names["Denoiser"] = names_of(denoisers);
        names["ToneMap"] = names_of(tone_maps);
        names["Layout"] = names_of(layouts);
        names["NormalPacking"] = names_of(normal_packings);
        names["Builder"] = nb::cast<nb::tuple>(names_of(builders) + nb::make_tuple(automatic_traits.name));
        names["Approximation"] = to_string(all_approximations());
        names["Effect"] = to_string(known_effects());
        return names;
    });
}

}  // namespace claray::python
