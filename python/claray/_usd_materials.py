"""Materials of USD (UsdPreviewSurface) as those of glTF."""

# pyright: basic, reportAttributeAccessIssue=false
# pxr states no types.
from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from typing import Any, Callable

import numpy as np
from numpy.typing import NDArray
from pxr import Ar, UsdShade  # pyright: ignore[reportMissingImports]

from ._glb import Glb
from ._textures import Texture
from .errors import Error

WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071, "black": 33071, "useMetadata": 10497}
_DEFAULTS: dict[str, Any] = {"diffuseColor": (0.18, 0.18, 0.18), "emissiveColor": (0, 0, 0), "metallic": 0.0, "roughness": 0.5,
                             "clearcoat": 0.0, "clearcoatRoughness": 0.01, "opacity": 1.0, "opacityThreshold": 0.0, "ior": 1.5,
                             "useSpecularWorkflow": 0, "specularColor": (0, 0, 0), "occlusion": 1.0}


@dataclass
class Use:
    """How an input reads an image. channel: of "rgb", "r" and so on."""

    file: str
    channel: str
    scale: tuple[float, ...]
    bias: tuple[float, ...]
    space: str
    wrap: tuple[int, int]
    uv: str
    transform: dict[str, Any] | None

    @property
    def plain(self) -> bool:
        return all(s == 1 for s in self.scale) and all(b == 0 for b in self.bias)


@dataclass
class VertexColor:
    """An input that reads a primvar of colours."""

    name: str


def source_of(shade_input: Any) -> tuple[Any, str] | None:
    """The shader and the output that feed an input, through node graphs; None: it is a value. The value of the input itself is then in
    shade_input.Get, or in that of the material's input."""
    seen = 0
    while shade_input and shade_input.HasConnectedSource() and seen < 64:
        seen += 1
        found = shade_input.GetConnectedSource()
        if not found:
            return None
        owner, name, kind = found
        prim = owner.GetPrim()
        shader = UsdShade.Shader(prim)
        if shader:
            return shader, str(name)
        shade_input = owner.GetInput(name) if kind == UsdShade.AttributeType.Input else owner.GetOutput(name)
    return None


def value_of(shade_input: Any, default: Any, time: Any) -> Any:
    """The value of an input that no shader feeds."""
    if not shade_input:
        return default
    attributes = UsdShade.Utils.GetValueProducingAttributes(shade_input)
    value = attributes[0].Get(time) if attributes else None
    return default if value is None else value


class Materials:
    """The materials of a file, each once."""

    def __init__(self, glb: Glb, time: Any, note: Callable[[str], None]) -> None:
        self._glb, self._time, self._note = glb, time, note
        self._made: dict[Any, int] = {}
        self._images: dict[Any, int] = {}
        self.uv_names: dict[int, list[str]] = {}
        self.color_names: dict[int, str] = {}

    def of_color(self, color: tuple[float, ...], opacity: float = 1.0) -> int:
        """Of a surface without a material."""
        key = (color, opacity)
        if key not in self._made:
            made: dict[str, Any] = {"doubleSided": True, "pbrMetallicRoughness": {
                "baseColorFactor": [*(min(max(float(c), 0.0), 1.0) for c in color), min(max(float(opacity), 0.0), 1.0)],
                "metallicFactor": 0.0, "roughnessFactor": 0.5}}
            if opacity < 1:
                made["alphaMode"] = "BLEND"
            self._made[key] = self._glb.add("materials", made)
        return self._made[key]

    def of_light(self, radiance: NDArray[Any]) -> int:
        largest = float(max(radiance.max(), 1e-30))
        made: dict[str, Any] = {"emissiveFactor": (radiance / largest).tolist(),
                                "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0.0, "roughnessFactor": 1.0}}
        self._glb.extension(made, "KHR_materials_emissive_strength")["emissiveStrength"] = largest
        self._glb.extension(made, "KHR_materials_specular")["specularFactor"] = 0.0
        return self._glb.add("materials", made)

    def number(self, material: Any) -> int | None:
        """The number of a UsdShade.Material; None: it has no surface that is known."""
        path = str(material.GetPath())
        if path not in self._made:
            found = self._preview_surface(material)
            if found is None:
                self._note(f"material '{path}' has no UsdPreviewSurface; displayColor takes its place")
                return None
            uv_names: list[str] = []
            color: list[str] = []
            made = self._surface(found, path, uv_names, color)
            made["name"] = material.GetPrim().GetName()
            number = self._glb.add("materials", made)
            self._made[path], self.uv_names[number] = number, uv_names
            if color:
                self.color_names[number] = color[0]
        return self._made[path]

    def _preview_surface(self, material: Any) -> Any:
        for context in ("", "glslfx"):
            found = material.ComputeSurfaceSource(context)
            shader = found[0] if found else None
            if shader and shader.GetIdAttr().Get() in ("UsdPreviewSurface", "ND_UsdPreviewSurface_surfaceshader"):
                return shader
        return None

    def _read(self, shader: Any, name: str, path: str) -> Any:
        """A value, a Use or a VertexColor."""
        given, default = shader.GetInput(name), _DEFAULTS.get(name)
        found = source_of(given) if given else None
        if found is None:
            return value_of(given, default, self._time)
        source, output = found
        kind = source.GetIdAttr().Get() or ""
        if kind == "UsdUVTexture":
            use = self._use(source, output)
            return use if use is not None else default
        if kind.startswith("UsdPrimvarReader_float3"):
            return VertexColor(str(value_of(source.GetInput("varname"), "displayColor", self._time)))
        self._note(f"material '{path}': the shader {kind or 'without a name'} as {name} is left out")
        return default

    def _use(self, texture: Any, output: str) -> Use | None:
        file = value_of(texture.GetInput("file"), None, self._time)
        path = (file.resolvedPath or "") if file is not None else ""
        if not path:
            self._note(f"the image '{file.path if file is not None else ''}' is missing")
            return None
        uv, transform = "st", None
        found = source_of(texture.GetInput("st"))
        if found and found[0].GetIdAttr().Get() == "UsdTransform2d":
            node = found[0]
            transform = _transform(*(value_of(node.GetInput(name), default, self._time) for name, default in (
                ("rotation", 0.0), ("scale", (1, 1)), ("translation", (0, 0)))))
            found = source_of(node.GetInput("in"))
        if found and (found[0].GetIdAttr().Get() or "").startswith("UsdPrimvarReader"):
            uv = str(value_of(found[0].GetInput("varname"), "st", self._time))
        wraps = [WRAPS.get(str(value_of(texture.GetInput(name), "useMetadata", self._time)), 10497) for name in ("wrapS", "wrapT")]
        scale, bias = (tuple(float(v) for v in value_of(texture.GetInput(name), default, self._time)) for name, default in (
            ("scale", (1, 1, 1, 1)), ("bias", (0, 0, 0, 0))))
        space = str(value_of(texture.GetInput("sourceColorSpace"), "auto", self._time))
        return Use(path, output, scale, bias, space, (wraps[0], wraps[1]), uv, transform)

    def _surface(self, shader: Any, path: str, uv_names: list[str], color: list[str]) -> dict[str, Any]:
        read = {name: self._read(shader, name, path) for name in _DEFAULTS}
        made: dict[str, Any] = {"doubleSided": True}
        pbr = made.setdefault("pbrMetallicRoughness", {})

        def texture(use: Use, image: int) -> dict[str, Any]:
            return self._texture(use, image, uv_names)
        self._base_color(read, made, pbr, texture, color)
        self._roughness_and_metallic(read, pbr, texture)
        emissive = read["emissiveColor"]
        if isinstance(emissive, Use):
            strength = max(*emissive.scale[:3], 1e-30)
            made["emissiveFactor"] = [max(0.0, s / strength) for s in emissive.scale[:3]]
            made["emissiveTexture"] = texture(emissive, self._image(emissive, True))
            if strength != 1:
                self._glb.extension(made, "KHR_materials_emissive_strength")["emissiveStrength"] = strength
        elif not isinstance(emissive, VertexColor) and max(emissive) > 0:
            strength = max(*emissive, 1.0)
            made["emissiveFactor"] = [max(0.0, c / strength) for c in emissive]
            if strength > 1:
                self._glb.extension(made, "KHR_materials_emissive_strength")["emissiveStrength"] = strength
        ior = self._number(read["ior"], 1.5, path, "ior")
        if abs(ior - 1.5) > 1e-6:
            self._glb.extension(made, "KHR_materials_ior")["ior"] = ior if ior >= 1 else 1.5
        coat = self._number(read["clearcoat"], 0.0, path, "clearcoat")
        if coat > 0:
            self._glb.extension(made, "KHR_materials_clearcoat").update(
                clearcoatFactor=min(coat, 1.0), clearcoatRoughnessFactor=self._number(read["clearcoatRoughness"], 0.01, path, "clearcoatRoughness"))
        if read["useSpecularWorkflow"] == 1:
            self._specular(read["specularColor"], made, pbr)
        self._normal(shader, made, texture, path)
        displacement = shader.GetInput("displacement")
        if displacement and (displacement.HasConnectedSource() or (displacement.Get(self._time) or 0) != 0):
            self._note(f"material '{path}': displacement is left out")
        return made

    def _number(self, value: Any, default: float, path: str, name: str) -> float:
        if isinstance(value, (Use, VertexColor)):
            self._note(f"material '{path}': an image as {name} is left out")
            return default
        return float(value)

    def _specular(self, specular: Any, made: dict[str, Any], pbr: dict[str, Any]) -> None:
        """The reflectance at normal incidence is the colour itself: that of the default index of refraction, 0.04, times a tint."""
        pbr["metallicFactor"] = 0.0
        if not isinstance(specular, (Use, VertexColor)):
            self._glb.extension(made, "KHR_materials_specular")["specularColorFactor"] = [max(0.0, float(c)) / 0.04 for c in specular]

    def _base_color(self, read: dict[str, Any], made: dict[str, Any], pbr: dict[str, Any], texture: Callable[[Use, int], dict[str, Any]],
                    color: list[str]) -> None:
        base, opacity, threshold = read["diffuseColor"], read["opacity"], read["opacityThreshold"]
        constant = 1.0 if isinstance(opacity, (Use, VertexColor)) else min(max(float(opacity), 0.0), 1.0)
        if isinstance(threshold, (int, float)) and threshold > 0:
            made.update(alphaMode="MASK", alphaCutoff=float(threshold))
        elif constant < 1 or isinstance(opacity, Use):
            made["alphaMode"] = "BLEND"
        if isinstance(base, VertexColor):
            color.append(base.name)
            pbr["baseColorFactor"] = [1, 1, 1, constant]
        elif isinstance(base, Use):
            with_alpha = isinstance(opacity, Use)
            if not with_alpha or (opacity.file == base.file and opacity.channel == "a" and opacity.plain):
                pbr["baseColorFactor"] = [*(min(max(s, 0.0), 1.0) for s in base.scale[:3]), constant] if not any(base.bias[:3]) else [1, 1, 1, constant]
                pbr["baseColorTexture"] = texture(base, self._image(base, True))
            else:
                pbr["baseColorTexture"] = texture(base, self._color_and_opacity(base, opacity))
        else:
            pbr["baseColorFactor"] = [*(min(max(float(c), 0.0), 1.0) for c in base), constant]
            if isinstance(opacity, Use):
                alpha = self._channel(opacity)
                white = np.full((*alpha.shape, 4), 255, np.uint8)
                white[..., 3] = np.rint(alpha * 255)
                pbr["baseColorTexture"] = texture(opacity, self._png(white, ("opacity", opacity.file, opacity.channel)))

    def _roughness_and_metallic(self, read: dict[str, Any], pbr: dict[str, Any], texture: Callable[[Use, int], dict[str, Any]]) -> None:
        rough, metal = read["roughness"], read["metallic"]
        uses = [use for use in (rough, metal) if isinstance(use, Use)]
        values = [1.0 if isinstance(v, (Use, VertexColor)) else min(max(float(v), 0.0), 1.0) for v in (rough, metal)]
        pbr["roughnessFactor"], pbr["metallicFactor"] = values
        if not uses:
            return
        if all(use.plain and use.file == uses[0].file for use in uses) and all(
                use is None or use.channel == channel for use, channel in ((rough if isinstance(rough, Use) else None, "g"),
                                                                           (metal if isinstance(metal, Use) else None, "b"))):
            pbr["metallicRoughnessTexture"] = texture(uses[0], self._image(uses[0], False))
            return
        parts = [self._channel(use) if isinstance(use, Use) else np.ones((1, 1), np.float32) for use in (rough, metal)]
        height, width = (max(part.shape[axis] for part in parts) for axis in (0, 1))
        packed = np.zeros((height, width, 3), np.uint8)
        for i, part in enumerate(parts):
            packed[..., 1 + i] = np.rint(_resized(part, height, width) * 255)
        if len(uses) == 2 and (uses[0].uv, uses[0].transform) != (uses[1].uv, uses[1].transform):
            self._note("images of roughness and metallic have different coordinates; those of roughness are used")
        key = ("packed", *((use.file, use.channel, use.scale, use.bias) if isinstance(use, Use) else None for use in (rough, metal)))
        pbr["metallicRoughnessTexture"] = texture(uses[0], self._png(packed, key))

    def _normal(self, shader: Any, made: dict[str, Any], texture: Callable[[Use, int], dict[str, Any]], path: str) -> None:
        given = shader.GetInput("normal")
        found = source_of(given) if given else None
        if not found:
            return
        use = self._use(*found) if found[0].GetIdAttr().Get() == "UsdUVTexture" else None
        if use is None:
            self._note(f"material '{path}': its normals are left out")
        elif use.scale[:3] == (2, 2, 2) and use.bias[:3] == (-1, -1, -1):
            made["normalTexture"] = texture(use, self._image(use, False))
        else:
            raw = self._raw(use.file)[..., :3]
            if use.plain and raw.min() >= 0:  # which the bytes of an image cannot be: it lacks scale and bias
                normals = raw * 2 - 1
            else:
                normals = raw * np.array(use.scale[:3], np.float32) + np.array(use.bias[:3], np.float32)
            encoded = np.rint(np.clip(normals / 2 + 0.5, 0, 1) * 255).astype(np.uint8)
            made["normalTexture"] = texture(use, self._png(encoded, ("normal", use.file, use.scale, use.bias)))

    def _texture(self, use: Use, image: int, uv_names: list[str]) -> dict[str, Any]:
        """A textureInfo of glTF."""
        sampler = ("sampler", use.wrap)
        if sampler not in self._images:
            self._images[sampler] = self._glb.add("samplers", {"wrapS": use.wrap[0], "wrapT": use.wrap[1]})
        key = ("texture", image, use.wrap)
        if key not in self._images:
            self._images[key] = self._glb.add("textures", {"source": image, "sampler": self._images[sampler]})
        if use.uv not in uv_names:
            if len(uv_names) == 2:
                self._note(f"a third set of coordinates, '{use.uv}'; '{uv_names[0]}' takes its place")
            else:
                uv_names.append(use.uv)
        info: dict[str, Any] = {"index": self._images[key]}
        if use.uv in uv_names and uv_names.index(use.uv):
            info["texCoord"] = 1
        if use.transform:
            self._glb.extension(info, "KHR_texture_transform").update(use.transform)
        return info

    def _image(self, use: Use, color: bool) -> int:
        """The image of a file, as it is where glTF can have it so. color: whether it holds colours."""
        data, kind = file_bytes(use.file), ""
        if data.startswith(b"\x89PNG"):
            kind = "image/png"
        elif data.startswith(b"\xff\xd8"):
            kind = "image/jpeg"
        as_it_is = kind and not any(use.bias[:3]) and use.channel in ("rgb", "rgba") and (use.space != "raw") == color
        if not color:
            as_it_is = bool(kind)
        key = ("image", use.file, color, as_it_is, use.channel, use.space, use.bias)
        if key not in self._images:
            if as_it_is:
                self._images[key] = self._glb.add("images", {"bufferView": self._glb.view(data), "mimeType": kind})
            else:
                texels = self._raw(use.file)
                if use.channel in ("r", "g", "b", "a"):
                    texels = np.repeat(texels[..., "rgba".index(use.channel)][..., None], 3, 2)
                is_linear = self._is_linear(use)
                if any(use.bias[:3]):
                    texels = (texels if is_linear else linear(texels))[..., :3] * np.array(use.scale[:3], np.float32) + np.array(use.bias[:3], np.float32)
                    is_linear = True
                if color and is_linear:
                    texels = np.concatenate([_encoded(texels[..., :3]), texels[..., 3:]], -1)
                self._images[key] = self._png(np.rint(np.clip(texels, 0, 1) * 255).astype(np.uint8), key)
        return self._images[key]

    def _is_linear(self, use: Use) -> bool:
        return use.space == "raw" or (use.space == "auto" and self._texels(use.file).dtype == np.float32)

    def _color_and_opacity(self, base: Use, opacity: Use) -> int:
        color, alpha = self._raw(base.file)[..., :3] * np.minimum(np.array(base.scale[:3], np.float32), 1), self._channel(opacity)
        height, width = max(color.shape[0], alpha.shape[0]), max(color.shape[1], alpha.shape[1])
        if self._is_linear(base):
            color = _encoded(color)
        texels = np.concatenate([_resized(color, height, width), _resized(alpha, height, width)[..., None]], -1)
        return self._png(np.rint(np.clip(texels, 0, 1) * 255).astype(np.uint8), ("both", base.file, opacity.file, opacity.channel))

    def _channel(self, use: Use) -> NDArray[np.float32]:
        """Numbers of one channel, 0 to 1."""
        which = "rgba".index(use.channel[0])
        texels = self._raw(use.file)[..., which]
        if use.space == "sRGB" and which < 3:
            texels = linear(texels)
        numbers: NDArray[np.float32] = np.clip(texels * use.scale[which] + use.bias[which], 0, 1)
        return numbers

    def _raw(self, file: str) -> NDArray[np.float32]:
        """(H, W, 4): bytes as 0 to 1, not decoded."""
        texels = self._texels(file)
        if texels.dtype == np.uint8:
            texels = texels.astype(np.float32) / 255
        channels = texels.shape[2]
        full = np.ones((*texels.shape[:2], 4), np.float32)
        full[..., :3] = texels[..., :3] if channels >= 3 else texels[..., :1]
        if channels in (2, 4):
            full[..., 3] = texels[..., -1]
        return full

    def _texels(self, file: str) -> NDArray[Any]:
        try:
            if os.path.isfile(file):
                return Texture.load(file).pixels
            with tempfile.TemporaryDirectory() as folder:  # an image within an archive
                path = os.path.join(folder, "image")
                with open(path, "wb") as copy:
                    copy.write(file_bytes(file))
                return Texture.load(path).pixels
        except Error as error:
            self._note(str(error))
            return np.full((1, 1, 4), 128, np.uint8)

    def _png(self, texels: NDArray[np.uint8], key: Any) -> int:
        if ("png", key) not in self._images:
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "image.png")
                Texture(texels).save(path)
                with open(path, "rb") as file:
                    data = file.read()
            self._images["png", key] = self._glb.add("images", {"bufferView": self._glb.view(data), "mimeType": "image/png"})
        return self._images["png", key]


def file_bytes(path: str) -> bytes:
    """Of a file, or of one within an archive (USDZ)."""
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    return bytes(asset.GetBuffer()) if asset else b""


def _transform(rotation: Any, scale: Any, translation: Any) -> dict[str, Any]:
    """UsdTransform2d as KHR_texture_transform, whose v runs downwards: v' = 1 - v on both sides."""
    angle = np.radians(float(rotation))
    c, s = np.cos(angle), np.sin(angle)
    (sx, sy), (tx, ty) = (tuple(float(v) for v in pair) for pair in (scale, translation))
    return {"offset": [float(tx - s * sy), float(1 - c * sy - ty)], "scale": [sx, sy], "rotation": float(angle)}


def linear(texels: NDArray[Any]) -> NDArray[np.float32]:
    """IEC 61966-2-1."""
    return np.where(texels <= 0.04045, texels / 12.92, ((np.maximum(texels, 0) + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _encoded(texels: NDArray[Any]) -> NDArray[np.float32]:
    return np.where(texels <= 0.0031308, texels * 12.92, 1.055 * np.maximum(texels, 1e-8) ** (1 / 2.4) - 0.055).astype(np.float32)


def _resized(texels: NDArray[Any], height: int, width: int) -> NDArray[Any]:
    taken: NDArray[Any] = texels[np.arange(height) * texels.shape[0] // height][:, np.arange(width) * texels.shape[1] // width]
    return taken


def bound_material(prim: Any, purpose: str = "full") -> Any:
    """The UsdShade.Material that is bound to a prim, or None."""
    found = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(purpose)[0]
    return found if found else None


