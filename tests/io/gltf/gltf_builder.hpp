// Small glTF files for tests, put together as JSON.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/io/gltf/base64.hpp"

namespace claray::test {

using nlohmann::json;

/// One buffer, and the JSON around it, to be changed at will.
class GltfBuilder {
public:
    json root = {{"asset", {{"version", "2.0"}}}};
    json more_buffers = json::array();  ///< behind the one that holds the bytes

    /// Adds bytes as a buffer view; its index.
    int view(const std::string& bytes, int stride = 0) {
        buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
        json view = {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes.size()}};
        if (stride > 0) view["byteStride"] = stride;
        buffer_ += bytes;
        return push("bufferViews", view);
    }

    /// Adds numbers of a C++ type as an accessor of elements of `type`; its index.
    template <class T>
    int accessor(const char* type, const std::vector<T>& values, bool normalized = false) {
        const std::size_t components = std::strcmp(type, "SCALAR") == 0 ? 1 : std::size_t(type[3] - '0');
        json accessor = {{"bufferView", view(bytes_of_values(values))},
                         {"componentType", component_type<T>()},
                         {"count", values.size() / components},
                         {"type", type}};
        if (normalized) accessor["normalized"] = true;
        return push("accessors", accessor);
    }

    int push(const char* array, const json& object) {
        root[array].push_back(object);
        return int(root[array].size()) - 1;
    }

    /// A mesh of one triangle in the plane z = 0, used by a node of its own.
    int triangle(json primitive = json::object()) {
        primitive["attributes"]["POSITION"] = accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
        const int mesh = push("meshes", {{"name", "tri"}, {"primitives", {primitive}}});
        push("nodes", {{"mesh", mesh}});
        return mesh;
    }

    /// A material that uses the image of a data URI by its base colour; the index of the texture.
    int texture(const std::string& uri, const json& sampler = {}) {
        json texture = {{"source", push("images", {{"uri", uri}})}};
        if (!sampler.is_null()) texture["sampler"] = push("samplers", sampler);
        return push("textures", texture);
    }

    [[nodiscard]] std::string gltf() const {
        json with_buffer = root;
        if (!buffer_.empty())
            with_buffer["buffers"] = {
                {{"byteLength", buffer_.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer_)}}};
        for (const json& more : more_buffers) with_buffer["buffers"].push_back(more);
        return with_buffer.dump();
    }

    [[nodiscard]] std::string glb() const {
        json with_buffer = root;
        with_buffer["buffers"] = {{{"byteLength", buffer_.size()}}};
        for (const json& more : more_buffers) with_buffer["buffers"].push_back(more);
        std::string text = with_buffer.dump(), binary = buffer_;
        text.resize((text.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4, '\0');
        const std::string chunks =
            word(text.size()) + "JSON" + text + word(binary.size()) + std::string("BIN\0", 4) + binary;
        return "glTF" + word(2) + word(chunks.size() + 12) + chunks;
    }

    [[nodiscard]] const std::string& buffer() const { return buffer_; }

    template <class T>
    static std::string bytes_of_values(const std::vector<T>& values) {
        return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
    }

    template <class T>
    static constexpr int component_type() {
        if constexpr (std::is_same_v<T, float>) return 5126;
        if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
        if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
        if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
        if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
        return 5125;
    }

private:
    static std::string word(std::size_t value) {
        const auto little = std::uint32_t(value);
        return {char(little & 255), char(little >> 8 & 255), char(little >> 16 & 255), char(little >> 24)};
    }

    std::string buffer_;
};

}  // namespace claray::test
