// Scenes whose every part is drawn at random, extremes among them: what no scene was made to show, some of them show.
#pragma once

#include "claray/renderer.hpp"
#include "host/verify/shapes.hpp"

namespace claray::verify {

/// A valid scene of a few hundred triangles that has no effects but `allowed`, the same on every machine.
[[nodiscard]] Scene drawn_scene(std::uint64_t seed, EffectSet allowed);
/// A small image with few samples.
[[nodiscard]] RenderConfig drawn_config(std::uint64_t seed);

}  // namespace claray::verify
