// Kinds of materials: one BSDF each (claray/shared/lists/bsdfs.h).
#include <array>

#include "host/bsdf/material_data.hpp"
#include "host/effects/parts/part.hpp"

namespace claray {
namespace {

/// The effect of a material's kind, without its other effects.
Effect effect_of(MaterialKind kind) {
    switch (kind) {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) \
    case MaterialKind::name: return Effect::name;
        CLARAY_MATERIAL_KINDS(CLARAY_ROW) CLARAY_CUSTOM_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
    }
    return Effect::lambert;
}

Effect effect_of(const Material& m) {
    return m.kind == MaterialKind::glass && m.thin_walled ? Effect::thin_walls : effect_of(kind_of(m));
}

template <Effect kind>
bool is_of_kind(const Material& m) {
    return effect_of(m) == kind;
}

bool is_principled(const Material& m) { return kind_of(m) == MaterialKind::principled; }

void make_lambert(Material& m) { m.kind = MaterialKind::lambert; }

/// The ball is of the kind, unless a scene is designed for it below.
template <MaterialKind kind>
void show_kind(Scene& s) {
    set_kind(s, kind, {0.7f, 0.25f, 0.12f}, 0.35f);
}
template <>
void show_kind<MaterialKind::lambert>(Scene&) {}
template <>
void show_kind<MaterialKind::mirror>(Scene& s) {
    set_kind(s, MaterialKind::mirror, glm::vec3(0.9f), 0.f);
}
template <>
void show_kind<MaterialKind::glass>(Scene& s) {
    make_glass(s);
}
template <>
void show_kind<MaterialKind::metal>(Scene& s) {
    set_kind(s, MaterialKind::metal, {1.f, 0.71f, 0.29f}, 0.3f);
}
template <>
void show_kind<MaterialKind::blinn_phong>(Scene& s) {
    replace_sky_by(s, LightKind::point);
    set_kind(s, MaterialKind::blinn_phong, {0.5f, 0.08f, 0.06f}, 0.f);
    ball_of(s).specular = glm::vec3(0.3f), ball_of(s).shininess = 60.f;
}
template <>
void show_kind<MaterialKind::unlit>(Scene& s) {
    set_kind(s, MaterialKind::unlit, {0.1f, 0.45f, 0.6f}, 0.f);
}

void show_thin_walls(Scene& s) { make_glass(s), ball_of(s).thin_walled = true, ball_of(s).albedo = {0.5f, 0.8f, 0.9f}; }

void show_coated_metal(Scene& s) {
    set_kind(s, MaterialKind::principled, {0.9f, 0.25f, 0.12f}, 0.5f);
    ball_of(s).metallic = ball_of(s).clearcoat = 1.f;
    replace_sky_by_evening(s);
}

/// Principled materials with the kind's lobe need its effect, too.
bool needs_metal(const Material& m) { return is_of_kind<Effect::metal>(m) || (is_principled(m) && m.metallic > 0); }
bool needs_thin_walls(const Material& m) {
    return is_of_kind<Effect::thin_walls>(m) || (is_principled(m) && has_thin_walls(m));
}

void strip_metal(Material& m) {
    if (is_of_kind<Effect::metal>(m)) make_lambert(m);
    m.metallic = 0.f;
}
void strip_thin_walls(Material& m) {
    if (is_of_kind<Effect::thin_walls>(m)) make_lambert(m);
    m.transmission = 0.f, m.transmission_map = {};
}

template <MaterialKind kind, Effect effect>
constexpr EffectPart part_of_kind() {
    EffectPart part{.effect = effect, .in_material = is_of_kind<effect>, .strip_material = make_lambert};
    part.show = show_kind<kind>;
    if (effect == Effect::metal) part.in_material = needs_metal, part.strip_material = strip_metal;
    return part;
}

constexpr std::array kind_parts = {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) part_of_kind<MaterialKind::name, Effect::name>(),
    CLARAY_CUSTOM_KINDS(CLARAY_ROW) CLARAY_MATERIAL_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
        EffectPart{.effect = Effect::thin_walls,
                   .in_material = needs_thin_walls,
                   .strip_material = strip_thin_walls,
                   .show = show_thin_walls},
    EffectPart{.effect = Effect::coated_metal,
               .in_material = has_coated_metal,
               .strip_material = [](Material& m) { m.clearcoat = 0.f; },
               .show = show_coated_metal}};

}  // namespace

std::span<const EffectPart> parts_of_kinds() { return kind_parts; }

}  // namespace claray
