// Instances to verify and test with: transforms of all kinds.
#pragma once

#include <span>

#include "claray/instances.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {

/// Rotates by a random rotation.
glm::mat4 random_rotation(Random& random);

/// `count` instances of random bottom levels in the cube of half side `half`: rotated, scaled differently along the
/// axes before and after, every third mirrored.
std::vector<Instance> random_instances(std::size_t count, std::uint32_t bottoms, float half, float scale,
                                       std::uint64_t seed);

/// Where they go: up to an eighth of a turn, a stretch, and a way of up to `far`.
std::vector<Instance> moved(std::span<const Instance> begins, float far, std::uint64_t seed);
/// The same along one axis only: other rows of the transforms stay.
std::vector<Instance> moved_in_part(std::span<const Instance> begins, float far, std::uint64_t seed);

}  // namespace claray::verify
