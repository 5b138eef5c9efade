#include "host/render/parts/scene_split.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace claray {
namespace {

/// The sum of the corners of each triangle; 0 in place of what is not finite.
std::vector<glm::vec3> middles_of(const Scene& scene, const SceneObject& object) {
    std::vector<glm::vec3> middles;
    for (std::size_t m = 0; m < object.meshes; ++m) {
        const Mesh& mesh = scene.meshes[object.first_mesh + m];
        for (const glm::uvec3& t : mesh.triangles) {
            glm::vec3 sum = mesh.positions.at(t.x) + mesh.positions.at(t.y) + mesh.positions.at(t.z);
            for (int axis = 0; axis < 3; ++axis)
                if (!std::isfinite(sum[axis])) sum[axis] = 0;
            middles.push_back(sum);
        }
    }
    return middles;
}

int longest_axis(std::span<const std::uint32_t> triangles, const std::vector<glm::vec3>& middles) {
    glm::vec3 lo = middles[triangles[0]], hi = lo;
    for (const std::uint32_t t : triangles) lo = glm::min(lo, middles[t]), hi = glm::max(hi, middles[t]);
    const glm::vec3 size = hi - lo;
    if (size.x >= size.y && size.x >= size.z) return 0;
    return size.y >= size.z ? 1 : 2;
}

void cut(std::span<std::uint32_t> triangles, std::size_t pieces, const std::vector<glm::vec3>& middles,
         std::size_t object, std::vector<ObjectPiece>& found) {
    if (pieces <= 1 || triangles.size() <= 1) {
        found.push_back({object, {triangles.begin(), triangles.end()}});
        std::sort(found.back().triangles.begin(), found.back().triangles.end());
        return;
    }
    const int axis = longest_axis(triangles, middles);
    const std::size_t first_pieces = pieces / 2, middle = triangles.size() * first_pieces / pieces;
    std::nth_element(triangles.begin(), triangles.begin() + std::ptrdiff_t(middle), triangles.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                         return middles[a][axis] != middles[b][axis] ? middles[a][axis] < middles[b][axis] : a < b;
                     });
    cut(triangles.first(middle), first_pieces, middles, object, found);
    cut(triangles.subspan(middle), pieces - first_pieces, middles, object, found);
}

}  // namespace

std::vector<SceneObject> objects_of(const Scene& scene, std::size_t baked) {
    std::vector<SceneObject> objects;
    std::uint32_t triangle = 0, vertex = 0;
    for (std::size_t i = 0; i < scene.meshes.size();) {
        const std::size_t together = scene.instances.empty() ? scene.meshes.size() : i == 0 && baked > 0 ? baked : 1;
        SceneObject object{i, together, triangle, vertex, 0};
        for (std::size_t end = i + together; i < end; ++i) {
            object.triangles += std::uint32_t(scene.meshes[i].triangles.size());
            vertex += std::uint32_t(scene.meshes[i].positions.size());
        }
        triangle += object.triangles;
        objects.push_back(object);
    }
    return objects;
}

std::vector<std::vector<ObjectPiece>> split_scene(const Scene& scene, const std::vector<SceneObject>& objects,
                                                  unsigned parts) {
    std::size_t all = 0;
    for (const SceneObject& object : objects) all += object.triangles;
    const std::size_t most = std::max<std::size_t>(1, (all + parts - 1) / std::max(1u, parts));
    std::vector<std::vector<ObjectPiece>> found(1);
    std::size_t in_last = 0;
    for (std::size_t o = 0; o < objects.size(); ++o) {
        std::vector<std::uint32_t> triangles(objects[o].triangles);
        std::iota(triangles.begin(), triangles.end(), 0u);
        std::vector<ObjectPiece> pieces;
        if (!triangles.empty())
            cut(triangles, (triangles.size() + most - 1) / most, middles_of(scene, objects[o]), o, pieces);
        for (ObjectPiece& piece : pieces) {
            if (in_last + piece.triangles.size() > most && in_last > 0) found.emplace_back(), in_last = 0;
            in_last += piece.triangles.size();
            found.back().push_back(std::move(piece));
        }
    }
    return found;
}

}  // namespace claray
