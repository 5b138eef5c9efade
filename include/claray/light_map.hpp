// Light maps: light that was computed once, to be looked up ever after.
#pragma once

#include <functional>

#include "claray/renderer.hpp"

namespace claray {

struct LightMapConfig {
    unsigned width = 128, height = 128;      ///< texels, 1 to 2^14 each
    unsigned spp = 256;                      ///< paths a texel
    unsigned max_depth = default_max_depth;  ///< surfaces at which a path may be scattered, the map's own included
    std::uint32_t seed = 0;
    std::uint32_t uv_set = 1;  ///< the coordinates that spread the mesh over 0..1 without overlaps
    Sampler sampler = Sampler::sobol;
    Bvh::Config bvh = {};
};

/// Irradiance of the front of a mesh, W / m^2, path traced at the centre of every texel that a triangle touches; texels
/// between the mesh's pieces continue their neighbours. Linear float32 RGB, bilinear, clamped: for Material::light_map
/// of Lambertian materials, with this `uv_set`. Light maps that the scene has are not used. `progress` gets the share
/// that is done; false stops with ErrorKind::user. Throws ErrorKind::usage for a configuration out of range,
/// ErrorKind::user where the mesh does not exist, has no such coordinates, leaves 0..1 or overlaps itself, or the scene
/// has instances.
[[nodiscard]] Texture bake_light_map(const Device& device, const Scene& scene, std::size_t mesh,
                                     const LightMapConfig& config = {},
                                     const std::function<bool(double)>& progress = {});

/// Lets the Lambertian materials of a mesh show the light map: as copies, since other meshes may have the same ones.
/// Throws ErrorKind::user where the mesh does not exist or has no coordinates in that set.
void use_light_map(Scene& scene, std::size_t mesh, Texture light_map, std::uint32_t uv_set = 1);

/// The set that the command line takes for a light map: the second where the mesh has one.
[[nodiscard]] std::uint32_t light_map_uv_set(const Scene& scene, std::size_t mesh);

}  // namespace claray
