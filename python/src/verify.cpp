// Whether a device can be trusted.
#include "claray/verify.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "callback.hpp"
#include "handles.hpp"
#include "typed.hpp"

namespace claray::python {
namespace {

Dict as_dict(const VerifyResult& result) {
    nb::list checks;
    for (const VerifyCheck& c : result.checks) {
        nb::dict check;
        check["what"] = c.what;
        check["tried"] = c.tried;
        check["worst"] = c.worst;
        check["bar"] = c.bar;
        check["unit"] = c.unit;
        check["holds"] = c.holds();
        checks.append(check);
    }
    nb::dict dict;
    dict["name"] = result.name;
    dict["holds"] = result.holds();
    dict["seconds"] = result.seconds;
    dict["failures"] = nb::cast(result.failures);
    dict["checks"] = checks;
    dict["command"] = result.command;
    return dict;
}

List run(const PyDevice& device, const std::vector<std::string>& names, bool quick, std::uint64_t seed, bool times,
         const nb::object& report) {
    VerifyOptions options;
    options.effort = quick ? Effort::quick : Effort::full;
    options.seed = seed, options.times = times;
    check_verify_cases(names);
    Callback callback(report);
    std::vector<VerifyResult> results;
    for (const std::string& name : names) {
        results.push_back(without_gil(device, [&] { return run_verify_case(device.device, name, options); }));
        if (!callback([&] { return nb::object(as_dict(results.back())); })) break;
    }
    callback.rethrow();
    nb::list list;
    for (const VerifyResult& result : results) list.append(as_dict(result));
    return list;
}

}  // namespace

void bind_verify(nb::module_& module) {
    module.def("verify_cases", [] {
        std::vector<std::string> names;
        for (const VerifyCase& known : verify_cases()) names.push_back(known.name);
        return names;
    });
    module.def("verify", &run, nb::arg("device"), nb::arg("names"), nb::arg("quick"), nb::arg("seed"), nb::arg("times"),
               nb::arg("report").none());
}

}  // namespace claray::python
