// A PLY's elements as a mesh, or as points and lines.
#pragma once

#include <optional>

#include "host/io/mesh/ply_faces.hpp"

namespace claray {

/// A PLY in the making. Vertices are read first.
class PlyMesh {
public:
    PlyMesh(PlyReader& reader, std::string name) : reader_(&reader) { mesh_.name = std::move(name); }

    /// Goes on with another reader of the same file.
    void read_by(PlyReader& reader) { reader_ = &reader; }

    void read_vertices(const PlyElement& element);
    void read_faces(const PlyElement& element);
    /// Strips in one list, each ended by -1, as Stanford's scans have them.
    void read_strips(const PlyElement& element);
    void read_edges(const PlyElement& element);
    void skip(const PlyElement& element);

    /// Faces with fewer than three vertices.
    [[nodiscard]] std::size_t left_out() const { return left_out_; }
    [[nodiscard]] bool has_faces() const { return has_faces_; }
    /// Without faces, its edges or else its vertices as strokes (host/io/strokes.hpp), those that are finite.
    [[nodiscard]] Mesh take();

private:
    void split(bool has_uvs, bool has_colors);
    [[nodiscard]] std::uint32_t index_of(double index) const;
    /// The vertex of a corner of the current face.
    [[nodiscard]] std::uint32_t vertex(double index, std::size_t corner);
    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    void add_polygon(const std::vector<double>& polygon);

    PlyReader* reader_;
    Mesh mesh_;
    std::vector<glm::uvec3> edges_;
    std::optional<PlyCorners> corners_;  ///< if faces have coordinates or colours of their own
    std::size_t left_out_ = 0;
    bool has_faces_ = false;

    struct Face {
        const std::vector<double>* uvs = nullptr;  ///< two for each corner
        glm::vec4 color{1.f};
        std::uint32_t image = 0;
    } face_;  ///< the current one
    std::vector<double> row_;
    std::vector<std::vector<double>> lists_;
    std::vector<glm::vec3> points_;
    std::vector<glm::uvec3> pieces_;
    std::vector<std::uint32_t> numbers_;
};

}  // namespace claray
