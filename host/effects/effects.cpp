#include "host/effects/effects.hpp"

#include <algorithm>
#include <array>

#include "claray/error.hpp"
#include "host/bsdf/custom_bsdfs.hpp"

namespace claray {
namespace {

constexpr unsigned none = 0, generate = unsigned(Stage::generate), trace = unsigned(Stage::trace),
                   shade = unsigned(Stage::shade), aovs = unsigned(Stage::aovs);

/// Unlit materials show their colour to the end of a path.
constexpr unsigned traits_of_bsdf(std::uint32_t kind) {
    return CLARAY_OF_BSDF | (kind == CLARAY_UNLIT ? CLARAY_EMITS : 0u);
}
constexpr unsigned traits_of_light(LightKind kind) {
    return CLARAY_SAMPLED | (traits_of(kind)->seen ? CLARAY_EMITS : 0u);
}

/// Effects that share a macro are bits of its value. The structure that is traced brings the macros of effects without
/// stages (host/render/structure.hpp).
struct EffectRow {
    Effect effect;
    const char* name;
    const char* macro;
    unsigned bit;
    unsigned stages;
    unsigned lanes;
    unsigned traits;
};
constexpr std::array rows = {
#define CLARAY_ROW(name, text, MACRO, bit, stages, lanes, traits) \
    EffectRow{Effect::name, text, #MACRO, bit, stages, lanes, traits},
#define CLARAY_BSDF(name, NAME, text, transmits, lobes, rough) \
    EffectRow{Effect::name, text, "MATERIALS", CLARAY_##NAME, shade, CLARAY_LANES_ALL, traits_of_bsdf(CLARAY_##NAME)},
#define CLARAY_LIGHT(name, NAME, text, far, cone)                                                           \
    EffectRow{Effect::name##_lights,           text "-lights", #NAME "_LIGHTS", 0, shade, CLARAY_LANES_ALL, \
              traits_of_light(LightKind::name)},
#define CLARAY_PROJECTION(name, NAME, text, flat, parallel, stretch) \
    EffectRow{Effect::name, text, "PROJECTIONS", CLARAY_##NAME, generate | shade, CLARAY_LANES_ALL, 0},
    CLARAY_EFFECTS(CLARAY_ROW, CLARAY_BSDF, CLARAY_LIGHT, CLARAY_PROJECTION)
#undef CLARAY_ROW
#undef CLARAY_BSDF
#undef CLARAY_LIGHT
#undef CLARAY_PROJECTION
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
static_assert(rows.size() <= EffectSet::most, "an EffectSet has too few bits");

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
        if (row.stages != none) all.add(row.effect);
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

bool have_lanes(EffectSet effects, unsigned lanes) {
    return std::all_of(rows.begin(), rows.end(),
                       [&](const EffectRow& row) { return (row.lanes & lanes) == lanes || !effects.has(row.effect); });
}

EffectSet effects_with(unsigned traits) {
    EffectSet found;
    for (const EffectRow& row : rows)
        if ((row.traits & traits) != 0) found.add(row.effect);
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
