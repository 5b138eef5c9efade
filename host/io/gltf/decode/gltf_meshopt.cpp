// Buffer views compressed by meshoptimizer (EXT_meshopt_compression, KHR_meshopt_compression).
#include "host/io/gltf/decode/gltf_compression.hpp"

#if CLARAY_WITH_MESHOPT
#include <meshoptimizer.h>
#endif

namespace claray {
#if CLARAY_WITH_MESHOPT
namespace {

using std::to_string;

/// What the extension says of a view.
struct Packed {
    std::string_view bytes;
    std::size_t stride = 0, count = 0;
    std::string mode, filter;
};

std::string text_in(const tinygltf::Value& object, const char* key, const char* fallback) {
    return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : fallback;
}

std::string_view bytes_of(const GltfFile& file, const tinygltf::Value& extension, const std::string& name) {
    const std::size_t buffer = count_in(file, extension, "buffer", ~std::size_t(0), name),
                      offset = count_in(file, extension, "byteOffset", 0, name),
                      length = count_in(file, extension, "byteLength", 0, name);
    if (buffer >= file.model.buffers.size())
        file.fail(name + ": its compressed data is in buffer " + to_string(buffer) + " of " +
                  to_string(file.model.buffers.size()));
    const std::vector<unsigned char>& data = file.model.buffers[buffer].data;
    if (offset > data.size() || length > data.size() - offset)
        file.fail(name + ": its compressed data exceeds its buffer of " + to_string(data.size()) + " bytes");
    return {reinterpret_cast<const char*>(data.data()) + offset, length};
}

/// The sizes that the extension allows. The codecs pack no tighter than 1024 to 1, so that a few broken bytes can't ask
/// for gigabytes.
void check(const GltfFile& file, const Packed& packed, const std::string& name) {
    const std::size_t stride = packed.stride;
    const bool attributes = packed.mode == "ATTRIBUTES", triangles = packed.mode == "TRIANGLES";
    if (!attributes && !triangles && packed.mode != "INDICES")
        file.fail(name + ": its compression has the unknown mode '" + packed.mode + "'");
    const bool known_filter = packed.filter == "NONE" || packed.filter == "OCTAHEDRAL" || packed.filter == "COLOR" ||
                              packed.filter == "QUATERNION" || packed.filter == "EXPONENTIAL";
    if (!known_filter || (!attributes && packed.filter != "NONE"))
        file.fail(name + ": its compression has the filter '" + packed.filter + "', which its mode does not support");
    const bool fits_mode = attributes ? stride >= 4 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
    const bool is_packed = packed.filter == "OCTAHEDRAL" || packed.filter == "COLOR";
    const bool fits_filter = is_packed                       ? stride == 4 || stride == 8
                             : packed.filter == "QUATERNION" ? stride == 8
                                                             : true;
    if (!fits_mode || !fits_filter)
        file.fail(name + ": its compressed elements have " + to_string(stride) + " bytes, which is not allowed");
    if (triangles && packed.count % 3 != 0)
        file.fail(name + ": " + to_string(packed.count) + " compressed indices do not form whole triangles");
    if (packed.count > (packed.bytes.size() + 1) * 1024)
        file.fail(name + ": its compressed data is cut off: " + to_string(packed.bytes.size()) + " bytes for " +
                  to_string(packed.count) + " elements");
}

/// Whether the library is too old for the codec's version 1 or the filter COLOR, which version 0.25 brought.
bool is_too_new(const Packed& packed) {
    constexpr unsigned char version_1 = 0xa1;
    const bool new_codec = packed.mode == "ATTRIBUTES" && !packed.bytes.empty() &&
                           static_cast<unsigned char>(packed.bytes[0]) == version_1;
    return MESHOPTIMIZER_VERSION < 250 && (new_codec || packed.filter == "COLOR");
}

bool has_bytes(const GltfFile& file, const tinygltf::BufferView& view) {
    return view.buffer >= 0 && std::size_t(view.buffer) < file.model.buffers.size() &&
           !file.model.buffers[std::size_t(view.buffer)].data.empty();
}

/// 0 where all went well.
int decode_meshopt(const Packed& packed, std::vector<unsigned char>& to) {
    const auto* from = reinterpret_cast<const unsigned char*>(packed.bytes.data());
    const std::size_t size = packed.bytes.size();
    if (packed.mode == "TRIANGLES")
        return meshopt_decodeIndexBuffer(to.data(), packed.count, packed.stride, from, size);
    if (packed.mode == "INDICES")
        return meshopt_decodeIndexSequence(to.data(), packed.count, packed.stride, from, size);
    const int fault = meshopt_decodeVertexBuffer(to.data(), packed.count, packed.stride, from, size);
    if (fault != 0) return fault;
    if (packed.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(to.data(), packed.count, packed.stride);
    if (packed.filter == "QUATERNION") meshopt_decodeFilterQuat(to.data(), packed.count, packed.stride);
#if MESHOPTIMIZER_VERSION >= 250
    if (packed.filter == "COLOR") meshopt_decodeFilterColor(to.data(), packed.count, packed.stride);
#endif
    if (packed.filter == "EXPONENTIAL") meshopt_decodeFilterExp(to.data(), packed.count, packed.stride);
    return 0;
}

}  // namespace

void decode_meshopt_view(GltfFile& file, tinygltf::BufferView& view, const char* name_of_extension,
                         const std::string& name) {
    const tinygltf::Value& extension = view.extensions.at(name_of_extension);
    if (!extension.IsObject()) return;
    const Packed packed{bytes_of(file, extension, name), count_in(file, extension, "byteStride", 0, name),
                        count_in(file, extension, "count", 0, name), text_in(extension, "mode", ""),
                        text_in(extension, "filter", "NONE")};
    check(file, packed, name);
    if (is_too_new(packed) && has_bytes(file, view)) return;  // the file has the same uncompressed
    if (is_too_new(packed))
        file.fail(name + " is compressed by version 1 of KHR_meshopt_compression, which needs meshoptimizer 0.25",
                  "build claray with it, or export with EXT_meshopt_compression");
    std::vector<unsigned char> decoded(packed.count * packed.stride);
    if (packed.count > 0 && decode_meshopt(packed, decoded) != 0) file.fail(name + ": its compressed data is damaged");
    view.buffer = int(file.model.buffers.size());
    view.byteOffset = 0;
    view.byteLength = decoded.size();
    file.model.buffers.emplace_back();
    file.model.buffers.back().data = std::move(decoded);
}

#else
void decode_meshopt_view(GltfFile&, tinygltf::BufferView&, const char*, const std::string&) {}
#endif
}  // namespace claray
