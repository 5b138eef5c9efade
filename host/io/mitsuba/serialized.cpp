#include "host/io/mitsuba/serialized.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string_view>

#include "claray/error.hpp"
#include "host/base/file.hpp"

namespace claray {
namespace {

constexpr std::uint16_t magic = 0x041c;
constexpr std::uint32_t with_normals = 1, with_coordinates = 2, with_colors = 8, in_doubles = 0x2000;
constexpr std::size_t most_inflated = 1100;  // DEFLATE makes at most 1032 bytes of one

class SerializedFile {
public:
    explicit SerializedFile(const std::filesystem::path& path)
        : path_(path), bytes_(read_file(path, "check the path")) {}

    [[noreturn]] void refuse(const std::string& what) const {
        throw Error(ErrorKind::user, "'" + path_.string() + "' " + what, "export the mesh again");
    }

    template <class T>
    [[nodiscard]] T at(std::size_t offset) const {
        static_assert(std::endian::native == std::endian::little);
        if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) refuse("is truncated");
        T value;
        std::memcpy(&value, bytes_.data() + offset, sizeof(T));
        return value;
    }

    /// Where the mesh begins; the dictionary at the end tells.
    [[nodiscard]] std::size_t place_of(std::size_t index) const {
        if (at<std::uint16_t>(0) != magic) refuse("is no serialized mesh of Mitsuba");
        const std::uint16_t version = at<std::uint16_t>(2);
        if (version != 3 && version != 4)
            refuse("has version " + std::to_string(version) + ", and claray reads 3 and 4");
        if (index == 0) return 0;
        const std::size_t count = bytes_.size() < 4 ? 0 : at<std::uint32_t>(bytes_.size() - 4);
        if (index >= count) refuse("has " + std::to_string(count) + " meshes, and not number " + std::to_string(index));
        const std::size_t entry = version == 4 ? 8 : 4, from_end = entry * (count - index) + 4;
        if (from_end > bytes_.size()) refuse("is truncated");
        const std::size_t place = bytes_.size() - from_end;
        return version == 4 ? std::size_t(at<std::uint64_t>(place)) : at<std::uint32_t>(place);
    }

    [[nodiscard]] std::string_view from(std::size_t offset) const {
        if (offset > bytes_.size()) refuse("is truncated");
        return std::string_view(bytes_).substr(offset);
    }

private:
    std::filesystem::path path_;
    std::string bytes_;
};

/// Reads what zlib has compressed, piece by piece.
class Inflated {
public:
    Inflated(const SerializedFile& file, std::string_view bytes)
        : file_(file), most_(bytes.size() * most_inflated + 4096) {
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
        stream_.avail_in = uInt(std::min<std::size_t>(bytes.size(), 0xffffffffu));
        if (inflateInit(&stream_) != Z_OK) file_.refuse("cannot be decompressed");
    }
    Inflated(const Inflated&) = delete;
    Inflated& operator=(const Inflated&) = delete;
    ~Inflated() { inflateEnd(&stream_); }

    template <class T>
    [[nodiscard]] std::vector<T> read(std::size_t count) {
        if (count > most_ / sizeof(T)) file_.refuse("is truncated");
        std::vector<T> values(count);
        std::size_t left = count * sizeof(T);
        auto* next = reinterpret_cast<Bytef*>(values.data());
        while (left > 0) {
            const auto piece = uInt(std::min<std::size_t>(left, 1u << 30));
            stream_.next_out = next, stream_.avail_out = piece;
            const int status = inflate(&stream_, Z_SYNC_FLUSH);
            const std::size_t got = piece - stream_.avail_out;
            next += got, left -= got;
            if ((status != Z_OK && status != Z_STREAM_END) || (got == 0 && left > 0)) file_.refuse("is damaged");
        }
        return values;
    }
    template <class T>
    [[nodiscard]] T one() {
        return read<T>(1)[0];
    }
    [[nodiscard]] std::vector<float> reals(std::size_t count, bool doubles) {
        if (!doubles) return read<float>(count);
        const std::vector<double> values = read<double>(count);
        return {values.begin(), values.end()};
    }

private:
    const SerializedFile& file_;
    std::size_t most_;
    z_stream stream_{};
};

template <class Vector>
std::vector<Vector> vectors_of(const std::vector<float>& values) {
    std::vector<Vector> result(values.size() / Vector::length());
    for (std::size_t i = 0; i < values.size(); ++i) result[i / Vector::length()][int(i % Vector::length())] = values[i];
    return result;
}

}  // namespace

Mesh load_serialized(const std::filesystem::path& path, std::size_t index) {
    const SerializedFile file(path);
    const std::size_t place = file.place_of(index);
    const std::uint16_t version = file.at<std::uint16_t>(2);
    if (file.at<std::uint16_t>(place) != magic) file.refuse("has no mesh where its dictionary says");
    Inflated data(file, file.from(place + 4));
    const auto flags = data.one<std::uint32_t>();
    Mesh mesh;
    if (version == 4)
        for (char c = data.one<char>(); c != 0; c = data.one<char>()) mesh.name += c;
    const auto vertices = data.one<std::uint64_t>(), faces = data.one<std::uint64_t>();
    if (vertices > 0xfffffffeu || faces > 0x55555555u) file.refuse("has more vertices or faces than claray can number");
    const bool doubles = (flags & in_doubles) != 0;
    mesh.positions = vectors_of<glm::vec3>(data.reals(3 * vertices, doubles));
    if (flags & with_normals) mesh.normals = vectors_of<glm::vec3>(data.reals(3 * vertices, doubles));
    if (flags & with_coordinates) mesh.uvs = vectors_of<glm::vec2>(data.reals(2 * vertices, doubles));
    if (flags & with_colors) (void)data.reals(3 * vertices, doubles);
    const std::vector<std::uint32_t> indices = data.read<std::uint32_t>(3 * faces);
    mesh.triangles.reserve(faces);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        if (std::max({indices[i], indices[i + 1], indices[i + 2]}) >= vertices)
            file.refuse("names vertices that it does not have");
        mesh.triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
    }
    return mesh;
}

}  // namespace claray
