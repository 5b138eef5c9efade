// A Wavefront OBJ as it was written: arrays and polygons, indices checked, nothing joined yet.
#pragma once

#include <tiny_obj_loader.h>

#include "claray/io.hpp"

namespace claray {

/// One corner of a polygon: indices from 0 into the arrays of the file; -1 where the file gives none.
struct ObjCorner {
    int position = -1, uv = -1, normal = -1;
    bool operator==(const ObjCorner&) const = default;
};

struct ObjPolygon {
    std::size_t first_corner = 0;
    std::uint32_t corners = 0;   ///< 3 or more
    std::uint32_t group = 0;     ///< index into ObjFile::groups
    std::uint32_t material = 0;  ///< index into ObjFile::material_names
};

/// A segment of an 'l', or a point of a 'p', whose ends are one.
struct ObjStroke {
    int a = 0, b = 0;            ///< indices into ObjFile::positions
    std::uint32_t material = 0;  ///< index into ObjFile::material_names
};

struct ObjFile {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<glm::vec3> colors;  ///< of the positions, linear, 0..1; empty where none has one
    std::vector<ObjCorner> corners;
    std::vector<ObjPolygon> polygons;
    std::vector<ObjStroke> strokes;
    std::vector<std::string> groups;                 ///< by object and group name; the first is unnamed
    std::vector<std::string> material_names;         ///< as `usemtl` names them; the first is unnamed
    std::vector<tinyobj::material_t> mtl_materials;  ///< what the MTL files define
    std::vector<std::filesystem::path> mtl_folders;  ///< of each, that of its file
    std::size_t degenerate_faces = 0;                ///< faces of fewer than 3 corners, left out
    bool lacks_mtl = false;                          ///< an MTL is missing, or none is named: the user is told
};

/// Reads an OBJ and the MTLs that it names. Throws what load_obj throws.
[[nodiscard]] ObjFile read_obj(const std::filesystem::path& path, Warnings& warnings);

}  // namespace claray
