#include "host/io/mesh/ply_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "host/io/mesh/positions.hpp"
#include "host/io/obj/triangulate.hpp"

namespace claray {
namespace {

using std::to_string;
using Row = std::vector<double>;

/// Where a vertex has its values; -1: not in this file.
struct VertexColumns {
    int x, y, z, nx, ny, nz, u, v;

    explicit VertexColumns(const PlyElement& e)
        : x(e.find({"x"})),
          y(e.find({"y"})),
          z(e.find({"z"})),
          nx(e.find({"nx", "normal_x"})),
          ny(e.find({"ny", "normal_y"})),
          nz(e.find({"nz", "normal_z"})),
          u(e.find({"s", "u", "texture_u", "texture_s"})),
          v(e.find({"t", "v", "texture_v", "texture_t"})) {
        for (const int column : {x, y, z})
            if (column >= 0 && e.properties[std::size_t(column)].list) x = -1;
    }
    [[nodiscard]] bool has_positions() const { return x >= 0 && y >= 0 && z >= 0; }
    [[nodiscard]] bool has_normals() const { return nx >= 0 && ny >= 0 && nz >= 0; }
    [[nodiscard]] bool has_uvs() const { return u >= 0 && v >= 0; }
};

double at(const Row& row, int column) { return row[std::size_t(column)]; }

glm::vec3 vector_of(const Row& row, int x, int y, int z) {
    return {float(at(row, x)), float(at(row, y)), float(at(row, z))};
}

glm::vec3 normal_of(const glm::vec3& n) {
    const float length = glm::length(n);
    return std::isfinite(length) && length > 1e-12f ? n / length : glm::vec3(0.f, 1.f, 0.f);
}

/// claray counts v from the top.
glm::vec2 uv_of(double u, double v) {
    return std::isfinite(float(u)) && std::isfinite(float(v)) ? glm::vec2(float(u), 1.f - float(v)) : glm::vec2(0.f);
}

/// A list of the element, or -1.
int list_of(const PlyElement& element, std::initializer_list<std::string_view> names) {
    const int found = element.find(names);
    return found >= 0 && element.properties[std::size_t(found)].list ? found : -1;
}

}  // namespace

void PlyMesh::read_vertices(const PlyElement& element) {
    const VertexColumns columns(element);
    if (!columns.has_positions()) reader_->refuse("the vertices lack x, y or z", "export the mesh again");
    if (element.find({"f_dc_0"}) >= 0)
        reader_->refuse("these are Gaussian splats, which claray does not render",
                        "export a mesh from the program that made them");
    PlyColors colors(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        reader_->read_row(element, row_, lists_);
        mesh_.positions.push_back(vector_of(row_, columns.x, columns.y, columns.z));
        if (columns.has_normals())
            mesh_.normals.push_back(normal_of(vector_of(row_, columns.nx, columns.ny, columns.nz)));
        if (columns.has_uvs()) mesh_.uvs.push_back(uv_of(at(row_, columns.u), at(row_, columns.v)));
        if (colors.any()) mesh_.colors.push_back(colors.of(row_));
    }
    colors.scale(mesh_.colors);
}

void PlyMesh::split(bool has_uvs, bool has_colors) {
    if (corners_ || !(has_uvs || has_colors)) return;
    Mesh vertices = mesh_;
    vertices.triangles.clear(), vertices.materials.clear();
    corners_.emplace(std::move(vertices), has_uvs, has_colors);
}

void PlyMesh::read_faces(const PlyElement& element) {
    const int indices = list_of(element, {"vertex_indices", "vertex_index"}), uvs = list_of(element, {"texcoord"}),
              image = element.find({"texnumber"});
    if (indices < 0) reader_->refuse("the faces have no list vertex_indices", "export the mesh again");
    PlyColors colors(element);
    split(uvs >= 0, colors.any());
    for (std::uint64_t i = 0; i < element.count; ++i) {
        const std::size_t long_lines = reader_->long_lines().count;
        reader_->read_row(element, row_, lists_);
        if (uvs >= 0) face_.uvs = &lists_[std::size_t(uvs)];
        // Some versions of MeshLab write other colours than their header states.
        const bool is_long = reader_->long_lines().count > long_lines;
        if (colors.any()) face_.color = is_long ? glm::vec4(glm::vec3(INFINITY), 1.f) : colors.of(row_);
        const double last = double(reader_->images().size()) - 1;
        if (image >= 0 && last > 0) face_.image = std::uint32_t(std::clamp(at(row_, image), 0.0, last));
        add_polygon(lists_[std::size_t(indices)]);
    }
    face_ = {};
    if (colors.any()) corners_->scale_colors(colors);
}

void PlyMesh::read_strips(const PlyElement& element) {
    const int indices = list_of(element, {"vertex_indices", "vertex_index"});
    if (indices < 0) reader_->refuse("the strips have no list vertex_indices", "export the mesh again");
    for (std::uint64_t i = 0; i < element.count; ++i) {
        reader_->read_row(element, row_, lists_);
        std::size_t begin = 0;
        const Row& strip = lists_[std::size_t(indices)];
        for (std::size_t k = 0; k < strip.size(); ++k) {
            if (strip[k] == -1) {
                begin = k + 1;
            } else if (k >= begin + 2) {
                const std::size_t odd = (k - begin) % 2;
                add_triangle(vertex(strip[k - 2 + odd], 0), vertex(strip[k - 1 - odd], 0), vertex(strip[k], 0));
            }
        }
    }
}

void PlyMesh::read_edges(const PlyElement& element) {
    const int a = element.find({"vertex1"}), b = element.find({"vertex2"});
    if (a < 0 || b < 0) return skip(element);
    for (std::uint64_t i = 0; i < element.count; ++i) {
        reader_->read_row(element, row_, lists_);
        const std::uint32_t end = index_of(at(row_, b));
        edges_.emplace_back(index_of(at(row_, a)), end, end);
    }
}

void PlyMesh::skip(const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count; ++i) reader_->read_row(element, row_, lists_);
}

std::uint32_t PlyMesh::index_of(double index) const {
    if (!(index >= 0 && index < double(mesh_.positions.size())) || index != std::floor(index))
        reader_->refuse("vertex index " +
                            to_string(std::int64_t(std::isfinite(index) ? glm::clamp(index, -1e15, 1e15) : -1)) +
                            " is out of range, there are " + to_string(mesh_.positions.size()) + " vertices",
                        "export the mesh again");
    return std::uint32_t(index);
}

std::uint32_t PlyMesh::vertex(double index, std::size_t corner) {
    const std::uint32_t i = index_of(index);
    if (!corners_) return i;
    const bool has_uv = face_.uvs != nullptr && face_.uvs->size() > 2 * corner + 1;
    const glm::vec2 uv = has_uv ? uv_of((*face_.uvs)[2 * corner], (*face_.uvs)[2 * corner + 1]) : glm::vec2(0.f);
    return corners_->number({i, uv, face_.color});
}

void PlyMesh::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.triangles.emplace_back(a, b, c);
    has_faces_ = true;
    if (reader_->images().size() > 1) mesh_.materials.push_back(face_.image);
}

void PlyMesh::add_polygon(const Row& polygon) {
    if (polygon.size() < 3) {
        ++left_out_;
        return;
    }
    points_.clear(), pieces_.clear(), numbers_.clear();
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        numbers_.push_back(vertex(polygon[k], k));
        points_.push_back(mesh_.positions[std::uint32_t(polygon[k])]);
    }
    triangulate(points_, pieces_);
    for (const glm::uvec3& p : pieces_) add_triangle(numbers_[p.x], numbers_[p.y], numbers_[p.z]);
}

Mesh PlyMesh::take() {
    Mesh& mesh = mesh_;
    if (corners_) {
        Mesh split = corners_->take();
        split.triangles = std::move(mesh.triangles), split.materials = std::move(mesh.materials);
        mesh = std::move(split);
    }
    if (has_faces_) return std::move(mesh);
    const auto add = [&](const glm::uvec3& stroke) {
        if (is_finite(mesh.positions[stroke.x]) && is_finite(mesh.positions[stroke.y]))
            mesh.triangles.push_back(stroke);
    };
    for (const glm::uvec3& edge : edges_) add(edge);
    for (std::uint32_t i = 0; edges_.empty() && i < mesh.positions.size(); ++i) add({i, i, i});
    return std::move(mesh);
}

}  // namespace claray
