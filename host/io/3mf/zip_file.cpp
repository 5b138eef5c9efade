#include "host/io/3mf/zip_file.hpp"

#include <zlib.h>

#include <algorithm>

#include "claray/error.hpp"
#include "host/io/little_endian.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

constexpr std::size_t zip_end_bytes = 22, zip_entry_bytes = 46, part_header_bytes = 30;

std::string plain_name(std::string_view name) {
    while (name.starts_with('/')) name.remove_prefix(1);
    return lower_case(name);
}

}  // namespace

ZipFile::ZipFile(std::string_view bytes, std::filesystem::path path) : bytes_(bytes), path_(std::move(path)) {
    const std::size_t end = bytes.rfind("PK\5\6");
    if (end == bytes.npos || bytes.size() - end < zip_end_bytes) refuse("it is no zip archive, or it is cut off");
    read_directory(end);
}

void ZipFile::refuse(const std::string& what) const {
    throw Error(ErrorKind::user, "'" + path_.string() + "': " + what, "export it again");
}

std::size_t ZipFile::word(std::size_t at, std::size_t bytes) const {
    if (at > bytes_.size() || bytes > bytes_.size() - at) refuse("its directory leaves the archive");
    return little_endian(bytes_, at, unsigned(bytes));
}

void ZipFile::read_directory(std::size_t end) {
    const std::size_t count = word(end + 10, 2);
    std::size_t at = word(end + 16, 4);
    for (std::size_t i = 0; i < count; ++i) {
        if (word(at, 4) != 0x02014b50) refuse("its directory is damaged");
        if ((word(at + 8, 2) & 1) != 0) refuse("it is encrypted");
        Part part{.name = {},
                  .method = std::uint32_t(word(at + 10, 2)),
                  .packed = word(at + 20, 4),
                  .size = word(at + 24, 4),
                  .header = word(at + 42, 4)};
        const std::size_t name = word(at + 28, 2), extra = word(at + 30, 2), comment = word(at + 32, 2);
        if (name + extra > bytes_.size() - at - zip_entry_bytes) refuse("its directory is cut off");
        part.name = plain_name(bytes_.substr(at + zip_entry_bytes, name));
        read_large_sizes(part, at + zip_entry_bytes + name, at + zip_entry_bytes + name + extra);
        parts_.push_back(std::move(part));
        at += zip_entry_bytes + name + extra + comment;
    }
}

/// Sizes of 64 bits stand in a field of their own, those that 32 bits cannot hold (section 4.5.3); some programs always
/// write them.
void ZipFile::read_large_sizes(Part& part, std::size_t begin, std::size_t end) const {
    constexpr std::size_t elsewhere = 0xffffffff;
    while (begin + 4 <= end) {
        const std::size_t kind = word(begin, 2), size = word(begin + 2, 2);
        std::size_t at = begin + 4;
        for (std::size_t* value : {&part.size, &part.packed, &part.header}) {
            if (kind != 1 || *value != elsewhere) continue;
            *value = word(at, 8);
            at += 8;
        }
        begin += 4 + size;
    }
}

std::string_view ZipFile::packed_bytes(const Part& part) const {
    if (word(part.header, 4) != 0x04034b50) refuse("its part " + claray::quoted(part.name) + " is damaged");
    const std::size_t begin = part.header + part_header_bytes + word(part.header + 26, 2) + word(part.header + 28, 2);
    if (begin > bytes_.size() || part.packed > bytes_.size() - begin)
        refuse("its part " + claray::quoted(part.name) + " is cut off");
    return bytes_.substr(begin, part.packed);
}

std::optional<std::string> ZipFile::read(std::string_view name) const {
    const std::string plain = plain_name(name);
    const auto part = std::find_if(parts_.begin(), parts_.end(), [&](const Part& each) { return each.name == plain; });
    if (part == parts_.end()) return {};
    const std::string_view packed = packed_bytes(*part);
    if (part->method == 0) return std::string(packed);
    if (part->method != Z_DEFLATED) refuse("its part " + claray::quoted(plain) + " is compressed in an unknown way");
    return inflated(packed, part->size, plain);
}

std::string ZipFile::inflated(std::string_view packed, std::size_t size, const std::string& name) const {
    constexpr std::size_t most = 1032;  // times as many bytes as before
    if (size / most > packed.size() || size > 0xffffffff) refuse("its part " + claray::quoted(name) + " is damaged");
    std::string content(size, '\0');
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) refuse("there is not enough memory");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = uInt(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(content.data());
    stream.avail_out = uInt(size);
    const int status = inflate(&stream, Z_FINISH);
    const bool whole = status == Z_STREAM_END && stream.avail_out == 0;
    inflateEnd(&stream);
    if (!whole) refuse("its part " + claray::quoted(name) + " is damaged");
    return content;
}

}  // namespace claray
