#include "host/io/image/ktx2_read.hpp"

#include <dlfcn.h>

#include <cstring>
#include <initializer_list>
#include <memory>

#include "host/base/process/environment.hpp"
#include "host/base/process/plugin.hpp"

namespace claray {
namespace {

constexpr std::string_view ktx2_mark = "\xabKTX 20\xbb\r\n\x1a\n";  // KTX 2.0, section 3.1
constexpr std::size_t ktx_header_bytes = 80;

/// Of ktx.h, version 4. Objects stay behind their pointers, so that nothing depends on their layout.
struct Ktx {
    int (*create)(const std::uint8_t* bytes, std::size_t size, std::uint32_t flags, void** texture) = nullptr;
    bool (*needs_transcoding)(void* texture) = nullptr;
    int (*transcode)(void* texture, int format, std::uint32_t flags) = nullptr;
    int (*offset)(void* texture, std::uint32_t level, std::uint32_t layer, std::uint32_t face,
                  std::size_t* offset) = nullptr;
    std::uint8_t* (*data)(void* texture) = nullptr;
    std::size_t (*size)(void* texture) = nullptr;
    void (*destroy)(void* texture) = nullptr;
};
constexpr std::uint32_t ktx_load_image_data = 1;
constexpr int ktx_rgba32 = 13;

bool find_all(Ktx& ktx, void* library) {
    return library != nullptr && find_function(library, "ktxTexture2_CreateFromMemory", ktx.create) &&
           find_function(library, "ktxTexture2_NeedsTranscoding", ktx.needs_transcoding) &&
           find_function(library, "ktxTexture2_TranscodeBasis", ktx.transcode) &&
           find_function(library, "ktxTexture2_GetImageOffset", ktx.offset) &&
           find_function(library, "ktxTexture_GetData", ktx.data) &&
           find_function(library, "ktxTexture_GetDataSize", ktx.size) &&
           find_function(library, "ktxTexture2_Destroy", ktx.destroy);
}

/// Null where there is none.
const Ktx* loaded_ktx() {
    static const std::unique_ptr<Ktx> ktx = []() -> std::unique_ptr<Ktx> {
        const std::string given = environment("CLARAY_KTX");
        for (const char* name : {given.c_str(), "libktx.so.4", "libktx.so", "libktx_read.so.4", "libktx_read.so"}) {
            auto found = std::make_unique<Ktx>();
            if (*name != '\0' && find_all(*found, ::dlopen(name, RTLD_NOW | RTLD_LOCAL))) return found;
        }
        return nullptr;
    }();
    return ktx.get();
}

std::uint32_t ktx_word(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | std::uint8_t(bytes[at + i]);
    return value;
}

}  // namespace

bool is_ktx2(std::string_view bytes) { return bytes.starts_with(ktx2_mark); }

bool can_read_ktx2() { return loaded_ktx() != nullptr; }

std::string read_ktx2_header(std::string_view bytes, ImageShape& shape) {
    if (!loaded_ktx()) return "it is KTX 2 (KHR_texture_basisu), and libktx is not installed (CLARAY_KTX may name it)";
    if (bytes.size() < ktx_header_bytes) return "it is cut off";
    shape.width = ktx_word(bytes, 20), shape.height = ktx_word(bytes, 24), shape.channels = 4;
    const bool is_volume = ktx_word(bytes, 28) != 0, is_array = ktx_word(bytes, 32) > 1,
               is_cube = ktx_word(bytes, 36) != 1;
    if (is_volume || is_array || is_cube) return "its KTX 2 holds more than one image";
    // ETC1S takes at least an index of a few bits for 16 texels, which may be packed further.
    shape.least_bytes = std::uint64_t(shape.width) * shape.height / 4096;
    return {};
}

std::string read_ktx2_pixels(std::string_view bytes, const ImageShape& shape, std::vector<std::uint8_t>& values) {
    const Ktx& ktx = *loaded_ktx();
    void* created = nullptr;
    if (ktx.create(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), ktx_load_image_data, &created) !=
        0)
        return "libktx cannot read it";
    const std::unique_ptr<void, void (*)(void*)> texture(created, ktx.destroy);
    if (!ktx.needs_transcoding(created)) return "its KTX 2 is not of Basis Universal";
    if (ktx.transcode(created, ktx_rgba32, 0) != 0) return "libktx cannot decode it";
    std::size_t offset = 0;
    const std::size_t size = std::size_t(shape.width) * shape.height * shape.channels;
    if (ktx.offset(created, 0, 0, 0, &offset) != 0 || ktx.size(created) < size || offset > ktx.size(created) - size)
        return "it is cut off";
    values.assign(ktx.data(created) + offset, ktx.data(created) + offset + size);
    return {};
}

}  // namespace claray
