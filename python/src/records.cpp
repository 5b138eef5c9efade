// Materials, lights and cameras.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "claray/scene.hpp"
#include "handles.hpp"
#include "names.hpp"
#include "texture_use.hpp"
#include "typed.hpp"
#include "vectors.hpp"

namespace claray::python {
namespace {

inline constexpr Named<AlphaMode> alpha_modes[] = {
    {AlphaMode::opaque, "opaque"}, {AlphaMode::mask, "mask"}, {AlphaMode::blend, "blend"}};
inline constexpr Named<AlphaTest> alpha_tests[] = {{AlphaTest::greater_equal, ">="}, {AlphaTest::greater, ">"},
                                                   {AlphaTest::less, "<"},           {AlphaTest::less_equal, "<="},
                                                   {AlphaTest::equal, "=="},         {AlphaTest::not_equal, "!="}};
inline constexpr Named<MaterialRole> roles[] = {{MaterialRole::surface, "surface"},
                                                {MaterialRole::holdout, "holdout"},
                                                {MaterialRole::shadow_catcher, "shadow-catcher"}};
inline constexpr Named<Stereo> stereos[] = {
    {Stereo::none, "none"}, {Stereo::side_by_side, "side-by-side"}, {Stereo::top_bottom, "top-bottom"}};
inline constexpr Named<MaterialKind> custom_kind = {MaterialKind::custom, "custom"};

/// A new member does not compile here. Bind it below; a test then asks for it in python/claray/_records.py.
[[maybe_unused]] void name_all_members(Material& material, Light& light, Camera& camera) {
    [[maybe_unused]] auto& [name, kind, albedo, emission, roughness, ior, metallic, transmission, thin_walled,
                            clearcoat, clearcoat_roughness, specular, specular_weight, specular_tint, sheen,
                            sheen_roughness, anisotropy, anisotropy_rotation, iridescence, iridescence_ior,
                            film_thickness, attenuation, attenuation_distance, opacity, alpha_mode, alpha_cutoff,
                            alpha_test, cull_back, role, albedo_map, emission_map, metallic_roughness_map,
                            transmission_map, clearcoat_map, clearcoat_roughness_map, clearcoat_normal_map,
                            clearcoat_normal_scale, specular_map, specular_weight_map, shininess_map, sheen_map,
                            sheen_roughness_map, anisotropy_map, iridescence_map, film_thickness_map, opacity_map,
                            normal_map, normal_scale, height_map, height_scale, light_map, custom,
                            parameters
#define CLARAY_ROW(member, text, standard, check) , member
                                CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
    ] = material;
    [[maybe_unused]] auto& [light_name, light_kind, position, direction, intensity, inner_angle, outer_angle, range,
                            falloff, linear_range] = light;
    [[maybe_unused]] auto& [eye, target, up, vertical_fov, aperture_radius, focus_distance, position_end, target_end,
                            projection, orthographic_height, shift, tilt, stereo, eye_distance] = camera;
}

MaterialKind material_kind_called(const std::string& name) {
    return name == custom_kind.name ? custom_kind.kind : kind_of("kind", name, material_kinds);
}

void bind_maps(nb::class_<Material>& material) {
    const auto map = [&](const char* name, TextureUse Material::*member) {
        material.def_rw(name, member, nb::for_setter(nb::arg(name).none()));
    };
    map("albedo_map", &Material::albedo_map);
    map("emission_map", &Material::emission_map);
    map("metallic_roughness_map", &Material::metallic_roughness_map);
    map("transmission_map", &Material::transmission_map);
    map("clearcoat_map", &Material::clearcoat_map);
    map("clearcoat_roughness_map", &Material::clearcoat_roughness_map);
    map("clearcoat_normal_map", &Material::clearcoat_normal_map);
    map("specular_map", &Material::specular_map);
    map("specular_weight_map", &Material::specular_weight_map);
    map("shininess_map", &Material::shininess_map);
    map("sheen_map", &Material::sheen_map);
    map("sheen_roughness_map", &Material::sheen_roughness_map);
    map("anisotropy_map", &Material::anisotropy_map);
    map("iridescence_map", &Material::iridescence_map);
    map("film_thickness_map", &Material::film_thickness_map);
    map("opacity_map", &Material::opacity_map);
    map("normal_map", &Material::normal_map);
    map("height_map", &Material::height_map);
    map("light_map", &Material::light_map);
}

void bind_material(nb::module_& module) {
    nb::class_<Material> material(module, "NativeMaterial");
    material.def(nb::init<>())
        .def("copy", [](const Material& from) { return Material(from); })
        .def_prop_rw(
            "kind", [](const Material& m) { return row_of(m.kind) ? row_of(m.kind)->name : custom_kind.name; },
            [](Material& m, const std::string& name) { m.kind = material_kind_called(name); })
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
        .def_rw("specular_weight", &Material::specular_weight)
        .def_rw("specular_tint", &Material::specular_tint)
        .def_rw("sheen", &Material::sheen)
        .def_rw("sheen_roughness", &Material::sheen_roughness)
        .def_rw("anisotropy", &Material::anisotropy)
        .def_rw("anisotropy_rotation", &Material::anisotropy_rotation)
        .def_rw("iridescence", &Material::iridescence)
        .def_rw("iridescence_ior", &Material::iridescence_ior)
        .def_rw("film_thickness", &Material::film_thickness)
        .def_rw("attenuation", &Material::attenuation)
        .def_rw("attenuation_distance", &Material::attenuation_distance)
        .def_rw("opacity", &Material::opacity)
        .def_rw("alpha_cutoff", &Material::alpha_cutoff)
        .def_rw("cull_back", &Material::cull_back)
        .def_rw("clearcoat_normal_scale", &Material::clearcoat_normal_scale)
        .def_rw("normal_scale", &Material::normal_scale)
        .def_rw("height_scale", &Material::height_scale)
        .def_rw("custom", &Material::custom)
        .def_rw("parameters", &Material::parameters);
    def_named(material, "alpha_mode", &Material::alpha_mode, alpha_modes);
    def_named(material, "alpha_test", &Material::alpha_test, alpha_tests);
    def_named(material, "role", &Material::role, roles);
    bind_maps(material);
#define CLARAY_ROW(name, text, standard, check) material.def_rw(#name, &Material::name);
    CLARAY_BSDF_PARAMETERS(CLARAY_ROW)
#undef CLARAY_ROW
}

void bind_light(nb::module_& module) {
    nb::class_<Light>(module, "NativeLight")
        .def(nb::init<>())
        .def("copy", [](const Light& from) { return Light(from); })
        .def_prop_rw(
            "kind", [](const Light& l) { return name_in(light_kinds, l.kind); },
            [](Light& l, const std::string& name) { l.kind = kind_of("kind", name, light_kinds); })
        .def_rw("name", &Light::name)
        .def_rw("position", &Light::position)
        .def_rw("direction", &Light::direction)
        .def_rw("intensity", &Light::intensity)
        .def_rw("inner_angle", &Light::inner_angle)
        .def_rw("outer_angle", &Light::outer_angle)
        .def_rw("range", &Light::range)
        .def_rw("attenuation", &Light::attenuation)
        .def_rw("linear_range", &Light::linear_range);
}

void bind_camera(nb::module_& module) {
    nb::class_<Camera> camera(module, "NativeCamera");
    camera.def(nb::init<>())
        .def("copy", [](const Camera& from) { return Camera(from); })
        .def("orbited", [](const Camera& from, float degrees) { return orbited(from, degrees); })
        .def_rw("position", &Camera::position)
        .def_rw("target", &Camera::target)
        .def_rw("up", &Camera::up)
        .def_rw("vertical_fov", &Camera::vertical_fov)
        .def_rw("aperture_radius", &Camera::aperture_radius)
        .def_rw("focus_distance", &Camera::focus_distance)
        .def_rw("position_end", &Camera::position_end, nb::for_setter(nb::arg("position_end").none()))
        .def_rw("target_end", &Camera::target_end, nb::for_setter(nb::arg("target_end").none()))
        .def_prop_rw(
            "projection", [](const Camera& c) { return name_in(projections, c.projection); },
            [](Camera& c, const std::string& name) { c.projection = kind_of("projection", name, projections); })
        .def_rw("orthographic_height", &Camera::orthographic_height)
        .def_rw("shift", &Camera::shift)
        .def_rw("tilt", &Camera::tilt)
        .def_rw("eye_distance", &Camera::eye_distance);
    def_named(camera, "stereo", &Camera::stereo, stereos);
}

}  // namespace

void bind_records(nb::module_& module) {
    bind_material(module);
    bind_light(module);
    bind_camera(module);
    module.def("record_names", []() -> Dict {
        nb::dict names;
        names["MaterialKind"] = nb::cast<nb::tuple>(names_of(material_kinds) + nb::make_tuple(custom_kind.name));
        names["LightKind"] = names_of(light_kinds);
        names["Projection"] = names_of(projections);
        names["AlphaMode"] = names_of(alpha_modes);
        names["AlphaTest"] = names_of(alpha_tests);
        names["MaterialRole"] = names_of(roles);
        names["Stereo"] = names_of(stereos);
        return names;
    });
    module.def("add_bsdf", [](const std::string& name, const std::string& source, std::uint32_t parameters) {
        return add_bsdf({name, source, parameters});
    });
}

}  // namespace claray::python
