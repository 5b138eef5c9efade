// Faces of a PLY with values of their own, and its colours.
#pragma once

#include <unordered_map>

#include "claray/scene.hpp"
#include "host/io/mesh/ply_file.hpp"

namespace claray {

/// Where the rows of an element have a colour, or a grey. Red, green and blue are as in the file until `scale`.
class PlyColors {
public:
    explicit PlyColors(const PlyElement& element);

    [[nodiscard]] bool any() const { return columns_[0] >= 0; }
    /// Alpha is 0..1, 1 if there is none.
    [[nodiscard]] glm::vec4 of(const std::vector<double>& row);
    /// Turns such colours, encoded as sRGB, into linear ones of 0..1: by the range of their type, or by 255 where the
    /// largest value tells that they were bytes once.
    void scale(std::vector<glm::vec4>& colors) const;

private:
    int columns_[4] = {-1, -1, -1, -1};
    double range_ = 1, alpha_range_ = 1;  ///< of the types
    double largest_ = 0;                  ///< of red, green and blue
};

/// The vertices of faces that have coordinates or colours of their own. Corners that agree in all share a vertex.
class PlyCorners {
public:
    /// What a face says of one of its corners.
    struct Corner {
        std::uint32_t vertex = 0;
        glm::vec2 uv{0.f};
        glm::vec4 color{1.f};
        bool operator==(const Corner&) const = default;
    };

    PlyCorners(Mesh vertices, bool has_uvs, bool has_colors);

    /// Its number in the mesh.
    [[nodiscard]] std::uint32_t number(const Corner& corner);
    void scale_colors(const PlyColors& colors) { colors.scale(mesh_.colors); }
    [[nodiscard]] Mesh take() { return std::move(mesh_); }

private:
    struct Hash {
        std::size_t operator()(const Corner& corner) const;
    };
    Mesh vertices_, mesh_;
    bool has_uvs_, has_colors_;
    std::unordered_map<Corner, std::uint32_t, Hash> numbers_;
};

}  // namespace claray
