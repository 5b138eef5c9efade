// What a scene uses, and what that costs.
#include "host/measure/explain.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "callback.hpp"
#include "claray/effects.hpp"
#include "handles.hpp"
#include "typed.hpp"

namespace claray::python {
namespace {

List causes(const Scene& scene) {
    nb::list rows;
    for (const EffectCause& cause : causes_of_effects(scene)) {
        nb::dict row;
        row["effect"] = name_of(cause.effect);
        row["first"] = cause.first;
        row["count"] = cause.count;
        rows.append(row);
    }
    return rows;
}

Dict as_dict(const measure::Variant& variant) {
    const auto& [milliseconds, compile_milliseconds, registers, spill_bytes, bytes] = variant;
    nb::dict dict;
    dict["milliseconds"] = milliseconds;
    dict["compile_milliseconds"] = compile_milliseconds;
    dict["registers"] = registers;
    dict["spill_bytes"] = spill_bytes;
    dict["bytes"] = bytes;
    return dict;
}

Dict as_dict(const measure::ExplainedEffect& e) {
    nb::dict dict;
    dict["effect"] = name_of(e.effect);
    dict["used"] = e.called_for;
    dict["first"] = e.cause.first;
    dict["count"] = e.cause.count;
    dict["measured"] = !e.fixed;
    dict["ratio"] = e.ratio;
    dict["noise"] = e.noise;
    dict["other"] = as_dict(e.other);
    dict["own_compile_milliseconds"] = e.own_compile_milliseconds;
    return dict;
}

Dict as_dict(const measure::ExplainedApproximation& a) {
    nb::dict dict;
    dict["approximation"] = to_string(a.approximate);
    dict["ratio"] = a.ratio;
    dict["noise"] = a.noise;
    dict["error"] = a.error;
    return dict;
}

/// `only`: the effects to measure; none: those that the scene uses.
Dict explain(const PyDevice& device, const Scene& scene, const RenderConfig& config,
             const std::optional<std::string>& only, const std::string& approximate, int rounds, bool compile_times,
             const nb::object& progress) {
    measure::ExplainOptions options;
    options.only = !only ? effects_of(scene) : only->empty() ? EffectSet() : parse_effects(*only);
    options.approximations = parse_approximations(approximate);
    options.everything = false;
    options.rounds = rounds;
    options.compile_times = compile_times;
    Callback callback(progress);
    const measure::Explanation explained = without_gil(device, [&] {
        return measure::explain(device.device, scene, config, options,
                                [&](const std::string& what) { (void)callback([&] { return nb::cast(what); }); });
    });
    callback.rethrow();
    nb::list effects, approximations;
    for (const measure::ExplainedEffect& effect : explained.effects) effects.append(as_dict(effect));
    for (const measure::ExplainedApproximation& a : explained.approximations) approximations.append(as_dict(a));
    nb::dict dict;
    dict["own"] = as_dict(explained.own);
    dict["effects"] = effects;
    dict["approximations"] = approximations;
    return dict;
}

}  // namespace

void bind_explain(nb::module_& module) {
    module.def("causes_of_effects", &causes);
    module.def("explain", &explain, nb::arg("device"), nb::arg("scene"), nb::arg("config"), nb::arg("only").none(),
               nb::arg("approximate"), nb::arg("rounds"), nb::arg("compile_times"), nb::arg("progress").none());
}

}  // namespace claray::python
