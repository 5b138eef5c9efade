#include "host/io/gltf/gltf_accessor.hpp"

#include <algorithm>
#include <cstring>

namespace claray {
namespace {

using std::to_string;

/// Elements in memory, one every `stride` bytes. None where an accessor has no view: all are 0 then.
struct Elements {
    const char* data = nullptr;
    std::size_t count = 0, stride = 0;
    int type = 0;  ///< TINYGLTF_COMPONENT_TYPE_...
    bool normalized = false;
};

std::size_t size_of_component(int type) {
    const int size = tinygltf::GetComponentSizeInBytes(std::uint32_t(type));
    return size > 0 && type != TINYGLTF_COMPONENT_TYPE_DOUBLE ? std::size_t(size) : 0;
}

/// `count` elements of `components` from `offset` on in a view.
Elements elements_of(const GltfFile& file, int view, std::size_t offset, std::size_t count, int type,
                     std::size_t components, std::size_t stride, const std::string& what) {
    const std::string_view bytes = file.view(view, what);
    const std::size_t component = size_of_component(type), size = component * components;
    if (component == 0) file.fail(what + " has components of the unknown type " + to_string(type));
    if (stride == 0) stride = size;
    constexpr std::size_t largest_stride = 252;  // the specification's
    if (stride < size || (stride > largest_stride && stride != size))
        file.fail(what + " has a stride of " + to_string(stride) + " bytes for elements of " + to_string(size));
    if (count == 0) return {};
    if (offset > bytes.size() || size > bytes.size() - offset || (count - 1) > (bytes.size() - offset - size) / stride)
        file.fail(what + " exceeds its buffer view: " + to_string(count) + " elements of " + to_string(size) +
                  " bytes, " + to_string(stride) + " bytes apart from byte " + to_string(offset) +
                  " on, do not fit into " + to_string(bytes.size()) + " bytes");
    return {bytes.data() + offset, count, stride, type, false};
}

const tinygltf::Accessor& accessor_of(const GltfFile& file, int index, std::size_t components,
                                      const std::string& what) {
    const std::vector<tinygltf::Accessor>& accessors = file.model.accessors;
    if (index < 0 || std::size_t(index) >= accessors.size())
        file.fail(what + " refers to accessor " + to_string(index) + " of " + to_string(accessors.size()));
    const tinygltf::Accessor& accessor = accessors[std::size_t(index)];
    const int stored = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    if (stored < 0 || std::size_t(stored) != components || accessor.type == TINYGLTF_TYPE_MAT2)
        file.fail(what + " has elements of " + to_string(stored) + " components instead of " + to_string(components));
    return accessor;
}

Elements dense_elements(const GltfFile& file, const tinygltf::Accessor& accessor, std::size_t components,
                        const std::string& what) {
    if (accessor.bufferView >= 0) {
        const auto views = file.model.bufferViews.size();
        const std::size_t stride = std::size_t(accessor.bufferView) < views
                                       ? file.model.bufferViews[std::size_t(accessor.bufferView)].byteStride
                                       : 0;
        Elements found = elements_of(file, accessor.bufferView, accessor.byteOffset, accessor.count,
                                     accessor.componentType, components, stride, what);
        found.normalized = accessor.normalized;
        return found;
    }
    constexpr std::size_t most_zeros = std::size_t(1)
                                       << 24;  // no bytes stand for them, so that a typo may ask for any number
    if (accessor.count > most_zeros)
        file.fail(what + " has " + to_string(accessor.count) + " elements but no data; at most 2^24 may have none");
    if (size_of_component(accessor.componentType) == 0)
        file.fail(what + " has components of the unknown type " + to_string(accessor.componentType));
    return {nullptr, accessor.count, 0, accessor.componentType, accessor.normalized};
}

template <class T>
T stored_as(const char* from) {
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

/// glTF 2.0, section 3.6.2.2: unsigned c / max, signed max(c / max, -1).
float component(const char* from, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const auto c = float(stored_as<std::int8_t>(from));
            return normalized ? std::max(c / 127.f, -1.f) : c;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
            const auto c = float(stored_as<std::uint8_t>(from));
            return normalized ? c / 255.f : c;
        }
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const auto c = float(stored_as<std::int16_t>(from));
            return normalized ? std::max(c / 32767.f, -1.f) : c;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
            const auto c = float(stored_as<std::uint16_t>(from));
            return normalized ? c / 65535.f : c;
        }
        case TINYGLTF_COMPONENT_TYPE_INT: return float(stored_as<std::int32_t>(from));
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return float(stored_as<std::uint32_t>(from));
        default: return stored_as<float>(from);
    }
}

template <int N>
glm::vec<N, float> vector(const Elements& elements, std::size_t index) {
    glm::vec<N, float> result(0.f);
    if (elements.data == nullptr) return result;
    const char* from = elements.data + index * elements.stride;
    const std::size_t size = size_of_component(elements.type);
    for (int k = 0; k < N; ++k) result[k] = component(from + std::size_t(k) * size, elements.type, elements.normalized);
    return result;
}

bool is_index_type(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

std::uint32_t index_at(const Elements& elements, std::size_t i) {
    const char* from = elements.data + i * elements.stride;
    switch (elements.type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return stored_as<std::uint8_t>(from);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return stored_as<std::uint16_t>(from);
        default: return stored_as<std::uint32_t>(from);
    }
}

/// Calls `put(position, value index, values)` for each element that a sparse accessor replaces.
template <class Put>
void for_each_replaced(const GltfFile& file, const tinygltf::Accessor& accessor, std::size_t components,
                       const std::string& what, Put&& put) {
    if (!accessor.sparse.isSparse) return;
    const auto& sparse = accessor.sparse;
    if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
        file.fail(what + " replaces a negative number of elements");
    if (!is_index_type(sparse.indices.componentType)) file.fail(what + " has sparse indices of an unknown type");
    const auto count = std::size_t(sparse.count);
    const Elements indices = elements_of(file, sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset), count,
                                         sparse.indices.componentType, 1, 0, what);
    Elements values = elements_of(file, sparse.values.bufferView, std::size_t(sparse.values.byteOffset), count,
                                  accessor.componentType, components, 0, what);
    values.normalized = accessor.normalized;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t position = index_at(indices, i);
        if (position >= accessor.count)
            file.fail(what + " replaces element " + to_string(position) + " of " + to_string(accessor.count));
        put(position, i, values);
    }
}

}  // namespace

template <int N>
std::vector<glm::vec<N, float>> read_vectors(const GltfFile& file, int index, const std::string& what) {
    const tinygltf::Accessor& accessor = accessor_of(file, index, N, what);
    const Elements elements = dense_elements(file, accessor, N, what);
    std::vector<glm::vec<N, float>> result(elements.count);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = vector<N>(elements, i);
    for_each_replaced(file, accessor, N, what, [&](std::size_t position, std::size_t i, const Elements& values) {
        result[position] = vector<N>(values, i);
    });
    return result;
}

template std::vector<glm::vec2> read_vectors<2>(const GltfFile&, int, const std::string&);
template std::vector<glm::vec3> read_vectors<3>(const GltfFile&, int, const std::string&);
template std::vector<glm::vec4> read_vectors<4>(const GltfFile&, int, const std::string&);

std::vector<float> read_numbers(const GltfFile& file, int index, std::size_t components, const std::string& what) {
    const tinygltf::Accessor& accessor = accessor_of(file, index, components, what);
    const Elements elements = dense_elements(file, accessor, components, what);
    std::vector<float> result(elements.count * components);
    const auto put = [&](std::size_t position, std::size_t i, const Elements& from) {
        if (from.data == nullptr) return;
        const std::size_t size = size_of_component(from.type);
        for (std::size_t k = 0; k < components; ++k)
            result[position * components + k] =
                component(from.data + i * from.stride + k * size, from.type, from.normalized);
    };
    for (std::size_t i = 0; i < elements.count; ++i) put(i, i, elements);
    for_each_replaced(file, accessor, components, what, put);
    return result;
}

std::vector<std::uint32_t> read_indices(const GltfFile& file, int index, const std::string& what) {
    const tinygltf::Accessor& accessor = accessor_of(file, index, 1, what);
    if (!is_index_type(accessor.componentType)) file.fail(what + " are not unsigned integers");
    const Elements elements = dense_elements(file, accessor, 1, what);
    std::vector<std::uint32_t> result(elements.count);
    for (std::size_t i = 0; elements.data != nullptr && i < result.size(); ++i) result[i] = index_at(elements, i);
    for_each_replaced(file, accessor, 1, what, [&](std::size_t position, std::size_t i, const Elements& values) {
        result[position] = index_at(values, i);
    });
    return result;
}

}  // namespace claray
