#include "host/io/assimp/child/glb.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace claray::assimp {
namespace {

static_assert(std::endian::native == std::endian::little, "a .glb is little endian");

/// glTF 2.0, section 3.6.2.2.
enum Component { unsigned_short = 5123, unsigned_int = 5125, real = 5126 };

void align(std::string& bytes, char with) { bytes.resize((bytes.size() + 3) / 4 * 4, with); }

std::string word(std::size_t value) {
    const auto number = std::uint32_t(value);
    return {reinterpret_cast<const char*>(&number), sizeof number};
}

}  // namespace

std::size_t Glb::push(const char* list, Json object) {
    Json& array = root[list];
    array.push_back(std::move(object));
    return array.size() - 1;
}

std::size_t Glb::add_view(const void* bytes, std::size_t size) {
    align(buffer_, '\0');
    const std::size_t begin = buffer_.size();
    buffer_.append(static_cast<const char*>(bytes), size);
    return push("bufferViews", {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", size}});
}

std::size_t Glb::add_accessor(const void* values, std::size_t bytes, std::size_t count, int component,
                              const char* type) {
    const std::size_t view = add_view(values, bytes);
    return push("accessors", {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
}

std::size_t Glb::add_floats(std::span<const float> values, const char* type, std::size_t width) {
    return add_accessor(values.data(), values.size_bytes(), values.size() / width, real, type);
}

std::size_t Glb::add_bounded(std::span<const float> values, const char* type, std::size_t width) {
    Json least = Json::array(), most = Json::array();
    for (std::size_t k = 0; k < width; ++k) {
        float lo = values[k], hi = values[k];
        for (std::size_t i = k; i < values.size(); i += width)
            lo = std::min(lo, values[i]), hi = std::max(hi, values[i]);
        least.push_back(lo), most.push_back(hi);
    }
    const std::size_t index = add_floats(values, type, width);
    root["accessors"][index]["min"] = std::move(least);
    root["accessors"][index]["max"] = std::move(most);
    return index;
}

std::size_t Glb::add_indices(std::span<const std::uint32_t> values) {
    return add_accessor(values.data(), values.size_bytes(), values.size(), unsigned_int, "SCALAR");
}

std::size_t Glb::add_joints(std::span<const std::uint16_t> values) {
    return add_accessor(values.data(), values.size_bytes(), values.size() / 4, unsigned_short, "VEC4");
}

void Glb::use(const char* extension) {
    Json& used = root["extensionsUsed"];
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
}

bool Glb::write(std::FILE* file) {
    align(buffer_, '\0');
    if (!buffer_.empty()) root["buffers"] = Json::array({{{"byteLength", buffer_.size()}}});
    std::string json = root.dump(-1, ' ', false, Json::error_handler_t::replace);  // names may be no UTF-8
    align(json, ' ');
    const std::size_t size = 12 + 8 + json.size() + (buffer_.empty() ? 0 : 8 + buffer_.size());
    if (size > std::numeric_limits<std::uint32_t>::max()) return false;
    const std::string head = "glTF" + word(2) + word(size) + word(json.size()) + "JSON";
    bool written = std::fwrite(head.data(), 1, head.size(), file) == head.size();
    written &= std::fwrite(json.data(), 1, json.size(), file) == json.size();
    if (!buffer_.empty()) {
        const std::string chunk = word(buffer_.size()) + std::string("BIN\0", 4);
        written &= std::fwrite(chunk.data(), 1, chunk.size(), file) == chunk.size();
        written &= std::fwrite(buffer_.data(), 1, buffer_.size(), file) == buffer_.size();
    }
    return std::fflush(file) == 0 && written;
}

}  // namespace claray::assimp
