// A binary glTF in the making: JSON, and a buffer for what it refers to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

namespace claray::assimp {

using Json = nlohmann::json;

class Glb {
public:
    Json root = {{"asset", {{"version", "2.0"}, {"generator", "claray-import"}}}};

    /// Appends an object to a list of the root, and returns its index.
    std::size_t push(const char* list, Json object);

    std::size_t add_view(const void* bytes, std::size_t size);
    /// `type`: "SCALAR", "VEC3", ...; `width`: its numbers.
    std::size_t add_floats(std::span<const float> values, const char* type, std::size_t width);
    /// The same, with the least and the largest value of each component, as positions and times need them.
    std::size_t add_bounded(std::span<const float> values, const char* type, std::size_t width);
    std::size_t add_indices(std::span<const std::uint32_t> values);
    std::size_t add_joints(std::span<const std::uint16_t> values);

    /// Notes that an extension is used.
    void use(const char* extension);

    /// Returns false if it is larger than a .glb may be, or cannot be written.
    [[nodiscard]] bool write(std::FILE* file);

private:
    std::size_t add_accessor(const void* values, std::size_t bytes, std::size_t count, int component, const char* type);

    std::string buffer_;
};

}  // namespace claray::assimp
