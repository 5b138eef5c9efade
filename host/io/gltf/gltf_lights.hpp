// Lights of a glTF: KHR_lights_punctual and EXT_lights_image_based.
#pragma once

#include "host/io/gltf/gltf_nodes.hpp"
#include "host/io/gltf/materials/gltf_images.hpp"

namespace claray {

/// Adds the lights of a node.
void add_lights(const GltfFile& file, const PlacedNode& node, Scene& scene);

/// Sets the image around the scene if `source` has one. Its finest cube map lights all surfaces: the coarser ones and
/// the coefficients of the irradiance say the same of it once more.
void add_environment(const GltfFile& file, const tinygltf::Scene& source, const GltfImages& images, Scene& scene,
                     Warnings& warnings);

}  // namespace claray
