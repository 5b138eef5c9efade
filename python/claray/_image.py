"""Images that show themselves in notebooks."""

from __future__ import annotations

import os
import struct
import zlib
from dataclasses import dataclass
from typing import Any, Mapping, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import as_array, number, path_of, text
from ._options import ToneMap
from ._values import ImageError
from .errors import UsageError

_CHANNELS = {"depth": "Z", "normal": "XYZ", "position": "XYZ", "uv": "UV", "motion": "XY"}


@dataclass(frozen=True)
class Cryptomatte:
    """Which surfaces each pixel shows: a layer of an EXR from which compositors make masks (Psyop's Cryptomatte specification 1.2.0).

    name: of the layer. ids, coverage: float32 (height, width, ranks), the largest part of each pixel first; 0 where there are fewer.
    manifest: the hash of each name.
    """

    name: str
    ids: NDArray[np.float32]
    coverage: NDArray[np.float32]
    manifest: dict[str, int]

    def mask(self, *names: str) -> NDArray[np.float32]:
        """The share of each pixel that shows things of these names, (height, width). Raises UsageError for a name that is not there."""
        if unknown := [name for name in names if name not in self.manifest]:
            raise UsageError(f"names: there is no {unknown[0]!r}; there are {', '.join(self.manifest)}")
        ids = np.array([_native.matte_id(self.manifest[name]) for name in names], np.float32)
        shares: NDArray[np.float32] = np.where(np.isin(self.ids, ids), self.coverage, np.float32(0)).sum(axis=-1, dtype=np.float32)
        return shares


class Image(np.ndarray):
    """Linear radiance, float32 of shape (height, width, 3), rows from the top: an array that notebooks show.

    exposure: in stops, and tone_map: "aces" or "none", of its pictures. Copies and pickled images keep both.
    """

    __slots__ = ("exposure", "tone_map")
    exposure: float
    tone_map: ToneMap

    def __array_finalize__(self, source: Any) -> None:
        self.exposure = getattr(source, "exposure", 0.0)
        self.tone_map = getattr(source, "tone_map", "aces")

    def __reduce__(self) -> Any:
        make, arguments, state = cast("tuple[Any, Any, Any]", super().__reduce__())
        return make, arguments, (state, self.exposure, self.tone_map)

    def __setstate__(self, state: Any) -> None:
        array, self.exposure, self.tone_map = state
        super().__setstate__(array)

    def to_bytes(self, exposure: float | None = None, tone_map: ToneMap | None = None) -> NDArray[np.uint8]:
        """The picture as uint8 of the same shape: exposure in stops, tone map "aces" or "none", sRGB."""
        pixels: Any = _native.to_bytes(np.ascontiguousarray(self, np.float32).view(np.ndarray),
                                       *self._shown_by(exposure, tone_map))
        return cast("NDArray[np.uint8]", pixels)

    def _shown_by(self, exposure: float | None, tone_map: str | None) -> tuple[float, str]:
        return (self.exposure if exposure is None else number("exposure", exposure),
                self.tone_map if tone_map is None else text("tone_map", tone_map))

    def save(self, path: str | os.PathLike[str], exposure: float | None = None, tone_map: ToneMap | None = None, *,
             layers: Mapping[str, ArrayLike | Cryptomatte] | None = None) -> None:
        """Writes .png, .jpg, .webp (tone mapped), .hdr, .pfm or .exr (linear) by the extension.

        layers: of an EXR, by their names, such as Renderer.aovs(): (height, width) or (height, width, channels) floats or integers, or
        a Cryptomatte, which has its own name. Raises InputError if the file cannot be written.
        """
        name = path_of("path", path)
        if layers is None:
            _native.save_image(name, pixels_of("image", self), *self._shown_by(exposure, tone_map))
            return
        if not name.lower().endswith(".exr"):
            raise UsageError(f"layers: {name} cannot hold layers; use a file .exr")
        height, width, _ = self.shape
        all_layers: dict[str, Any] = {"": self, **layers}
        mattes = [_matte(layer, matte, (height, width)) for layer, matte in all_layers.items() if isinstance(matte, Cryptomatte)]
        given = [_layer(layer, array, (height, width)) for layer, array in all_layers.items() if not isinstance(array, Cryptomatte)]
        _native.save_exr(name, width, height, [one for one in given if one[2].dtype == np.float32],
                         [one for one in given if one[2].dtype == np.uint32], mattes)

    def _repr_png_(self) -> bytes | None:
        if self.ndim != 3 or self.shape[2] != 3 or self.size == 0:
            return None  # such as one channel of the image
        return png_of(self.to_bytes())


def _layer(name: str, value: Any, size: tuple[int, int]) -> tuple[str, str, NDArray[Any]]:
    """Name, letters of the channels, and pixels (height, width, channels) as float32 or uint32."""
    array = as_array(f"layers[{name!r}]", value)
    if array.ndim == 2:
        array = array[..., None]
    if array.dtype.kind not in "fiub" or array.shape[:2] != size or array.shape[2:] not in ((1,), (2,), (3,), (4,)):
        raise UsageError(f"layers[{name!r}]: has dtype {array.dtype} and shape {array.shape}; use numbers of shape {size} or {(*size, 3)}")
    count = array.shape[2]
    letters = "X" if count == 1 and array.dtype.kind in "iub" else ("Y", "XY", "RGB", "RGBA")[count - 1]
    if len(_CHANNELS.get(name, "")) == count:
        letters = _CHANNELS[name]
    kind = np.float32 if array.dtype.kind == "f" else np.uint32
    return name, letters, np.ascontiguousarray(array, kind).view(np.ndarray)


def _matte(name: str, matte: Cryptomatte, size: tuple[int, int]) -> tuple[str, NDArray[np.float32], list[str]]:
    if matte.ids.shape != matte.coverage.shape or matte.ids.shape[:2] != size or matte.ids.shape[2] % 2:
        raise UsageError(f"layers[{name!r}]: is a Cryptomatte of shape {matte.ids.shape}; use one of {size} with an even number of ranks")
    return matte.name, np.stack([matte.ids, matte.coverage], axis=-1), list(matte.manifest)


def pixels_of(name: str, value: Any) -> NDArray[np.float32]:
    """Contiguous float32 of shape (height, width, 3)."""
    array = as_array(name, value)
    if array.dtype.kind not in "fiu" or array.ndim != 3 or array.shape[2] != 3 or array.size == 0:
        raise UsageError(f"{name}: has dtype {array.dtype} and shape {array.shape}; use numbers of shape (height, width, 3)")
    return np.ascontiguousarray(array, np.float32).view(np.ndarray)


def _map_of(name: str, value: Any, kind: Any) -> NDArray[Any]:
    array = as_array(name, value)
    if array.dtype.kind not in "fiub" or array.ndim != 2 or array.size == 0:
        raise UsageError(f"{name}: has dtype {array.dtype} and shape {array.shape}; use numbers of shape (height, width)")
    return np.ascontiguousarray(array, kind).view(np.ndarray)


def image_error(image: ArrayLike, reference: ArrayLike) -> ImageError:
    """The difference between two images of linear radiance, (height, width, 3) each."""
    first, second = pixels_of("image", image), pixels_of("reference", reference)
    if first.shape != second.shape:
        raise UsageError(f"reference: has shape {second.shape}, but image has {first.shape}")
    return ImageError(*_native.image_error(first, second))


def false_color(values: ArrayLike) -> Image:
    """One value per pixel, (height, width), as perceptually uniform colours (Turbo), from the least to the largest finite value;
    other values are black."""
    return _shown(_native.false_color(_map_of("values", values, np.float32)))


def identifier_color(identifiers: ArrayLike) -> Image:
    """Whole numbers, (height, width), as colours; consecutive ones get very different hues. MISS is black."""
    return _shown(_native.identifier_color(_map_of("identifiers", identifiers, np.uint32)))


def _shown(pixels: Any) -> Image:
    image: Image = pixels.view(Image)
    image.tone_map = "none"
    return image


def png_of(pixels: NDArray[np.uint8]) -> bytes:
    """PNG of (height, width, 3) bytes."""
    height, width, _ = pixels.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.zeros((height, 1 + 3 * width), np.uint8)  # each row begins with its filter: none
    rows[:, 1:] = pixels.reshape(height, 3 * width)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6)) + chunk(b"IEND", b"")
