#include "host/io/mesh/ply_faces.hpp"

#include <algorithm>
#include <bit>

#include "host/io/image/color.hpp"

namespace claray {
namespace {

bool is_real(PlyType type) { return type >= PlyType::float32; }

double range_of(PlyType type) {
    return is_real(type) ? 1 : type == PlyType::int8 || type == PlyType::uint8 ? 255 : 65535;
}

double within_0_1(double value) { return value >= 0 ? std::min(value, 1.0) : 0; }  // NaN too

}  // namespace

PlyColors::PlyColors(const PlyElement& e) {
    const int color[] = {e.find({"red", "r", "diffuse_red"}), e.find({"green", "g", "diffuse_green"}),
                         e.find({"blue", "b", "diffuse_blue"}), e.find({"alpha", "a", "opacity"})};
    const auto type_of = [&](int column) { return e.properties[std::size_t(column)].type; };
    if (color[0] >= 0 && color[1] >= 0 && color[2] >= 0) {
        std::copy(std::begin(color), std::end(color), columns_);
    } else {
        int grey = e.find({"gray", "grey", "luminance"});
        const int intensity = e.find({"intensity", "scalar_intensity"});  // of scanners, if it is real
        if (grey < 0 && intensity >= 0 && !is_real(type_of(intensity))) grey = intensity;
        std::fill_n(columns_, 3, grey);
    }
    if (!any()) return;
    range_ = range_of(type_of(columns_[0]));
    if (columns_[3] >= 0) alpha_range_ = range_of(type_of(columns_[3]));
}

glm::vec4 PlyColors::of(const std::vector<double>& row) {
    glm::vec4 color(1.f);
    for (int k = 0; k < 3; ++k) {
        color[k] = float(row[std::size_t(columns_[k])]);
        if (double(color[k]) > largest_) largest_ = double(color[k]);
    }
    if (columns_[3] >= 0) color.w = float(within_0_1(row[std::size_t(columns_[3])] / alpha_range_));
    return color;
}

void PlyColors::scale(std::vector<glm::vec4>& colors) const {
    constexpr double beyond_white = 10;  // of real numbers
    const bool is_bytes = range_ > 255 ? largest_ <= 255 : range_ == 1 && largest_ > beyond_white;
    const double range = is_bytes ? 255 : range_;
    for (glm::vec4& color : colors) {
        const glm::dvec3 display(within_0_1(double(color.x) / range), within_0_1(double(color.y) / range),
                                 within_0_1(double(color.z) / range));
        color = glm::vec4(linear_from_display(display), color.w);
    }
}

std::size_t PlyCorners::Hash::operator()(const Corner& c) const {
    std::uint64_t hash = c.vertex;
    for (const float value : {c.uv.x, c.uv.y, c.color.x, c.color.y, c.color.z, c.color.w})
        hash = (hash ^ std::bit_cast<std::uint32_t>(value + 0.f)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return std::size_t(hash);
}

PlyCorners::PlyCorners(Mesh vertices, bool has_uvs, bool has_colors)
    : vertices_(std::move(vertices)), has_uvs_(has_uvs), has_colors_(has_colors) {
    mesh_.name = vertices_.name;
}

std::uint32_t PlyCorners::number(const Corner& corner) {
    const auto [found, is_new] = numbers_.try_emplace(corner, std::uint32_t(mesh_.positions.size()));
    if (!is_new) return found->second;
    const std::size_t i = corner.vertex;
    mesh_.positions.push_back(vertices_.positions[i]);
    if (!vertices_.normals.empty()) mesh_.normals.push_back(vertices_.normals[i]);
    if (has_uvs_ || !vertices_.uvs.empty()) mesh_.uvs.push_back(has_uvs_ ? corner.uv : vertices_.uvs[i]);
    if (has_colors_ || !vertices_.colors.empty())
        mesh_.colors.push_back(has_colors_ ? corner.color : vertices_.colors[i]);
    return found->second;
}

}  // namespace claray
