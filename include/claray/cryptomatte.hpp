// Cryptomattes of a render.
#pragma once

#include "claray/image/cryptomatte.hpp"
#include "claray/renderer.hpp"

#pragma GCC visibility push(default)
namespace claray {

/// Most surfaces of a pixel that a Cryptomatte keeps.
inline constexpr unsigned most_matte_ranks = 16;

/// Returns which surfaces each pixel shows, by the first `samples` camera rays of its film, with lens and motion. What
/// lets rays pass (cut-outs) is not there; glass is. Things of one name are one; a thing without a name is called by
/// its kind and its number, such as "mesh 3". `ranks` is as large as the pixels need, at most `most_matte_ranks`. The
/// samples of the renderer are kept. Blocks. Throws ErrorKind::usage if `samples` is 0.
[[nodiscard]] Cryptomatte cryptomatte(const Renderer& renderer, MatteKind kind, unsigned samples = 64);

}  // namespace claray
#pragma GCC visibility pop
