// What extensions of a glTF say: numbers of JSON objects, with a value to fall back to.
#pragma once

#include <glm/glm.hpp>

#include "host/io/gltf/decode/tinygltf.hpp"

namespace claray {

inline float gltf_number(const tinygltf::Value& object, const char* key, float fallback) {
    if (!object.IsObject() || !object.Has(key)) return fallback;
    const tinygltf::Value& value = object.Get(key);
    return value.IsNumber() ? float(value.GetNumberAsDouble()) : fallback;
}

/// -1 where it is no index.
inline int gltf_index(const tinygltf::Value& object, const char* key, int fallback) {
    const float value = gltf_number(object, key, float(fallback));
    return value >= 0.f && value < 1e6f ? int(value) : -1;
}

/// Up to N numbers of an array.
template <int N>
glm::vec<N, float> gltf_numbers(const tinygltf::Value& object, const char* key, glm::vec<N, float> fallback) {
    if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsArray()) return fallback;
    const tinygltf::Value& array = object.Get(key);
    for (int k = 0; k < N && std::size_t(k) < array.ArrayLen(); ++k)
        if (array.Get(std::size_t(k)).IsNumber()) fallback[k] = float(array.Get(std::size_t(k)).GetNumberAsDouble());
    return fallback;
}

/// An extension of an object; an empty value where it has none.
inline const tinygltf::Value& gltf_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    static const tinygltf::Value none;
    const auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

}  // namespace claray
