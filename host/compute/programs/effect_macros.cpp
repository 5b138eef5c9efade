#include "host/compute/programs/effect_macros.hpp"

#include <algorithm>
#include <string_view>

#include "claray/shared/lists/effects.h"

namespace claray {
namespace {

struct EffectMacro {
    const char *name, *otherwise;
    unsigned bit;
};
constexpr EffectMacro effect_macros[] = {
#define CLARAY_ROW(name, text, MACRO, bit, stages, lanes, traits) \
    {#MACRO, std::string_view(#stages) == "none" ? "0" : "1", bit},
#define CLARAY_KIND(...)  // its macro's default is beside the kinds' code
    CLARAY_EFFECTS(CLARAY_ROW, CLARAY_KIND, CLARAY_KIND, CLARAY_KIND)
#undef CLARAY_ROW
#undef CLARAY_KIND
};

}  // namespace

void add_effect_macros(Defines& defines, const std::function<bool(const std::string&)>& is_needed) {
    for (const EffectMacro& macro : effect_macros) {
        if (macro.bit != 0) continue;  // of another's macro
        const auto same = [&](const auto& define) { return define.first == macro.name; };
        if (std::any_of(defines.begin(), defines.end(), same) || !is_needed(macro.name)) continue;
        defines.emplace_back(macro.name, macro.otherwise);
    }
}

}  // namespace claray
