// What accuracy costs in time.
#include "claray/accuracy.hpp"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "callback.hpp"
#include "handles.hpp"
#include "host/accuracy/plot.hpp"
#include "host/accuracy/study_list.hpp"
#include "typed.hpp"

namespace claray::python {
namespace {

const NamedStudy& study_called(const std::string& name) {
    std::string names;
    for (const NamedStudy& known : all_studies) {
        if (name == known.name) return known;
        names += std::string(names.empty() ? "" : ", ") + known.name;
    }
    throw Error(ErrorKind::usage, "study: unknown name '" + name + "'", "use one of " + names);
}

Study run(const PyDevice& device, const Scene& scene, const std::string& name, const StudyOptions& options,
          const nb::object& progress) {
    const NamedStudy& named = study_called(name);
    Callback callback(progress);
    Study study;
    try {
        study = without_gil(device, [&] {
            const auto tell = [&](double done, const std::string& what) {
                return callback([&] { return nb::make_tuple(done, what); });
            };
            return named.run != nullptr ? named.run(device.device, scene, options, tell)
                                        : named.run_with_maps(device.device, scene, options, tell, nullptr);
        });
    } catch (const Error&) {
        callback.rethrow();  // which is why the study stopped
        throw;
    }
    callback.rethrow();
    return study;
}

Dict as_dict(const StudyPoint& p) {
    const auto spread = [](const Spread& s) { return nb::make_tuple(s.low, s.median, s.high); };
    nb::dict dict;
    dict["method"] = p.method;
    dict["setting"] = p.setting;
    dict["value"] = p.value;
    dict["runs"] = p.runs;
    dict["error"] = spread(p.error);
    dict["seconds"] = spread(p.seconds);
    dict["front"] = p.front;
    dict["failure"] = p.failure;
    nb::dict facts;
    for (const auto& [name, value] : p.facts) facts[name.c_str()] = value;
    dict["facts"] = facts;
    return dict;
}

}  // namespace

void bind_accuracy(nb::module_& module) {
    module.def("study_names", [] {
        std::vector<std::string> names;
        for (const NamedStudy& study : all_studies) names.emplace_back(study.name);
        return names;
    });
    nb::class_<StudyOptions>(module, "NativeStudyOptions")
        .def(nb::init<>())
        .def_rw("config", &StudyOptions::config)
        .def_rw("most_spp", &StudyOptions::most_spp)
        .def_rw("runs", &StudyOptions::runs)
        .def_rw("rays", &StudyOptions::rays);
    nb::class_<Study>(module, "NativeStudy")
        .def_ro("name", &Study::name)
        .def_ro("title", &Study::title)
        .def_ro("error", &Study::error)
        .def_ro("cost", &Study::cost)
        .def_ro("floor", &Study::floor)
        .def_ro("findings", &Study::findings)
        .def("points",
             [](const Study& study) -> List {
                 nb::list points;
                 for (const StudyPoint& point : study.points) points.append(as_dict(point));
                 return points;
             })
        .def("svg", &svg_of);
    module.def("run_study", &run, nb::arg("device"), nb::arg("scene"), nb::arg("name"), nb::arg("options"),
               nb::arg("progress").none());
}

}  // namespace claray::python
