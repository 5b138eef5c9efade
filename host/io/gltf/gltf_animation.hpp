// Animations of a glTF: its nodes, and what KHR_animation_pointer names, as they are at a time.
#pragma once

#include "host/io/gltf/gltf_file.hpp"

namespace claray {

/// Gives the nodes the translations, rotations, scales and weights that they have at `options.time` of the animation
/// that is chosen, and what pointers name its numbers. Without a time nothing changes, and a warning tells of the
/// animations that there are.
void pose(GltfFile& file, const LoadOptions& options, Warnings& warnings);

/// As animation_seconds.
[[nodiscard]] std::optional<double> seconds_of_animation(const GltfFile& file, const LoadOptions& options);

/// Morph targets of the node's mesh.
[[nodiscard]] std::size_t morph_targets(const GltfFile& file, const tinygltf::Node& node);

}  // namespace claray
