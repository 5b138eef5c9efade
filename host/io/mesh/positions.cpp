#include "host/io/mesh/positions.hpp"

#include <algorithm>
#include <cmath>

namespace claray {

bool is_finite(const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void warn_of_positions(const Mesh& mesh, const std::filesystem::path& path, Warnings& warnings) {
    const auto count =
        std::count_if(mesh.positions.begin(), mesh.positions.end(), [](const glm::vec3& p) { return !is_finite(p); });
    if (count > 0)
        warnings.push_back("'" + path.string() + "': " + std::to_string(count) +
                           " vertices are not finite or exceed float32: what they belong to is left out");
}

}  // namespace claray
