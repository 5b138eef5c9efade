# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of shader nodes: constants, or texels of images. Everything but textures by formulas is computed, texel by texel."""

from dataclasses import dataclass, replace

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722], np.float32)  # Rec. 709
MOST_TEXELS = 2**26


@dataclass(frozen=True)
class Place:
    """Where an image is on surfaces: Blender's own terms, v upwards."""

    uv_map: str = ""  # empty: the one that is active for rendering
    offset: tuple = (0.0, 0.0)
    scale: tuple = (1.0, 1.0)
    rotation: float = 0.0  # radians, counter-clockwise
    wrap: str = "repeat"
    filter: str = "trilinear"


@dataclass(frozen=True)
class Value:
    """data: (C,) a constant, or (H, W, C) texels, rows from the top; linear float32, C is 1, 3 or 4. image: whose colours these are,
    unchanged; None: they are computed."""

    data: np.ndarray
    place: Place | None = None
    image: object = None

    @property
    def is_constant(self):
        return self.data.ndim == 1

    def mean(self):
        return self.data if self.is_constant else self.data.mean((0, 1), dtype=np.float64).astype(np.float32)


def constant(value):
    return Value(np.atleast_1d(np.asarray(value, np.float32)))


def as_channels(value, count):
    """The value as a number, a vector or a colour, as Blender converts sockets."""
    data = value.data
    have = data.shape[-1]
    if have == count:
        return value
    if count == 1:  # a colour counts with its luminance, a vector with its mean
        data = (data[..., :3] @ LUMINANCE)[..., None] if have == 4 else data.mean(-1, keepdims=True)
    elif have == 1:
        data = np.repeat(data, 3, -1)
    else:
        data = data[..., :3]
    if count == 4:
        data = np.concatenate([data, np.ones_like(data[..., :1])], -1)
    image = value.image if count != 1 and have != 1 else None  # whose colours are the same
    return replace(value, data=np.ascontiguousarray(data, np.float32), image=image)


def resized(texels, height, width):
    rows = np.arange(height) * texels.shape[0] // height
    columns = np.arange(width) * texels.shape[1] // width
    return texels[rows][:, columns]


def combined(function, values, note):
    """The function of values. note(text) tells of an image that lies elsewhere than another; its mean takes its place."""
    images = [value for value in values if not value.is_constant]
    if not images:
        return Value(np.asarray(function(*(value.data for value in values)), np.float32))
    place = images[0].place
    height, width = (max(value.data.shape[axis] for value in images) for axis in (0, 1))
    arrays = []
    for value in values:
        if value.is_constant:
            arrays.append(value.data)
        elif value.place != place:
            note("images with different coordinates are combined; the mean of one takes its place")
            arrays.append(value.mean())
        else:
            arrays.append(value.data if value.data.shape[:2] == (height, width) else resized(value.data, height, width))
    data = np.asarray(function(*arrays), np.float32)
    return Value(np.ascontiguousarray(np.broadcast_to(data, (height, width, data.shape[-1]))), place)


def linear_of_srgb(encoded):
    """IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4).astype(np.float32)


def raw_texels(image):
    """(height, width, channels) float32, rows from the top, as Blender keeps them: bytes are 0 to 1, not decoded."""
    width, height = image.size
    values = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, image.channels)[::-1]


def is_encoded(image):
    """Whether bytes of the image are colours in sRGB."""
    return not image.is_float and image.colorspace_settings.name == "sRGB"


def linear_texels(image):
    """(height, width, 4) float32."""
    raw = raw_texels(image)
    channels = raw.shape[2]
    texels = np.ones((*raw.shape[:2], 4), np.float32)
    texels[..., :3] = raw[..., :3] if channels >= 3 else raw[..., :1]
    if channels in (2, 4) and image.alpha_mode != "NONE":
        texels[..., 3] = raw[..., -1]
    if is_encoded(image):
        table = linear_of_srgb(np.arange(256, dtype=np.float32) / 255)
        texels[..., :3] = table[np.rint(texels[..., :3] * 255).astype(np.uint8)]
    return texels


def problem_of_image(image):
    """Why an image cannot be read; None: it can be."""
    if image is None:
        return "an image node has no image"
    if image.source in ("MOVIE", "SEQUENCE", "TILED"):
        return f"the image '{image.name}' is a {image.source.lower()}, not a single image"
    if 0 in image.size:
        return f"the image '{image.name}' is missing"
    if image.size[0] * image.size[1] > MOST_TEXELS:
        return f"the image '{image.name}' has more than {MOST_TEXELS} texels"
    return None


# Functions of nodes on arrays, whose last axis has the channels.

def _wrapped(a, b, c):
    span = b - c
    return np.where(span != 0, a - span * np.floor((a - c) / np.where(span == 0, 1, span)), c)


def _safe(function, valid):
    def checked(a, *more):
        return np.where(valid(a, *more), function(np.where(valid(a, *more), a, 1), *more), 0)
    return checked


_divide = _safe(lambda a, b: a / np.where(b == 0, 1, b), lambda a, b: b != 0)
MATH = {
    "ADD": np.add, "SUBTRACT": np.subtract, "MULTIPLY": np.multiply, "DIVIDE": _divide,
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "POWER": _safe(lambda a, b: np.power(a, b), lambda a, b: (a > 0) | ((a == 0) & (b > 0))),
    "LOGARITHM": _safe(lambda a, b: np.log(a) / np.where((b <= 0) | (b == 1), 1, np.log(np.where(b > 0, b, 2))),
                       lambda a, b: (a > 0) & (b > 0) & (b != 1)),
    "SQRT": _safe(np.sqrt, lambda a: a > 0), "INVERSE_SQRT": _safe(lambda a: 1 / np.sqrt(a), lambda a: a > 0),
    "ABSOLUTE": np.abs, "EXPONENT": np.exp, "MINIMUM": np.minimum, "MAXIMUM": np.maximum,
    "LESS_THAN": lambda a, b: np.float32(a < b), "GREATER_THAN": lambda a, b: np.float32(a > b),
    "SIGN": np.sign, "COMPARE": lambda a, b, c: np.float32(np.abs(a - b) <= np.maximum(c, 1e-5)),
    "ROUND": lambda a: np.floor(a + 0.5), "FLOOR": np.floor, "CEIL": np.ceil, "TRUNC": np.trunc, "FRACT": lambda a: a - np.floor(a),
    "MODULO": _safe(lambda a, b: np.fmod(a, np.where(b == 0, 1, b)), lambda a, b: b != 0),
    "FLOORED_MODULO": _safe(lambda a, b: np.mod(a, np.where(b == 0, 1, b)), lambda a, b: b != 0),
    "WRAP": _wrapped, "SNAP": _safe(lambda a, b: np.floor(a / np.where(b == 0, 1, b)) * b, lambda a, b: b != 0),
    "SINE": np.sin, "COSINE": np.cos, "TANGENT": np.tan, "ARCTANGENT": np.arctan, "ARCTAN2": np.arctan2,
    "RADIANS": np.radians, "DEGREES": np.degrees,
}


def _screen(a, b):
    return 1 - (1 - a) * (1 - b)


BLEND = {
    "MIX": lambda a, b: b, "ADD": np.add, "MULTIPLY": np.multiply, "SUBTRACT": np.subtract, "SCREEN": _screen,
    "DIVIDE": lambda a, b: np.where(b == 0, a, _divide(a, b)), "DIFFERENCE": lambda a, b: np.abs(a - b),
    "DARKEN": np.minimum, "LIGHTEN": np.maximum,
    "OVERLAY": lambda a, b: np.where(a < 0.5, 2 * a * b, 1 - 2 * (1 - a) * (1 - b)),
    "LINEAR_LIGHT": lambda a, b: a + 2 * b - 1,
    "SOFT_LIGHT": lambda a, b: (1 - a) * a * b + a * _screen(a, b),
    "EXCLUSION": lambda a, b: np.maximum(a + b - 2 * a * b, 0),
}


def blended(kind, factor, a, b):
    """As Mix Color: the result of `kind` is mixed with `a` by the factor; alpha is that of `a`."""
    factor = np.asarray(factor)[..., :1]
    result = a + factor * (BLEND[kind](a, b) - a)
    return np.concatenate([result[..., :3], np.broadcast_to(a[..., 3:], result[..., :1].shape)], -1)


def hue_saturation(hue, saturation, value, factor, color):
    """As the node of this name: a hue of 0.5 changes nothing."""
    rgb = color[..., :3]
    top, low = rgb.max(-1, keepdims=True), rgb.min(-1, keepdims=True)
    span = top - low
    safe = np.where(span == 0, 1, span)
    which = rgb.argmax(-1)[..., None]
    red, green, blue = rgb[..., :1], rgb[..., 1:2], rgb[..., 2:]
    h = np.where(which == 0, (green - blue) / safe, np.where(which == 1, 2 + (blue - red) / safe, 4 + (red - green) / safe)) / 6
    h = np.mod(np.where(span == 0, 0, h) + hue + 0.5, 1.0)
    s = np.clip(np.where(top == 0, 0, span / np.where(top == 0, 1, top)) * saturation, 0, 1)
    v = top * value
    ramp = np.abs(np.mod(h * 6 + np.array([0, 4, 2], np.float32), 6) - 3) - 1  # the pure hue
    changed = v * (1 - s * (1 - np.clip(ramp, 0, 1)))
    mixed = np.maximum(rgb + factor * (changed - rgb), 0)
    return np.concatenate([mixed, np.broadcast_to(color[..., 3:], mixed[..., :1].shape)], -1)


def black_body(kelvin):
    """Linear Rec. 709 of the radiance of a black body, at luminance 1: Planck's law, and the fit of Wyman, Sloan and Shirley 2013 to
    CIE's colour matching functions."""
    nm = np.arange(380.0, 781.0, 5.0)

    def lobe(center, below, above):
        return np.exp(-0.5 * ((nm - center) * np.where(nm < center, below, above)) ** 2)

    x = 0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323) - 0.065 * lobe(501.1, 0.0490, 0.0382)
    y = 0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322)
    z = 1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725)
    radiance = nm ** -5 / np.expm1(1.438777e7 / (nm * max(kelvin, 800.0)))
    xyz = np.array([(radiance * matching).sum() for matching in (x, y, z)])
    rgb = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]) @ (xyz / xyz[1])
    return np.maximum(rgb, 0).astype(np.float32)
