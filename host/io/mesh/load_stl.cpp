// STL, text and binary: triangles without shared vertices. Vertices at the same position become one.
#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/mesh/positions.hpp"
#include "host/io/obj/mtl.hpp"
#include "host/io/scene_readers.hpp"
#include "host/io/text_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

constexpr std::size_t stl_header_bytes = 84, facet_bytes = 50;  // of the binary format; it is little endian

struct PositionHash {
    std::size_t operator()(const glm::vec3& p) const {
        std::uint64_t hash = 0;
        for (int k = 0; k < 3; ++k)
            hash = (hash ^ std::bit_cast<std::uint32_t>(p[k] + 0.f)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
        return std::size_t(hash);
    }
};

class StlMesh {
public:
    explicit StlMesh(std::string name) { mesh_.name = std::move(name); }

    void add(const glm::vec3 (&corners)[3]) {
        glm::uvec3 triangle;
        for (int c = 0; c < 3; ++c) triangle[c] = vertex(corners[c]);  // in this order
        mesh_.triangles.push_back(triangle);
    }
    [[nodiscard]] bool empty() const { return mesh_.triangles.empty(); }
    [[nodiscard]] Mesh take() { return std::move(mesh_); }

private:
    std::uint32_t vertex(const glm::vec3& position) {
        const auto [found, is_new] = numbers_.try_emplace(position, std::uint32_t(mesh_.positions.size()));
        if (is_new) mesh_.positions.push_back(position);
        return found->second;
    }
    Mesh mesh_;
    std::unordered_map<glm::vec3, std::uint32_t, PositionHash> numbers_;  // NaN equals nothing and stays alone
};

template <class T>
T read_little(const char* bytes) {
    unsigned char raw[sizeof(T)];
    std::memcpy(raw, bytes, sizeof raw);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < sizeof(T); ++k) word |= std::uint32_t(raw[k]) << (8 * k);
    return std::bit_cast<T>(word);
}

std::uint64_t facets_of(std::string_view bytes) {
    return bytes.size() < stl_header_bytes ? 0 : read_little<std::uint32_t>(bytes.data() + 80);
}

/// Behind a byte order mark and blanks, in any case.
bool begins_with_solid(std::string_view bytes) {
    constexpr std::string_view mark = "\xef\xbb\xbf", solid = "solid";
    if (bytes.starts_with(mark)) bytes.remove_prefix(mark.size());
    bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
    const auto same = [](char a, char b) { return (a | 0x20) == b; };
    return bytes.size() >= solid.size() && std::equal(solid.begin(), solid.end(), bytes.begin(),
                                                      [&](char expected, char c) { return same(c, expected); });
}

/// Many binary files begin with "solid", too: the size tells.
bool is_binary(std::string_view bytes) {
    if (bytes.size() < stl_header_bytes) return false;
    const std::uint64_t needed = stl_header_bytes + facet_bytes * facets_of(bytes);
    return needed == bytes.size() || !begins_with_solid(bytes) ||
           bytes.substr(0, 512).find('\0') != std::string_view::npos;
}

Mesh read_binary(std::string_view bytes, const std::filesystem::path& path, const std::string& name) {
    const std::uint64_t count = facets_of(bytes);
    if (count > (bytes.size() - stl_header_bytes) / facet_bytes)
        throw Error(ErrorKind::user,
                    "'" + path.string() + "' is cut off: it has " + std::to_string(bytes.size()) + " bytes, and " +
                        std::to_string(count) + " triangles take " +
                        std::to_string(stl_header_bytes + facet_bytes * count),
                    "export the mesh again");
    StlMesh mesh(name);
    for (std::uint64_t i = 0; i < count; ++i) {
        const char* corner = bytes.data() + stl_header_bytes + facet_bytes * i + 12;  // behind the normal
        glm::vec3 corners[3];
        for (int c = 0; c < 3; ++c)
            for (int k = 0; k < 3; ++k) corners[c][k] = read_little<float>(corner + 12 * c + 4 * k);
        mesh.add(corners);
    }
    return mesh.take();
}

/// Words of the text format; keywords in any case.
class StlText {
public:
    StlText(std::string text, const std::filesystem::path& path) : text_(std::move(text)), path_(path) {}

    std::vector<Mesh> read(const std::string& fallback_name) {
        std::vector<Mesh> meshes;
        for (std::string word = next(); !word.empty(); word = next()) {
            if (word != "solid") refuse(claray::quoted(word) + " is not 'solid'");
            const std::string name = rest_of_line();
            Mesh mesh = read_solid(name.empty() ? fallback_name : name);
            if (!mesh.triangles.empty()) meshes.push_back(std::move(mesh));
        }
        return meshes;
    }

private:
    Mesh read_solid(const std::string& name) {
        StlMesh mesh(name);
        for (;;) {
            const std::string word = next();
            if (word == "endsolid") break;
            if (word != "facet")
                refuse(word.empty() ? "the file is cut off" : claray::quoted(word) + " is not 'facet'");
            skip_normal();
            expect("loop");
            glm::vec3 corners[3];
            for (glm::vec3& corner : corners) {
                expect("vertex");
                for (int k = 0; k < 3; ++k) corner[k] = number();
            }
            expect("endloop"), expect("endfacet");
            mesh.add(corners);
        }
        static_cast<void>(rest_of_line());
        return mesh.take();
    }

    /// Up to "outer". Triangles are flat, whatever some programs write: "-1.#IND" for those without area.
    void skip_normal() {
        constexpr int most = 4;  // words: "normal" and three numbers
        for (int i = 0; i < most; ++i)
            if (next() == "outer") return;
        expect("outer");
    }

    std::string next() {
        while (at_ < text_.size() && is_blank(text_[at_])) line_ += text_[at_++] == '\n';
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
        return lower_case(std::string_view(text_).substr(begin, at_ - begin));
    }
    std::string rest_of_line() {
        const std::size_t end = std::min(text_.find('\n', at_), text_.size());
        std::string_view rest = std::string_view(text_).substr(at_, end - at_);
        at_ = end;
        while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
        while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
        return std::string(rest);
    }
    void expect(const char* keyword) {
        const std::string word = next();
        if (word != keyword)
            refuse(word.empty() ? "the file is cut off" : claray::quoted(word) + " is not '" + keyword + "'");
    }
    float number() {
        const std::string word = next();
        if (word.empty()) refuse("the file is cut off");
        const std::optional<double> value = number_in(word);
        if (!value) refuse(claray::quoted(word) + " is not a number");
        return float(*value);
    }
    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }
    [[noreturn]] void refuse(const std::string& what) const {
        throw Error(ErrorKind::user, "'" + path_.string() + "' line " + std::to_string(line_) + ": " + what,
                    "export the mesh again");
    }

    std::string text_;
    const std::filesystem::path& path_;
    std::size_t at_ = 0, line_ = 1;
};

}  // namespace

Scene load_stl_without_light(const std::filesystem::path& path, Warnings& warnings, const LoadOptions&) {
    std::string bytes = read_file(path, "check the path");
    if (bytes.empty()) throw Error(ErrorKind::user, "'" + path.string() + "' is empty", "export the mesh again");
    Scene scene;
    scene.name = path.stem().string();
    if (is_binary(bytes)) {
        scene.meshes.push_back(read_binary(bytes, path, scene.name));
    } else {
        scene.meshes = StlText(text_of(std::move(bytes), path), path).read(scene.name);
    }
    if (scene.meshes.empty() || scene.meshes[0].triangles.empty())
        throw Error(ErrorKind::user, "'" + path.string() + "' contains no triangle", "export the mesh again");
    for (const Mesh& mesh : scene.meshes) warn_of_positions(mesh, path, warnings);
    scene.materials.push_back(grey_lambert(scene.name));
    return scene;
}

}  // namespace claray
