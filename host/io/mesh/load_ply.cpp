// From the elements of a PLY to a scene of one mesh.
#include <cmath>
#include <optional>

#include "claray/error.hpp"
#include "host/base/file.hpp"
#include "host/io/default_light.hpp"
#include "host/io/image/color.hpp"
#include "host/io/mesh/ply_file.hpp"
#include "host/io/obj/mtl.hpp"
#include "host/io/obj/triangulate.hpp"

namespace claray {
namespace {

using Row = std::vector<double>;

/// Where a vertex has its values; -1: not in this file.
struct VertexColumns {
    int x, y, z, nx, ny, nz, u, v, red, green, blue, alpha;
    bool bytes = false;  // colours are 0..255, else 0..1

    explicit VertexColumns(const PlyElement& e)
        : x(e.find({"x"})),
          y(e.find({"y"})),
          z(e.find({"z"})),
          nx(e.find({"nx", "normal_x"})),
          ny(e.find({"ny", "normal_y"})),
          nz(e.find({"nz", "normal_z"})),
          u(e.find({"s", "u", "texture_u", "texture_s"})),
          v(e.find({"t", "v", "texture_v", "texture_t"})),
          red(e.find({"red", "r", "diffuse_red"})),
          green(e.find({"green", "g", "diffuse_green"})),
          blue(e.find({"blue", "b", "diffuse_blue"})),
          alpha(e.find({"alpha", "a"})) {
        bytes = red >= 0 && e.properties[std::size_t(red)].type < PlyType::float32;
        for (const int column : {x, y, z})
            if (column >= 0 && e.properties[std::size_t(column)].list) x = -1;
    }
    [[nodiscard]] bool has_positions() const { return x >= 0 && y >= 0 && z >= 0; }
    [[nodiscard]] bool has_normals() const { return nx >= 0 && ny >= 0 && nz >= 0; }
    [[nodiscard]] bool has_uvs() const { return u >= 0 && v >= 0; }
    [[nodiscard]] bool has_colors() const { return red >= 0 && green >= 0 && blue >= 0; }
};

glm::vec3 vector_of(const Row& row, int x, int y, int z) {
    return {float(row[std::size_t(x)]), float(row[std::size_t(y)]), float(row[std::size_t(z)])};
}

glm::vec4 color_of(const Row& row, const VertexColumns& c) {
    const double scale = c.bytes ? 1 / 255.0 : 1;
    const auto channel = [&](int column) {
        const double value = scale * row[std::size_t(column)];
        return value >= 0 ? std::min(value, 1.0) : 0;  // NaN too
    };
    return {linear_from_display({channel(c.red), channel(c.green), channel(c.blue)}),
            c.alpha >= 0 ? float(channel(c.alpha)) : 1.f};
}

/// A PLY in the making.
class PlyMesh {
public:
    PlyMesh(PlyReader& reader, Mesh& mesh) : reader_(reader), mesh_(mesh) {}

    void read_vertices(const PlyElement& element) {
        const VertexColumns columns(element);
        if (!columns.has_positions()) reader_.refuse("the vertices lack x, y or z", "export the mesh again");
        for (std::uint64_t i = 0; i < element.count; ++i) {
            reader_.read_row(element, row_, lists_);
            mesh_.positions.push_back(vector_of(row_, columns.x, columns.y, columns.z));
            if (columns.has_normals()) add_normal(vector_of(row_, columns.nx, columns.ny, columns.nz));
            if (columns.has_uvs()) add_uv(row_[std::size_t(columns.u)], row_[std::size_t(columns.v)]);
            if (columns.has_colors()) mesh_.colors.push_back(color_of(row_, columns));
        }
    }

    void read_faces(const PlyElement& element) {
        const int indices = element.find({"vertex_indices", "vertex_index"});
        if (indices < 0 || !element.properties[std::size_t(indices)].list)
            reader_.refuse("the faces have no list vertex_indices", "export the mesh again");
        for (std::uint64_t i = 0; i < element.count; ++i) {
            reader_.read_row(element, row_, lists_);
            add_polygon(lists_[std::size_t(indices)]);
        }
    }

    /// Strips in one list, each ended by -1, as Stanford's scans have them.
    void read_strips(const PlyElement& element) {
        const int indices = element.find({"vertex_indices", "vertex_index"});
        if (indices < 0) reader_.refuse("the strips have no list vertex_indices", "export the mesh again");
        for (std::uint64_t i = 0; i < element.count; ++i) {
            reader_.read_row(element, row_, lists_);
            std::size_t begin = 0;
            const Row& strip = lists_[std::size_t(indices)];
            for (std::size_t k = 0; k < strip.size(); ++k) {
                if (strip[k] == -1)
                    begin = k + 1;
                else if (k >= begin + 2)
                    (k - begin) % 2 == 0 ? add_triangle(strip[k - 2], strip[k - 1], strip[k])
                                         : add_triangle(strip[k - 1], strip[k - 2], strip[k]);
            }
        }
    }

    void skip(const PlyElement& element) {
        for (std::uint64_t i = 0; i < element.count; ++i) reader_.read_row(element, row_, lists_);
    }

    /// Faces with fewer than three vertices.
    [[nodiscard]] std::size_t left_out() const { return left_out_; }

private:
    void add_normal(const glm::vec3& n) {
        const float length = glm::length(n);
        mesh_.normals.push_back(std::isfinite(length) && length > 1e-12f ? n / length : glm::vec3(0.f, 1.f, 0.f));
    }
    void add_uv(double u, double v) {  // claray counts v from the top
        mesh_.uvs.push_back(std::isfinite(float(u)) && std::isfinite(float(v)) ? glm::vec2(float(u), 1.f - float(v))
                                                                               : glm::vec2(0.f));
    }
    [[nodiscard]] std::uint32_t index_of(double index) const {
        if (!(index >= 0 && index < double(mesh_.positions.size())) || index != std::floor(index))
            reader_.refuse(
                "vertex index " +
                    std::to_string(std::int64_t(std::isfinite(index) ? glm::clamp(index, -1e15, 1e15) : -1)) +
                    " is out of range, there are " + std::to_string(mesh_.positions.size()) + " vertices before it",
                "export the mesh again");
        return std::uint32_t(index);
    }
    void add_triangle(double a, double b, double c) {
        mesh_.triangles.emplace_back(index_of(a), index_of(b), index_of(c));
    }
    void add_polygon(const Row& polygon) {
        if (polygon.size() < 3) {
            ++left_out_;
            return;
        }
        if (polygon.size() == 3) return add_triangle(polygon[0], polygon[1], polygon[2]);
        points_.clear(), pieces_.clear();
        for (const double index : polygon) points_.push_back(mesh_.positions[index_of(index)]);
        triangulate(points_, pieces_);
        for (const glm::uvec3& p : pieces_) add_triangle(polygon[p.x], polygon[p.y], polygon[p.z]);
    }

    PlyReader& reader_;
    Mesh& mesh_;
    Row row_;
    std::vector<Row> lists_;
    std::vector<glm::vec3> points_;
    std::vector<glm::uvec3> pieces_;
    std::size_t left_out_ = 0;
};

}  // namespace

Scene load_ply_without_light(const std::filesystem::path& path, Warnings& warnings) {
    const std::string bytes = read_file(path, "check the path");
    if (bytes.empty()) throw Error(ErrorKind::user, "'" + path.string() + "' is empty", "export the mesh again");
    PlyReader reader(bytes, path);
    Scene scene;
    scene.name = path.stem().string();
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.name = scene.name;
    PlyMesh maker(reader, mesh);
    for (const PlyElement& element : reader.elements()) {
        if (element.name == "vertex")
            maker.read_vertices(element);
        else if (element.name == "face")
            maker.read_faces(element);
        else if (element.name == "tristrips")
            maker.read_strips(element);
        else
            maker.skip(element);
    }
    if (mesh.triangles.empty())
        throw Error(
            ErrorKind::user, "'" + path.string() + "' contains no face",
            mesh.positions.empty() ? "export the mesh again" : "claray renders no clouds of points: export a mesh");
    if (maker.left_out() != 0)
        warnings.push_back(std::to_string(maker.left_out()) + " faces with fewer than 3 vertices were left out");
    scene.materials.push_back(grey_lambert(scene.name));
    return scene;
}

}  // namespace claray
