#include "host/effects/effects.hpp"

#include <algorithm>
#include <array>

#include "claray/error.hpp"
#include "host/bsdf/custom_bsdfs.hpp"

namespace claray {
namespace {

constexpr unsigned generate = unsigned(Stage::generate), trace = unsigned(Stage::trace), shade = unsigned(Stage::shade),
                   aovs = unsigned(Stage::aovs);

/// An effect without a row is not known to the kernels. Effects that share a macro are bits of its value. Those without
/// a macro are not added to kernels: the structure that is traced brings them (host/render/structure.hpp).
struct EffectRow {
    Effect effect;
    const char* name;
    const char* macro;
    unsigned bit;
    unsigned stages;
};
constexpr std::array rows = {
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) \
    EffectRow{Effect::name, text, "MATERIALS", CLARAY_##NAME, shade},
    CLARAY_CUSTOM_KINDS(CLARAY_ROW) EffectRow{Effect::smooth_normals, "smooth-normals", "NORMALS", 0, shade | aovs},
    CLARAY_MATERIAL_KINDS(CLARAY_ROW) CLARAY_HIT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
        EffectRow{Effect::transmission, "transmission", "MATERIALS", CLARAY_GLASS, shade},
    EffectRow{Effect::rough_glass, "rough-glass", "ROUGH_GLASS", 0, shade},
    EffectRow{Effect::clearcoat, "clearcoat", "CLEARCOAT", 0, shade},
    EffectRow{Effect::layered_coat, "layered-coat", "LAYERED_COAT", 0, shade},
    EffectRow{Effect::specular, "specular", "SPECULAR", 0, shade},
    EffectRow{Effect::iridescence, "iridescence", "IRIDESCENCE", 0, shade},
    EffectRow{Effect::anisotropy, "anisotropy", "ANISOTROPY", 0, shade},
    EffectRow{Effect::sheen, "sheen", "SHEEN", 0, shade},
    EffectRow{Effect::absorption, "absorption", "ABSORPTION", 0, shade},
    EffectRow{Effect::nested_media, "nested-media", "NESTED_MEDIA", 0, shade},
    EffectRow{Effect::emissive_triangles, "emissive-triangles", "TRIANGLE_LIGHTS", 0, shade},
#define CLARAY_ROW(name, NAME, text, far, cone) \
    EffectRow{Effect::name##_lights, text "-lights", #NAME "_LIGHTS", 0, shade},
    CLARAY_LIGHT_KINDS(CLARAY_ROW)
#undef CLARAY_ROW
        EffectRow{Effect::light_falloff, "light-falloff", "LIGHT_FALLOFF", 0, shade},
    EffectRow{Effect::linear_ranges, "linear-ranges", "LINEAR_RANGES", 0, shade},
    EffectRow{Effect::light_lists, "light-lists", "LIGHT_LISTS", 0, shade},
    EffectRow{Effect::many_lights, "many-lights", "LIGHT_TREE", 0, shade},
    EffectRow{Effect::hot_spots, "hot-spots", "HOT_SPOTS", 0, shade},
    EffectRow{Effect::sky, "sky", "SKY", 0, shade},
    EffectRow{Effect::environment, "environment", "ENVIRONMENT", 0, shade},
    EffectRow{Effect::depth_of_field, "depth-of-field", "DEPTH_OF_FIELD", 0, generate},
    EffectRow{Effect::camera_motion, "camera-motion", "CAMERA_MOTION", 0, generate},
#define CLARAY_ROW(name, NAME, text, flat, parallel, stretch) \
    EffectRow{Effect::name, text, "PROJECTIONS", CLARAY_##NAME, generate | shade},
    CLARAY_OTHER_PROJECTIONS(CLARAY_ROW)
#undef CLARAY_ROW
        EffectRow{Effect::instances, "instances", nullptr, 0, 0},
    EffectRow{Effect::instance_motion, "instance-motion", nullptr, 0, 0},
    EffectRow{Effect::primitives, "primitives", nullptr, 0, 0},
    EffectRow{Effect::vertex_colors, "vertex-colors", "VERTEX_COLORS", 0, shade | aovs},
    EffectRow{Effect::textures, "textures", "TEXTURES", 0, shade | aovs},
    EffectRow{Effect::mip_maps, "mip-maps", "MIPMAPS", 0, shade | aovs},
    EffectRow{Effect::nearest_levels, "nearest-levels", "NEAREST_LEVELS", 0, shade | aovs},
    EffectRow{Effect::normal_maps, "normal-maps", "NORMAL_MAPS", 0, shade | aovs},
    EffectRow{Effect::height_maps, "height-maps", "HEIGHT_MAPS", 0, shade | aovs},
    EffectRow{Effect::emission_maps, "emission-maps", "EMISSION_MAPS", 0, shade},
    EffectRow{Effect::cut_outs, "cut-outs", "CUT_OUTS", 0, trace},
    EffectRow{Effect::culling, "culling", "CUT_OUTS", 1, trace},
    EffectRow{Effect::light_maps, "light-maps", "LIGHT_MAPS", 0, shade | aovs},
};
constexpr bool numbers_of_bsdfs_differ() {
    std::uint32_t bits = 0;
#define CLARAY_ROW(name, NAME, text, transmits, lobes, rough) CLARAY_##NAME,
    for (const std::uint32_t number : {CLARAY_BSDFS(CLARAY_ROW)}) {
#undef CLARAY_ROW
        if ((bits >> number & 1) != 0) return false;
        bits |= 1u << number;
    }
    return true;
}
static_assert(numbers_of_bsdfs_differ(), "two BSDFs of claray/shared/lists/bsdfs.h have the same number");
static_assert(rows.size() <= 64, "an EffectSet has 64 bits");

constexpr auto known = [] {
    std::array<Effect, rows.size()> effects{};
    for (std::size_t i = 0; i < rows.size(); ++i) effects[i] = rows[i].effect;
    return effects;
}();

const EffectRow* row_of(Effect effect) {
    const auto row = std::find_if(rows.begin(), rows.end(), [&](const EffectRow& r) { return r.effect == effect; });
    return row == rows.end() ? nullptr : &*row;
}

Effect effect_named(const std::string& name) {
    for (const EffectRow& row : rows)
        if (name == row.name) return row.effect;
    throw Error(ErrorKind::usage, "there is no effect '" + name + "'", "there are: " + to_string(full_effects()));
}

/// Splits at commas.
std::vector<std::string> items_of(const std::string& text) {
    std::vector<std::string> items;
    for (std::size_t begin = 0; begin <= text.size(); begin += items.back().size() + 1)
        items.push_back(text.substr(begin, text.find(',', begin) - begin));
    return items;
}

}  // namespace

const char* name_of(Effect effect) {
    const EffectRow* row = row_of(effect);
    return row ? row->name : "unknown";
}

std::span<const Effect> all_effects() {
    return custom_bsdfs().empty() ? std::span(known).subspan(1) : std::span(known);  // the first is Effect::custom
}

EffectSet known_effects() {
    EffectSet all;
    for (const Effect effect : all_effects()) all.add(effect);
    return all;
}

EffectSet full_effects() {
    EffectSet all;
    for (const EffectRow& row : rows)
        if (row.macro) all.add(row.effect);
    return all & known_effects();
}

std::string to_string(EffectSet effects) {
    std::string text;
    for (const Effect effect : known)
        if (effects.has(effect)) text += (text.empty() ? "" : ", ") + std::string(name_of(effect));
    return text.empty() ? "nothing" : text;
}

EffectSet parse_effects(const std::string& text) {
    EffectSet effects;
    if (text == "nothing") return effects;
    for (const std::string& item : items_of(text))
        effects.add(effect_named(item.substr(std::min(item.find_first_not_of(' '), item.size()))));
    return effects;
}

EffectOverrides parse_effect_overrides(const std::string& text) {
    EffectOverrides overrides;
    for (const std::string& item : items_of(text)) {
        if (!item.starts_with('+') && !item.starts_with('-'))
            throw Error(ErrorKind::usage, "effect '" + item + "' begins with neither + nor -",
                        "write +NAME or -NAME, separated by commas: +metal,-sky");
        (item[0] == '+' ? overrides.add : overrides.remove).add(effect_named(item.substr(1)));
    }
    if (!(overrides.add & overrides.remove).empty())
        throw Error(ErrorKind::usage, "effects both added and removed: " + to_string(overrides.add & overrides.remove),
                    "write each effect once");
    return overrides;
}

std::size_t number_of(EffectSet effects) {
    const std::span<const Effect> all = all_effects();
    return std::size_t(std::count_if(all.begin(), all.end(), [&](Effect effect) { return effects.has(effect); }));
}

EffectSet of_stage(EffectSet effects, Stage stage) {
    EffectSet found;
    for (const Effect effect : all_effects())
        if (effects.has(effect) && concerns(effect, stage)) found.add(effect);
    return found;
}

bool concerns(Effect effect, Stage stage) {
    const EffectRow* row = row_of(effect);
    return row && (row->stages & unsigned(stage)) != 0;
}

Defines defines_of(EffectSet effects, Stage stage) {
    Defines defines;
    std::vector<unsigned> values;
    for (const EffectRow& row : rows) {
        if ((row.stages & unsigned(stage)) == 0) continue;
        const auto at = std::find_if(defines.begin(), defines.end(), [&](auto& d) { return d.first == row.macro; });
        const auto index = std::size_t(at - defines.begin());
        if (at == defines.end()) defines.emplace_back(row.macro, ""), values.push_back(0);
        values[index] |= effects.has(row.effect) ? 1u << row.bit : 0u;
    }
    for (std::size_t i = 0; i < defines.size(); ++i) defines[i].second = std::to_string(values[i]);
    return defines;
}

}  // namespace claray
