"""Images that show themselves in notebooks."""

from __future__ import annotations

import os
import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native


class Image(np.ndarray):
    """Linear radiance, float32 of shape (height, width, 3), rows from the top: an array that notebooks show."""

    __slots__ = ("exposure", "tone_map")

    def __array_finalize__(self, source: Any) -> None:
        self.exposure = getattr(source, "exposure", 0.0)
        self.tone_map = getattr(source, "tone_map", "aces")

    def to_bytes(self, exposure: float | None = None, tone_map: str | None = None) -> NDArray[np.uint8]:
        """The picture as uint8 of the same shape: exposure in stops, tone map "aces" or "none", sRGB."""
        return _native.to_bytes(np.ascontiguousarray(self, np.float32).view(np.ndarray),
                                self.exposure if exposure is None else exposure, tone_map or self.tone_map)

    def save(self, path: str | os.PathLike[str], exposure: float | None = None, tone_map: str | None = None) -> None:
        """Writes .png (tone mapped), .hdr, .pfm or .exr (linear) by the extension."""
        _native.save_image(os.fspath(path), np.ascontiguousarray(self, np.float32).view(np.ndarray),
                           self.exposure if exposure is None else exposure, tone_map or self.tone_map)

    def _repr_png_(self) -> bytes | None:
        if self.ndim != 3 or self.shape[2] != 3 or self.size == 0:
            return None  # such as one channel of the image
        return png_of(self.to_bytes())


def png_of(pixels: NDArray[np.uint8]) -> bytes:
    """PNG of (height, width, 3) bytes."""
    height, width, _ = pixels.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.zeros((height, 1 + 3 * width), np.uint8)  # each row begins with its filter: none
    rows[:, 1:] = pixels.reshape(height, 3 * width)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b"")
