// GLM's vectors as tuples of Python; any sequence of that length is accepted.
#pragma once

#include <nanobind/nanobind.h>

#include <glm/glm.hpp>

namespace nanobind::detail {

template <int N>
struct type_caster<glm::vec<N, float>> {
    using Vector = glm::vec<N, float>;
    NB_TYPE_CASTER(Vector, const_name("tuple[float, ...]"))

    bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
        PyObject* tuple = PySequence_Tuple(source.ptr());  // by functions of the stable ABI only
        bool fits = tuple != nullptr && PyTuple_Size(tuple) == N;
        for (int k = 0; fits && k < N; ++k) {
            value[k] = float(PyFloat_AsDouble(PyTuple_GetItem(tuple, k)));
            fits = PyErr_Occurred() == nullptr;
        }
        PyErr_Clear();
        Py_XDECREF(tuple);
        return fits;
    }
    static handle from_cpp(const Vector& vector, rv_policy, cleanup_list*) noexcept {
        PyObject* tuple = PyTuple_New(N);
        for (int k = 0; tuple != nullptr && k < N; ++k)
            (void)PyTuple_SetItem(tuple, k, PyFloat_FromDouble(double(vector[k])));
        return tuple;
    }
};

}  // namespace nanobind::detail
