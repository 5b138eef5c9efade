"""Images of surfaces and of surroundings: plain data, which can be pickled."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Literal, Sequence, Union, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import as_array, check_choice, naming, number, path_of
from ._handle import warn
from .errors import UsageError

Wrap = Literal["repeat", "mirror", "clamp"]
TextureFilter = Literal["nearest", "bilinear", "trilinear", "nearest-level"]
_WRAPS = ("repeat", "mirror", "clamp")
_FILTERS = ("nearest", "bilinear", "trilinear", "nearest-level")


@dataclass(frozen=True, eq=False)
class Texture:
    """An image for surfaces or surroundings. It cannot be changed.

    pixels: (height, width, channels) or (height, width) uint8 or float32, rows from the top; 1 to 4 channels: grey, grey and
    alpha, RGB, RGBA. color: what bytes mean: "srgb" (colours) or "linear" (roughness, normals, ...). Floats are linear.
    wrap: what lies outside of the image, for both axes or one for each: "repeat", "mirror" or "clamp". filter: "nearest",
    "bilinear", "trilinear" or "nearest-level". Raises UsageError, naming the argument.
    """

    pixels: NDArray[Any]
    color: Literal["srgb", "linear"] = "srgb"
    wrap: Wrap | tuple[Wrap, Wrap] = "repeat"
    filter: TextureFilter = "trilinear"
    name: str = ""

    def __post_init__(self) -> None:
        array = as_array("pixels", self.pixels)
        if array.dtype.kind == "f":
            with np.errstate(over="ignore"):
                array = array.astype(np.float32, copy=False)
        if array.dtype.name not in ("uint8", "float32"):
            raise UsageError(f"pixels: has dtype {array.dtype}; use uint8, or floats")
        if array.ndim == 2:
            array = array[..., None]
        if array.ndim != 3 or not 1 <= array.shape[2] <= 4 or 0 in array.shape:
            raise UsageError(f"pixels: has shape {array.shape}; it must be (height, width) or (height, width, 1 to 4)")
        array = np.array(array, order="C", subok=False)
        array.flags.writeable = False
        check_choice("color", self.color, ("srgb", "linear"))
        check_choice("filter", self.filter, _FILTERS)
        wrap = (self.wrap, self.wrap) if isinstance(self.wrap, str) else self.wrap
        if not isinstance(wrap, (tuple, list)) or len(wrap) != 2:
            raise UsageError(f"wrap: is {self.wrap!r}; use a name, or one for each axis")
        for one in wrap:
            check_choice("wrap", one, _WRAPS)
        if not isinstance(self.name, str):
            raise UsageError(f"name: is a {type(self.name).__name__}; use a text")
        object.__setattr__(self, "pixels", array)
        object.__setattr__(self, "wrap", tuple(wrap))

    @classmethod
    def load(cls, path: str | os.PathLike[str], color: Literal["srgb", "linear"] = "srgb", *,
             wrap: Wrap | tuple[Wrap, Wrap] = "repeat", filter: TextureFilter = "trilinear") -> Texture:
        """Reads PNG, JPEG, WebP, BMP, TGA, HDR, PFM or EXR. Raises InputError, naming the file."""
        check_choice("color", color, ("srgb", "linear"))
        native = _native.load_image(path_of("path", path), color)
        return cls(cast("NDArray[Any]", native.pixels()), color, wrap, filter, native.name)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the pixels as they are: .png for bytes, .pfm for floats of 1 or 3 channels."""
        _native.save_texture(path_of("path", path), self._native())

    def normal_map(self, strength: float = 1.0) -> Texture:
        """The normals of this field of heights, for Material.normal_map. strength: the height of 1, in texels."""
        return texture_from(_native.normal_map_of(self._native(), number("strength", strength)))

    def _native(self) -> Any:
        if self.pixels.dtype == np.uint8:
            native = _native.NativeTexture.of_bytes(self.pixels, self.color)
        else:
            native = _native.NativeTexture.of_floats(self.pixels)
        native.name, native.filter = self.name, self.filter
        native.wrap_u, native.wrap_v = cast("tuple[Wrap, Wrap]", self.wrap)
        return native

    def __repr__(self) -> str:
        height, width, channels = cast("tuple[int, int, int]", self.pixels.shape)
        return f"<claray.Texture '{self.name}' of {width} x {height} texels, {channels} channels of {self.pixels.dtype}>"

    def __reduce__(self) -> Any:
        return Texture, (self.pixels, self.color, self.wrap, self.filter, self.name)


AnyTexture = Union[Texture, ArrayLike, str, "os.PathLike[str]"]
"""Where an image is asked for: a Texture, an array as of Texture, or the name of a file."""


def texture_of(name: str, given: Any, **options: Any) -> Texture:
    if isinstance(given, Texture):
        if options:
            raise UsageError(f"{next(iter(options))}: the {name} is a claray.Texture, which has its own")
        return given
    if isinstance(given, (str, os.PathLike)):
        with naming(name):
            return Texture.load(given, **options)  # pyright: ignore[reportUnknownArgumentType]  # path_of checks it
    try:
        return Texture(as_array(name, given), **options)
    except UsageError as error:
        raise UsageError(str(error).replace("pixels:", f"{name}:", 1)) from None


def texture_from(native: Any) -> Texture:
    color: Literal["srgb", "linear"] = "srgb" if native.color == "srgb" else "linear"
    return Texture(native.pixels(), color, (native.wrap_u, native.wrap_v), native.filter, native.name)


@dataclass(frozen=True, eq=False)
class Environment:
    """An image around a scene. It cannot be changed.

    images: one in latitude and longitude, whose middle column is towards -z and whose top is +y; or six, the faces +x -x +y -y
    +z -z of a cube, oriented as in OpenGL. Each is a Texture, an array or the name of a file. strength: multiplies its
    radiance. rotation: radians about +y, counter-clockwise seen from above. Raises UsageError, naming the argument.
    """

    images: tuple[Texture, ...]
    strength: float = 1.0
    rotation: float = 0.0

    def __init__(self, images: AnyTexture | Sequence[AnyTexture], strength: float = 1.0, rotation: float = 0.0) -> None:
        given: Any = images
        faces = [texture_of("images", one) for one in (given if type(given) in (list, tuple) and len(given) == 6 else [given])]
        object.__setattr__(self, "images", tuple(faces))
        object.__setattr__(self, "strength", number("strength", strength))
        object.__setattr__(self, "rotation", number("rotation", rotation))

    @classmethod
    def load(cls, path: str | os.PathLike[str], strength: float = 1.0, rotation: float = 0.0) -> Environment:
        """Reads an image in latitude and longitude, an OpenEXR cube map, or a folder with the faces px nx py ny pz nz of a
        cube. Raises InputError, naming the file."""
        native, messages = _native.load_environment(path_of("path", path))
        for message in messages:
            warn(message)
        return cls([texture_from(image) for image in native.images] if len(native.images) == 6 else texture_from(native.images[0]),
                   strength, rotation)

    def panorama(self) -> Texture:
        """One image in latitude and longitude, float32, times its strength and without its rotation."""
        return texture_from(_native.panorama_of(self._native()))

    def _native(self) -> Any:
        native = _native.NativeEnvironment()
        native.images = [image._native() for image in self.images]
        native.strength, native.rotation = self.strength, self.rotation
        return native

    def __reduce__(self) -> Any:
        images = list(self.images)
        return Environment, (images if len(images) == 6 else images[0], self.strength, self.rotation)


def environment_from(native: Any) -> Environment | None:
    images = [texture_from(image) for image in native.images]
    if not images:
        return None
    return Environment(images if len(images) == 6 else images[0], native.strength, native.rotation)
