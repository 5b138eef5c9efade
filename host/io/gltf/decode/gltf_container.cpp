#include "host/io/gltf/decode/gltf_container.hpp"

namespace claray {
namespace {

using std::to_string;

constexpr std::size_t header_bytes = 12, chunk_header = 8;

std::uint32_t from_little_endian(std::string_view bytes) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | std::uint8_t(bytes[i]);
    return value;
}

/// Both the JSON parser and tinygltf walk through nested values by recursion: too deep, and the stack ends.
void check_depth(std::string_view json, const GltfFile& file) {
    constexpr int deepest = 256;
    bool in_string = false;
    int depth = 0;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_string && c == '\\')
            ++i;
        else if (c == '"')
            in_string = !in_string;
        else if (!in_string && (c == '{' || c == '['))
            ++depth;
        else if (!in_string && (c == '}' || c == ']'))
            --depth;
        if (depth > deepest) file.fail("its JSON is nested deeper than " + to_string(deepest));
    }
}

/// glTF 2.0, section 4.4: a header, then chunks, of which the first is the JSON.
GltfContainer open_binary(std::string_view bytes, const GltfFile& file) {
    if (bytes.size() < header_bytes + chunk_header) file.fail("the file is cut off");
    if (from_little_endian(bytes.substr(4)) != 2)
        file.fail("binary glTF of version " + to_string(from_little_endian(bytes.substr(4))), "export it as glTF 2.0");
    const std::size_t length = from_little_endian(bytes.substr(8));
    if (length > bytes.size())
        file.fail("the file is cut off: " + to_string(bytes.size()) + " of " + to_string(length) + " bytes");
    if (length < header_bytes + chunk_header)
        file.fail("its header states a length of " + to_string(length) + " bytes, which holds no JSON");
    GltfContainer parts;
    for (std::size_t begin = header_bytes, chunk = 0; begin + chunk_header <= length; ++chunk) {
        const std::size_t size = from_little_endian(bytes.substr(begin));
        const std::string_view type = bytes.substr(begin + 4, 4);
        begin += chunk_header;
        if (size > length - begin) file.fail("its chunk " + to_string(chunk) + " is cut off");
        if (chunk == 0 && type != "JSON") file.fail("its first chunk is not JSON");
        if (chunk == 0) parts.json = bytes.substr(begin, size);
        if (chunk == 1 && type == std::string_view("BIN\0", 4)) parts.binary = bytes.substr(begin, size);
        begin += size;
    }
    return parts;
}

}  // namespace

GltfContainer open_container(std::string_view bytes, const GltfFile& file) {
    const GltfContainer parts = bytes.starts_with("glTF") ? open_binary(bytes, file) : GltfContainer{bytes, {}};
    check_depth(parts.json, file);
    return parts;
}

}  // namespace claray
