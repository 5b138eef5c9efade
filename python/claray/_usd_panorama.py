"""Images around scenes of USD."""

# pyright: basic
from __future__ import annotations

import os
import tempfile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._textures import Texture
from ._usd_materials import file_bytes, linear


def panorama_of(path: str) -> NDArray[Any]:
    """Linear colours of an image, also of one within an archive: (H, W, C), C at least 3."""
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, "image")
        with open(copy, "wb") as out:
            out.write(file_bytes(path))
        texture = Texture.load(copy)
    pixels = texture.pixels
    if pixels.shape[2] < 3:
        pixels = np.repeat(pixels[..., :1], 3, 2)
    if pixels.dtype == np.uint8:
        pixels = linear(np.arange(256) / 255)[pixels]
    known: NDArray[Any] = np.maximum(np.nan_to_num(pixels, posinf=65504.0), 0)
    return known


def turned(pixels: NDArray[Any], turn: NDArray[Any]) -> NDArray[np.float32]:
    """A panorama whose directions d show what turn^-1 d showed."""
    height, width = pixels.shape[:2]
    latitude = (0.5 - (np.arange(height) + 0.5) / height)[:, None] * np.pi
    longitude = ((np.arange(width) + 0.5) / width - 0.5)[None] * 2 * np.pi
    directions = np.stack([np.sin(longitude) * np.cos(latitude), np.sin(latitude) + 0 * longitude, -np.cos(longitude) * np.cos(latitude)], -1)
    before = directions @ turn  # the inverse of a rotation
    x = (np.arctan2(before[..., 0], -before[..., 2]) / (2 * np.pi) + 0.5) * width
    y = (0.5 - np.arcsin(np.clip(before[..., 1], -1, 1)) / np.pi) * height
    return np.ascontiguousarray(pixels[np.clip(y.astype(int), 0, height - 1), x.astype(int) % width], np.float32)
