// Scenes and rays to measure with: made from a scene's camera and light, or recorded in a file.
#pragma once

#include <filesystem>

#include "claray/query.hpp"
#include "claray/scene.hpp"

namespace claray::bench {

/// Rays of one kind, in the order in which they are traced.
struct RaySet {
    std::string kind;      ///< "primary", "shadow", "bounce", "random"
    bool any_hit = false;  ///< asked whether they hit, not what
    std::vector<Ray> rays;
};

/// A scene by built-in name or OBJ, with what its rays need; also the plain binary NAME.scn: u32 'SCN1', vertices,
/// triangles, 0; positions; indices; with its rays in NAME.ray.
struct BenchScene {
    std::string name;
    std::vector<Mesh> meshes;
    Bounds bounds;
    Camera camera;
    glm::vec3 light{0.f};  ///< shadow rays go to a small ball around it
};
[[nodiscard]] BenchScene open_scene(const std::string& name);
[[nodiscard]] std::vector<Mesh> load_meshes(const std::string& name);

/// A file of 32-bit words.
[[nodiscard]] std::vector<std::uint32_t> read_words(const std::filesystem::path& path);

/// Primary rays of a camera, one through each pixel's centre, in scanline order or in tiles of 8 x 8 pixels.
[[nodiscard]] std::vector<Ray> primary_rays(const Camera& camera, unsigned width, unsigned height, bool tiles);
/// Rays between random points of the box, scaled by 1.5 around its centre.
[[nodiscard]] std::vector<Ray> random_rays(const Bounds& bounds, std::size_t count);

/// All kinds of rays of a scene: primary rays of width x height pixels in scanline order; from each hit, a hair's
/// breadth off the surface, a shadow ray to the light and a cosine-distributed bounce; as many random ones as primary.
/// The rays of a .ray file (u32 'RAY1', three counts; primary, shadow and bounce rays) replace all but the random
/// ones. `bvh` is the structure over the scene's meshes; since hits are the same on all devices, so are the rays.
[[nodiscard]] std::vector<RaySet> make_rays(const Bvh& bvh, const BenchScene& scene, unsigned width, unsigned height);

}  // namespace claray::bench
