"""Results and arguments that are tuples with names."""

# No postponed annotations: those of a NamedTuple could not be evaluated by what reads them, such as pdoc.
from typing import Any, NamedTuple, Sequence

import numpy as np
from numpy.typing import NDArray

GBUFFER = np.dtype([("albedo_material", "u4"), ("normal", "u4"), ("depth", "f4")])
"""A pixel of a G-buffer: 12 bytes. albedo_material: red, green and blue as sRGB, and the material, from the lowest byte; normal:
two numbers of 16 bits; depth: 1 on the near plane, 0 infinitely far away."""


class TextureUse(NamedTuple):
    """How a material uses a texture: uv' = rotate(uv * scale, rotation) + offset (KHR_texture_transform).

    texture: number from Scene.add_texture. uv_set: 0: uvs of the mesh, 1: uvs1. rotation: radians, counter-clockwise as the
    image is seen.
    """

    texture: int
    uv_set: int = 0
    offset: Sequence[float] = (0.0, 0.0)
    scale: Sequence[float] = (1.0, 1.0)
    rotation: float = 0.0


class GBuffer(NamedTuple):
    """What deferred shading keeps of the surface at each pixel's centre.

    pixels: (height, width) of dtype GBUFFER. normals: (height, width, 3), restored; 0 where there is no surface. positions:
    (height, width, 3) in the world, restored from the depth; not finite where there is no surface. world_from_image: (4, 4)
    takes a place in the image (-1 to 1 on both axes, y upwards), the depth and 1 to a place in the world, which is to be divided by its
    fourth number.
    """

    pixels: NDArray[Any]
    normals: NDArray[np.float32]
    positions: NDArray[np.float32]
    world_from_image: NDArray[np.float64]


class ImageError(NamedTuple):
    """The difference between two images. rmse: over the reference's mean. relmse: mean of (difference / (reference + 1 % of its
    mean))^2. perceptual: 0 to 1, the colour term of FLIP (Andersson et al. 2020)."""

    rmse: float
    relmse: float
    perceptual: float
