// Names of the library's kinds, as Python has them.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <string>

#include "claray/error.hpp"

namespace claray::python {

template <class Kind>
struct Named {
    Kind kind;
    const char* name;
};

/// The kind of that name, from rows with the members `kind` and `name`. Throws ErrorKind::usage, beginning with `what`.
template <class Rows>
auto kind_of(const std::string& what, const std::string& name, const Rows& rows) {
    std::string names;
    for (const auto& row : rows) {
        if (name == row.name) return row.kind;
        names += std::string(names.empty() ? "" : ", ") + row.name;
    }
    throw Error(ErrorKind::usage, what + ": unknown name '" + name + "'", "use one of " + names);
}

template <class Kind, class Rows>
const char* name_in(const Rows& rows, Kind kind) {
    for (const auto& row : rows)
        if (row.kind == kind) return row.name;
    return "unknown";
}

/// A property that is a kind in C++ and its name in Python.
template <class Class, class Kind, class Rows>
void def_named(nanobind::class_<Class>& of, const char* property, Kind Class::*member, const Rows& rows) {
    of.def_prop_rw(
        property, [member, &rows](const Class& self) { return name_in(rows, self.*member); },
        [member, &rows, property](Class& self, const std::string& name) {
            self.*member = kind_of(property, name, rows);
        });
}

/// All names, for tests of the package's types.
template <class Rows>
nanobind::tuple names_of(const Rows& rows) {
    nanobind::list names;
    for (const auto& row : rows) names.append(row.name);
    return nanobind::tuple(names);
}

}  // namespace claray::python
