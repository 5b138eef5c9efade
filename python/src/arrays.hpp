// Arrays of NumPy in the forms that claray reads and writes. The package has checked shapes and types before.
#pragma once

#include <nanobind/ndarray.h>

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "handles.hpp"

namespace claray::python {

template <class T, class... Shape>
using Input = nb::ndarray<const T, nb::c_contig, nb::device::cpu, Shape...>;
template <class T, class... Shape>
using Output = nb::ndarray<T, nb::c_contig, nb::device::cpu, Shape...>;

template <class T, class Array>
std::span<const T> span_of(const Array& array, std::size_t numbers_each = 1) {
    return {reinterpret_cast<const T*>(array.data()), array.size() / numbers_each};
}

/// An array that owns the values of a vector. `columns` numbers of the type Number form an element; 0: the element is
/// one.
template <class Number, class Element>
nb::object array_of(std::vector<Element>&& values, std::vector<std::size_t> shape) {
    auto* owned = new std::vector<Element>(std::move(values));
    const nb::capsule owner(owned, [](void* vector) noexcept { delete static_cast<std::vector<Element>*>(vector); });
    return nb::cast(
        nb::ndarray<nb::numpy, Number>(reinterpret_cast<Number*>(owned->data()), shape.size(), shape.data(), owner));
}

/// An array over memory that `owner` keeps alive; read-only.
template <class Number>
nb::object view_of(const void* data, std::vector<std::size_t> shape, nb::handle owner) {
    return nb::cast(
        nb::ndarray<nb::numpy, const Number>(static_cast<const Number*>(data), shape.size(), shape.data(), owner));
}

}  // namespace claray::python
