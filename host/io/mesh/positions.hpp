// What PLY and STL say of positions that no ray can meet.
#pragma once

#include "claray/io.hpp"

namespace claray {

[[nodiscard]] bool is_finite(const glm::vec3& position);

/// Warns if positions are not finite: NaN, infinite, or numbers beyond the range of float32. The tree's builder leaves
/// their triangles out.
void warn_of_positions(const Mesh& mesh, const std::filesystem::path& path, Warnings& warnings);

}  // namespace claray
