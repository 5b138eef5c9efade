// Scenes and rays to measure with: made from a scene's camera and light, or recorded in a file.
#pragma once

#include <filesystem>

#include "claray/query.hpp"
#include "claray/scene.hpp"

namespace claray::measure {

/// The meshes; with instances a transformed copy for each, as at shutter open.
[[nodiscard]] std::vector<Mesh> world_meshes(const Scene& scene);

/// The same of a scene by built-in name or file, or of the plain binary NAME.scn: u32 'SCN1', vertices, triangles, 0;
/// positions; indices.
[[nodiscard]] std::vector<Mesh> load_meshes(const std::string& name);

/// Throws the same error as load_meshes if the name is that of a missing file.
void check_scene_is_there(const std::string& name);

/// A file of 32-bit words.
[[nodiscard]] std::vector<std::uint32_t> read_words(const std::filesystem::path& path);

/// Primary rays of a camera, one through each pixel's centre, in scanline order or in tiles of 8 x 8 pixels.
[[nodiscard]] std::vector<Ray> primary_rays(const Camera& camera, unsigned width, unsigned height, bool tiles);
/// Rays between random points of the box, scaled by 1.5 around its centre.
[[nodiscard]] std::vector<Ray> random_rays(const Bounds& bounds, std::size_t count);

/// A camera, and the target of its shadow rays.
struct View {
    Camera camera;
    glm::vec3 light;
};

/// Three views: of halls, known by name, from the inside; of other scenes from three sides.
[[nodiscard]] std::vector<View> three_views(const std::string& name, const Scene& scene);

/// Rays by kind, in the order in which they are traced.
struct RaySets {
    std::vector<Ray> primary, shadow, bounce;
    std::vector<Ray> mixed;  ///< the primary and bounce rays in random order
};

/// Primary rays in scanline order or in tiles of 8x8 pixels; from each hit, slightly above the surface, a ray to the
/// view's light and a cosine-distributed bounce.
[[nodiscard]] RaySets make_rays(const Device& device, const Scene& scene, const std::vector<View>& views,
                                unsigned width, unsigned height, bool tiles = false);
/// The same from NAME.ray: u32 'RAY1', three counts; primary, shadow and bounce rays.
[[nodiscard]] RaySets read_rays(const std::filesystem::path& path);

/// Rays of one kind on the device, and their results.
struct DeviceRays {
    std::string name;  ///< "primary", "shadow", "bounce", "random"
    bool any_hit;      ///< asked whether they hit, not what
    Buffer<Ray> rays;
    Buffer<Hit> hits;
    Buffer<std::uint8_t> occluded;

    DeviceRays(const Device& device, std::string kind, bool any, const std::vector<Ray>& of);

    void trace(const Bvh& bvh);
    /// What the last trace found, as bytes to compare.
    [[nodiscard]] std::string results() const;
};

/// All kinds of rays of a scene (see three_views, make_rays), or those recorded beside a .scn file.
[[nodiscard]] std::vector<DeviceRays> upload_rays(const Device& device, const std::string& scene,
                                                  const std::vector<Mesh>& meshes, unsigned width, unsigned height);

/// PCG (O'Neill 2014): the same 32-bit numbers on every machine.
class Pcg {
public:
    std::uint32_t next() {
        state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
        const auto word = std::uint32_t(((state_ >> 18) ^ state_) >> 27);
        const auto turn = std::uint32_t(state_ >> 59);
        return (word >> turn) | (word << ((32 - turn) & 31));
    }
    float uniform() { return float(next() >> 8) * 0x1p-24f; }

private:
    std::uint64_t state_ = 1;
};

/// All of both, in random order.
[[nodiscard]] std::vector<Ray> shuffled(std::vector<Ray> rays, const std::vector<Ray>& more, Pcg& random);

}  // namespace claray::measure
